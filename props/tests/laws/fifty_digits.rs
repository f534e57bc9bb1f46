//! Rounding, measured: decoders and the four steps against the same equations in fifty digits.
//!
//! Errors are in units of the last place: of the vector's peak for accelerations, rates and attitude, of the answer for
//! parameters. Beside each stands the condition number, how far relative errors of the input, drawn anew for each number, move
//! the answer: what no arithmetic of 53 bits can stay below.

#[path = "fifty_digits/decoder.rs"]
mod decoder;
#[path = "fifty_digits/number.rs"]
mod number;
#[path = "fifty_digits/steps.rs"]
mod steps;

use std::array::from_fn;

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sixaxis_core::decouple::lanes::{LaneSample, push_lanes};
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::paper::RateVariable;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{
    Decoupler, InertiaPerMass, LIMBS, Model, Parameter, Parameters, Scheme, SixAxis,
};
use sixaxis_props::compare::{fails_clearly, largest};
use sixaxis_props::evidence::Row;
use sixaxis_props::problem::{Problem, rig};
use sixaxis_props::tolerance;
use sixaxis_props::truth::{self, InCore};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

use decoder::Directions;
use number::{Matrix, Vector, big, near};
use steps::Recorded;

/// Samples that are decoded.
const SAMPLES: usize = 10_000;
/// Relative size of the errors of the input that a condition number is read from: far above rounding, far below a strain.
const MOVED: f64 = 1e-9;
/// Vectors of an answer, in order, as far as a path gives them.
const VECTORS: [&str; 4] = [
    "linear acceleration",
    "angular acceleration",
    "rate",
    "attitude",
];

/// Vectors of one answer, as numbers.
type Numbers = [f64; 9];

/// Size of the last place of a number.
fn last_place(value: f64) -> f64 {
    let size = value.abs();
    size.next_up() - size
}

/// The 5 Hz run of Table 6 from MuJoCo, without noise: the paper's sensor as identified.
fn compound() -> Problem {
    let parameters = truth::identified_parameters();
    let run = Run {
        steady_periods: 4.0,
        ..rig::compound_run()
    };
    let model = rig::model(&parameters, run.direction_ground, Mounting::AxisVertical);
    let run = sixaxis_reference::mujoco::simulate_run(&model, &run, rig::RATE_HZ, rig::STEPS)
        .expect("a run of the campaign simulates");
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0);
    let mut problem = Problem::recorded(&recording, &parameters, Scheme::Heun);
    problem.voltage_v.truncate(SAMPLES + 2);
    problem
}

/// Each number moved by a drawn share of at most [`MOVED`].
fn moved(rng: &mut Pcg64, value: f64) -> f64 {
    value * (1.0 + MOVED * rng.random_range(-1.0..1.0))
}

/// The same problem with voltages and parameters moved.
fn moved_problem(problem: &Problem) -> Problem {
    let mut rng = Pcg64::seed_from_u64(1);
    let values = problem
        .parameters
        .to_paper_order()
        .map(|x| moved(&mut rng, x));
    let voltage_v = problem.voltage_v.iter();
    Problem {
        voltage_v: voltage_v
            .map(|row| row.map(|u| moved(&mut rng, u)))
            .collect(),
        parameters: Parameters {
            zero_drift_v: from_fn(|i| values[i]),
            scale_per_mass_per_kg: from_fn(|i| values[LIMBS + i]),
            inertia_per_mass: InertiaPerMass::from_paper_order(from_fn(|i| values[2 * LIMBS + i])),
            stiffness_per_mass_per_s2: values[PARAMETERS - 1],
        },
        ..problem.clone()
    }
}

fn numbers(answer: &SixAxis) -> Numbers {
    let numbers = answer.numbers();
    from_fn(|i| numbers[i])
}

/// Answers of each path of core.
fn paths(problem: &Problem) -> Vec<(&'static str, Vec<Numbers>)> {
    let streamed = problem.decouple();
    let mut recorded = Vec::new();
    problem
        .decoupler()
        .push_record(&problem.voltage_v, &mut |done| {
            recorded.extend(done.iter().map(|answer| numbers(&answer)));
        })
        .expect("sound samples");
    let mut lanes: Vec<Numbers> = Vec::new();
    let mut decouplers: [Decoupler; LANES] = from_fn(|_| problem.decoupler());
    let rows = [&problem.voltage_v[..]; LANES];
    push_lanes(&mut decouplers, rows, &mut |chunk: &[LaneSample]| {
        lanes.extend(
            chunk
                .iter()
                .map(|sample| from_fn(|i| sample[i].0[LANES - 1])),
        );
    })
    .expect("sound samples");
    let model = Model::new(&problem.sensor, &problem.parameters, &problem.settings);
    let printed = model
        .and_then(|m| sixaxis_core::paper::decouple(&m, RateVariable::Mass, &problem.voltage_v))
        .expect("sound samples");
    vec![
        ("push", streamed.iter().map(numbers).collect()),
        ("push_record", recorded),
        ("push_lanes", lanes),
        ("paper", printed.iter().map(numbers).collect()),
    ]
}

/// The same with single precision.
fn in_single_precision(problem: &Problem) -> Vec<Numbers> {
    let Problem {
        sensor,
        parameters,
        settings,
        ..
    } = problem;
    let mut decoupler = Decoupler::new_f32(sensor, parameters, settings).expect("a sound sensor");
    let voltage_v = problem.voltage_v.iter().map(|row| row.map(|u| u as f32));
    let answers = voltage_v.filter_map(|row| decoupler.push(&row).expect("a sound sample"));
    answers
        .map(|s| {
            let vectors = [
                s.linear_ground_m_s2,
                s.angular_ground_rad_s2,
                s.rate_shell_rad_s,
            ];
            from_fn(|i| f64::from(vectors[i / 3].to_array()[i % 3]))
        })
        .collect()
}

/// Largest length, over the samples, of the difference to the truth in units of the last place of the largest truth: linear,
/// angular, rate. The difference is taken in fifty digits.
fn off(ours: &[Numbers], truth: &[[Vector; 3]]) -> [f64; 3] {
    assert_eq!(ours.len(), truth.len(), "samples");
    from_fn(|v| {
        let peak = largest(truth.iter().map(|sample| near(&sample[v].length())));
        let errors = ours.iter().zip(truth).map(|(ours, truth)| {
            let ours = Vector::new(from_fn(|i| ours[3 * v + i]));
            near(&(&ours - &truth[v]).length())
        });
        largest(errors) / last_place(peak)
    })
}

/// Largest difference of a column of the rotation matrix, exact for the quaternion that is given.
fn attitude_off(ours: &[SixAxis], truth: &[Matrix]) -> f64 {
    let column = |q: DQuat, axis: usize| {
        let [s, v] = [big(q.w), big(2.0)];
        let part = Vector::new([q.x, q.y, q.z]);
        let unit = Vector::new(from_fn(|i| f64::from(u8::from(i == axis))));
        let once = part.cross(&unit);
        &unit + &(&(&(&once * &s) + &part.cross(&once)) * &v)
    };
    let errors = ours.iter().zip(truth).flat_map(|(ours, truth)| {
        (0..3).map(|axis| {
            let difference = &column(ours.attitude, axis) - &truth.column(axis);
            near(&difference.length())
        })
    });
    largest(errors) / last_place(1.0)
}

#[test]
fn law_decoders_round_by_so_much() {
    let problem = compound();
    let Problem {
        sensor,
        parameters,
        settings,
        ..
    } = &problem;
    let mut decoder = decoder::Decoder::new(sensor, parameters, settings, Directions::OfNodes);
    let (mut truth, mut attitudes) = (Vec::new(), Vec::new());
    for answer in problem.voltage_v.iter().filter_map(|row| decoder.push(row)) {
        truth.push([answer.linear, answer.angular, answer.rate]);
        attitudes.push(answer.attitude);
    }
    assert_eq!(truth.len(), SAMPLES);
    let streamed = problem.decouple();
    // What errors of the input do, over their size.
    let elsewhere: Vec<Numbers> = moved_problem(&problem)
        .decouple()
        .iter()
        .map(numbers)
        .collect();
    let condition = off(&elsewhere, &truth).map(|ulp| ulp * f64::EPSILON / MOVED);
    for (path, answers) in paths(&problem) {
        for (v, ulp) in off(&answers, &truth).into_iter().enumerate() {
            Row::new(
                format!("{}, ulp", VECTORS[v]),
                ulp,
                tolerance::DECODED_ULP[v],
            )
            .case(format_args!("{path}, condition number {:.0}", condition[v]))
            .judge();
        }
    }
    Row::new(
        format!("{}, ulp", VECTORS[3]),
        attitude_off(&streamed, &attitudes),
        tolerance::DECODED_ULP[3],
    )
    .case("push")
    .judge();
    // Negative control: 24 bits in the place of 53.
    let single = off(&in_single_precision(&problem), &truth);
    for (v, ulp) in single.into_iter().enumerate() {
        let what = format!("single precision, {}, ulp", VECTORS[v]);
        fails_clearly(what, ulp, tolerance::DECODED_ULP[v]);
    }
}

/// One set of trials: a static record with noise, three linear and three angular runs and a fast one without.
fn trials() -> Recorded {
    let parameters = truth::identified_parameters();
    let laboratory = Laboratory::noise_free(truth::sensor(&parameters));
    // Noise that the mean has to be taken of, and small enough for step 4 to find its minimum inside the grid.
    let mut quiet = laboratory;
    quiet.chain.signal_to_noise_db = Some(140.0);
    let at_rest = quiet.record_static();
    let recorded = |mode, frequency_hz, direction| {
        let run = rig::simulate_trial(&parameters, mode, frequency_hz, direction);
        laboratory.record(&run, 0)
    };
    let linear = rig::DIRECTIONS.map(|direction| {
        let recording = recorded(Mode::Linear, 1.5, direction);
        let readings = recording.accelerometer_m_s2.iter();
        let motion = readings.map(|a| recording.direction_ground * *a);
        let rows = recording.voltage_v.iter().copied().zip(motion).collect();
        (recording.sensor(), rows)
    });
    let angular = rig::DIRECTIONS.map(|direction| {
        let recording = recorded(Mode::Angular, 1.5, direction);
        let readings = &recording.gyroscope_rad_s;
        // Differentiating is no part of the step: whatever this is, both are given it.
        let slope = |i: usize| 0.5 * recording.sample_rate_hz * (readings[i + 1] - readings[i - 1]);
        let axis = recording.direction_ground;
        let rows = (1..readings.len() - 1)
            .map(|i| (recording.voltage_v[i], axis * readings[i], axis * slope(i)))
            .collect();
        (recording.sensor(), rows)
    });
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let fast = Run::new(Mode::Linear, 5.0, direction);
    let model = rig::model(&parameters, direction, Mounting::AxisVertical);
    let (rate_hz, steps) = (rig::CAMPAIGN_RATE_HZ, rig::CAMPAIGN_STEPS);
    let fast = sixaxis_reference::mujoco::simulate_run(&model, &fast, rate_hz, steps)
        .expect("a run of the campaign simulates");
    let fast = laboratory.record(&fast, 0);
    Recorded {
        at_rest_v: at_rest.voltage_v,
        linear: linear.to_vec(),
        angular: angular.to_vec(),
        fast: (fast.sensor(), fast.settings(Scheme::Heun), fast.voltage_v),
    }
}

/// The same with every number that was recorded moved.
fn moved_trials(recorded: &Recorded) -> Recorded {
    let mut rng = Pcg64::seed_from_u64(2);
    let mut moved = recorded.clone();
    let all = &mut |row: &mut [f64; LIMBS]| *row = row.map(|u| self::moved(&mut rng, u));
    moved.at_rest_v.iter_mut().for_each(&mut *all);
    moved.fast.2.iter_mut().for_each(&mut *all);
    let linear = moved.linear.iter_mut().flat_map(|(_, rows)| rows);
    linear.for_each(|(row, _)| all(row));
    let angular = moved.angular.iter_mut().flat_map(|(_, rows)| rows);
    angular.for_each(|(row, ..)| all(row));
    let mut rng = Pcg64::seed_from_u64(3);
    let mut by = |v: &mut DVec3| *v *= self::moved(&mut rng, 1.0);
    for (_, rows) in &mut moved.linear {
        rows.iter_mut().for_each(|(_, a)| by(a));
    }
    for (_, rows) in &mut moved.angular {
        for (_, w, dw) in rows {
            by(w);
            by(dw);
        }
    }
    moved
}

/// Kinds of parameters, by the step that finds them.
const STEPS: [(&str, core::ops::Range<usize>); 4] = [
    ("zero drift", 0..LIMBS),
    ("scale per mass", LIMBS..2 * LIMBS),
    ("inertia per mass", 2 * LIMBS..PARAMETERS - 1),
    ("stiffness per mass", PARAMETERS - 1..PARAMETERS),
];

#[test]
fn law_the_four_steps_round_by_so_much() {
    let recorded = trials();
    let ours = steps::by_core(&recorded);
    let truth = steps::in_fifty_digits(&recorded, ours.grid_minimum_per_s2);
    let elsewhere = steps::by_core(&moved_trials(&recorded));
    for (step, (name, range)) in STEPS.into_iter().enumerate() {
        for i in range {
            let parameter = Parameter::at(i).expect("one of 25");
            let value = near(&truth.values[i]);
            let error = near(&(big(ours.values[i]) - &truth.values[i])).abs();
            let condition = (elsewhere.values[i] / ours.values[i] - 1.0).abs() / MOVED;
            Row::new(
                format!("{name}, ulp"),
                error / last_place(value),
                tolerance::IDENTIFIED_ULP[step],
            )
            .case(format_args!("{parameter}, condition number {condition:.1}"))
            .sides(value, ours.values[i], parameter.unit())
            .judge();
        }
    }
    // Step 4 without the interpolation between four decodes, and with the equations as printed, each against its own definition of
    // where loaded limbs point.
    let rows = [
        (
            "every candidate decoded",
            &truth.decoded_one_by_one_per_s2,
            ours.decoded_one_by_one_per_s2,
        ),
        (
            "as printed",
            &truth.as_printed_per_s2,
            ours.as_printed_per_s2,
        ),
    ];
    for (how, value, ours) in rows {
        Row::new(
            format!("stiffness per mass, {how}, ulp"),
            near(&(big(ours) - value)).abs() / last_place(near(value)),
            tolerance::IDENTIFIED_ULP[3],
        )
        .sides(near(value), ours, "s^-2")
        .judge();
    }
    // What the two definitions are apart here, where scale factors are off by 1e-6.
    let [ours, printed] = [ours.decoded_one_by_one_per_s2, ours.as_printed_per_s2];
    Row::new(
        "k/m by limbs to the nodes, over that by limbs to the pose",
        (ours / printed - 1.0).abs(),
        tolerance::LIMBS_TO_NODES,
    )
    .sides(printed, ours, "s^-2")
    .judge();
    // Negative controls: the same record's mean in 24 bits, and in 53 from the first sample to the last without an origin.
    let voltage_v = || recorded.at_rest_v.iter().map(|row| row[0]);
    let count = recorded.at_rest_v.len() as f64;
    let off = |mean: f64| near(&(big(mean) - &truth.values[0])).abs() / last_place(mean);
    let single = f64::from(voltage_v().map(|u| u as f32).sum::<f32>() / count as f32);
    fails_clearly(
        "zero drift in single precision, ulp",
        off(single),
        tolerance::IDENTIFIED_ULP[0],
    );
    Row::new(
        "zero drift by a plain sum, ulp",
        off(voltage_v().sum::<f64>() / count),
        tolerance::IDENTIFIED_ULP[0],
    )
    .control(1.0)
    .judge();
}
