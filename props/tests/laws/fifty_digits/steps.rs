//! The four steps in fifty digits, and with core, from one recorded set of trials.

use glam::DVec3;
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::stiffness::{judge, paper_grid, rate_norm_sum};
use sixaxis_core::identify::stiffness_search::{Trial, rate_norm_sums};
use sixaxis_core::identify::zero_drift;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::paper::{RateVariable, decouple};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{InertiaPerMass, LIMBS, Model, Parameters, Sensor, Settings};
use sixaxis_props::truth;

use super::decoder::{Decoder, Directions, Drawing};
use super::number::{Big, Normal, Vector, big, near};

/// Voltages, V, and the shell's acceleration, m/s^2.
pub type Linear = ([f64; LIMBS], DVec3);
/// Voltages, V, rate, rad/s, and its derivative, rad/s^2.
pub type Angular = ([f64; LIMBS], DVec3, DVec3);

/// What a laboratory has recorded.
#[derive(Clone)]
pub struct Recorded {
    /// Nine voltages at rest, V.
    pub at_rest_v: Vec<[f64; LIMBS]>,
    /// Pure linear motion: the sensor with its ranges, voltages, V, and the shell's acceleration, m/s^2.
    pub linear: Vec<(Sensor, Vec<Linear>)>,
    /// Pure angular motion: the same with rate, rad/s, and its derivative, rad/s^2.
    pub angular: Vec<(Sensor, Vec<Angular>)>,
    /// Pure linear motion above the threshold.
    pub fast: (Sensor, Settings, Vec<[f64; LIMBS]>),
}

/// The 25 parameters, and the grid point of step 4.
pub struct Found<T> {
    pub values: [T; PARAMETERS],
    pub grid_minimum_per_s2: f64,
    /// k/m of three candidates about it, each decoded by itself.
    pub decoded_one_by_one_per_s2: T,
    /// The same with limbs pointing to the nodes of the pose, as printed.
    pub as_printed_per_s2: T,
}

/// With core.
pub fn by_core(recorded: &Recorded) -> Found<f64> {
    let drift = zero_drift::identify(&recorded.at_rest_v).expect("a static record");
    let zero_drift_v = drift.drift_v;
    let mut scale = ScaleIdentification::default();
    for (sensor, rows) in &recorded.linear {
        for (voltage_v, acceleration) in rows {
            let force_n = sensor.gains.measured_force_n(voltage_v, &zero_drift_v);
            scale.push(&force_n, *acceleration).expect("finite rows");
        }
    }
    let scale = scale.solve().expect("three directions").estimate;
    let mut parameters = Parameters {
        zero_drift_v,
        scale_per_mass_per_kg: scale.values,
        ..truth::identified_parameters()
    };
    let (first, _) = &recorded.angular[0];
    let mut inertia = InertiaIdentification::new(first.geometry);
    for (sensor, rows) in &recorded.angular {
        let chain = SignalChain::new(&sensor.gains, &parameters);
        for (voltage_v, rate, derivative) in rows {
            let force = chain.force_per_mass_m_s2(voltage_v);
            inertia
                .push(&force, *rate, *derivative)
                .expect("finite rows");
        }
    }
    let inertia = inertia.solve().expect("three axes");
    parameters.inertia_per_mass = inertia.inertia_per_mass;
    let (sensor, settings, voltage_v) = &recorded.fast;
    let grid: Vec<f64> = paper_grid().collect();
    let trial = Trial {
        sensor,
        settings,
        voltage_v,
    };
    let norms = rate_norm_sums(&parameters, &[trial], &grid).expect("sound samples");
    let means = norms.sums.iter().map(|sum| sum / norms.samples as f64);
    let curve: Vec<(f64, f64)> = grid.iter().copied().zip(means).collect();
    let stiffness = judge(&curve).expect("a curve");
    let about = grid
        .iter()
        .position(|k| *k == stiffness.grid_minimum_per_s2);
    let about = about
        .filter(|at| (1..grid.len() - 1).contains(at))
        .expect("inside the grid");
    let (mut singly, mut printed) = (Vec::new(), Vec::new());
    for &k in &grid[about - 1..=about + 1] {
        parameters.stiffness_per_mass_per_s2 = k;
        let (sum, count) =
            rate_norm_sum(sensor, &parameters, settings, voltage_v).expect("sound samples");
        singly.push((k, sum / count as f64));
        let model = Model::new(sensor, &parameters, settings).expect("a sound sensor");
        let answers = decouple(&model, RateVariable::Mass, voltage_v).expect("sound samples");
        let sum: f64 = answers.iter().map(|s| s.rate_shell_rad_s.length()).sum();
        printed.push((k, sum / answers.len() as f64));
    }
    let [singly, printed] =
        [singly, printed].map(|curve| judge(&curve).expect("a curve").interpolated_per_s2);
    parameters.stiffness_per_mass_per_s2 = stiffness.interpolated_per_s2;
    Found {
        values: parameters.to_paper_order(),
        grid_minimum_per_s2: stiffness.grid_minimum_per_s2,
        decoded_one_by_one_per_s2: singly,
        as_printed_per_s2: printed,
    }
}

/// In fifty digits. Of step 4's curve three points are computed, about the minimum that core has found on the grid, and the
/// smallest must be in the middle.
pub fn in_fifty_digits(recorded: &Recorded, grid_minimum_per_s2: f64) -> Found<Big> {
    let count = big(recorded.at_rest_v.len() as f64);
    let drift: [Big; LIMBS] = core::array::from_fn(|i| {
        let sum = recorded
            .at_rest_v
            .iter()
            .fold(big(0.0), |sum, row| sum + big(row[i]));
        sum / &count
    });
    let measured = |sensor: &Sensor, voltage_v: &[f64; LIMBS], i: usize| {
        big(sensor.gains.gain_n_per_v[i]) * (big(voltage_v[i]) - &drift[i])
    };
    let (sensor, settings, voltage_v) = &recorded.fast;
    let drawing = Drawing::new(sensor);
    // (12): one row an axis.
    let mut normal = Normal::of(LIMBS);
    for (sensor, rows) in &recorded.linear {
        for (voltage_v, acceleration) in rows {
            let forces: [Big; LIMBS] = core::array::from_fn(|i| measured(sensor, voltage_v, i));
            for (axis, a) in acceleration.to_array().into_iter().enumerate() {
                let row: Vec<(usize, Big)> = (0..LIMBS)
                    .map(|i| (i, &forces[i] * &drawing.direction(i).0[axis]))
                    .filter(|(_, x)| near(x) != 0.0)
                    .collect();
                normal.push(&row, &big(a));
            }
        }
    }
    let scale: [Big; LIMBS] = normal.solve().try_into().expect("nine");
    // (15): column j is the torque of a tensor that is one in its entry j.
    let mut normal = Normal::of(ENTRIES.len());
    for (sensor, rows) in &recorded.angular {
        for (voltage_v, rate, derivative) in rows {
            let torque = (0..LIMBS).fold(Vector::new([0.0; 3]), |sum, i| {
                let force = &scale[i] * measured(sensor, voltage_v, i);
                &sum + &(&drawing.moment(i) * &force)
            });
            let [w, dw] = [rate, derivative].map(|v| Vector::new(v.to_array()));
            let columns = ENTRIES.map(|(i, j)| {
                let times = |v: &Vector| {
                    let mut product = Vector::new([0.0; 3]);
                    product.0[i] = v.0[j].clone();
                    product.0[j] = v.0[i].clone();
                    product
                };
                &times(&dw) + &w.cross(&times(&w))
            });
            for axis in 0..3 {
                let row: Vec<(usize, Big)> = columns
                    .iter()
                    .map(|c| c.0[axis].clone())
                    .enumerate()
                    .collect();
                normal.push(&row, &torque.0[axis]);
            }
        }
    }
    let inertia = normal.solve();
    let places: Vec<f64> = paper_grid().collect();
    let best = places
        .iter()
        .position(|k| *k == grid_minimum_per_s2)
        .expect("a point of the grid");
    // (20) at three points, then the vertex of the squares over 1/(k/m).
    let stiffness = |directions: Directions| {
        let mean_square = |k: f64| {
            let parameters = Parameters {
                inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
                    near(&inertia[i])
                })),
                stiffness_per_mass_per_s2: k,
                ..truth::identified_parameters()
            };
            let decoder = Decoder::new(sensor, &parameters, settings, directions);
            let mut decoder = decoder.with(drift.clone(), scale.clone(), &inertia);
            let (mut sum, mut count) = (big(0.0), 0);
            for answer in voltage_v.iter().filter_map(|row| decoder.push(row)) {
                sum = sum + answer.rate.length();
                count += 1;
            }
            let mean = sum / big(f64::from(count));
            (big(1.0) / big(k), &mean * &mean)
        };
        let curve = [best - 1, best, best + 1].map(|place| mean_square(places[place]));
        let at = |i: usize| near(&curve[i].1);
        assert!(at(1) <= at(0) && at(1) <= at(2), "the minimum is elsewhere");
        let slope = |i: usize| (&curve[i + 1].1 - &curve[i].1) / (&curve[i + 1].0 - &curve[i].0);
        let curvature = (slope(1) - slope(0)) / (&curve[2].0 - &curve[0].0);
        let half = big(0.5);
        big(1.0) / (&half * (&curve[0].0 + &curve[1].0) - &half * slope(0) / curvature)
    };
    let of_nodes = stiffness(Directions::OfNodes);
    let as_printed_per_s2 = stiffness(Directions::OfPose);
    let values: Vec<Big> = drift
        .into_iter()
        .chain(scale)
        .chain(inertia)
        .chain([of_nodes.clone()])
        .collect();
    Found {
        values: values.try_into().expect("25"),
        grid_minimum_per_s2,
        decoded_one_by_one_per_s2: of_nodes,
        as_printed_per_s2,
    }
}

/// Entries of the tensor in the paper's order.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
