//! What harmonic motion can say of k/m: the response against differences, statics and MuJoCo, the bound against estimates.

#[path = "stiffness_bound/tilted.rs"]
mod tilted;

use glam::DVec3;
use nalgebra::{DMatrix, DVector, Vector6};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::identify::stiffness_bound::{
    Excitation, Information, LinearSensor, Response, UNKNOWNS,
};
use sixaxis_core::{Error, Geometry, InertiaPerMass, LIMBS, Parameters};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::model;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::strategy::{config, geometry, parameters};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::linear_theory::mode_frequencies_hz;
use sixaxis_reference::motion::Motion;
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::smooth_step::smooth_step;

/// Relative step of the differences.
const STEP: f64 = 1e-5;
/// Share of the forces below which a derivative is not told from rounding by it.
const SEEN: f64 = 1e-2;

fn response(parameters: &Parameters, drawing: &Geometry, excitation: &Excitation) -> Response {
    LinearSensor::new(
        drawing,
        &parameters.inertia_per_mass,
        parameters.stiffness_per_mass_per_s2,
    )
    .and_then(|sensor| sensor.response(excitation))
    .expect("a sound sensor below its lowest mode")
}

/// Differences of the forces when `change` moves the parameters by a share.
fn difference(
    parameters: &Parameters,
    drawing: &Geometry,
    excitation: &Excitation,
    change: impl Fn(&mut Parameters, f64),
) -> [f64; LIMBS] {
    let at = |share: f64| {
        let mut moved = *parameters;
        change(&mut moved, share);
        response(&moved, drawing, excitation).force_per_mass_m_s2
    };
    let (up, down) = (at(STEP), at(-STEP));
    core::array::from_fn(|i| (up[i] - down[i]) / (2.0 * STEP))
}

/// Largest difference of two derivatives, over the larger of the largest of them and a hundredth of the largest force: of a derivative
/// that is smaller, differences know nothing but rounding.
fn derivative_off(ours: &[f64; LIMBS], theirs: &[f64; LIMBS], force: &[f64; LIMBS]) -> f64 {
    let size = largest(theirs.iter().copied()).max(SEEN * largest(force.iter().copied()));
    largest(ours.iter().zip(theirs).map(|(a, b)| a - b)) / size
}

fn off(a: &[f64; LIMBS], b: &[f64; LIMBS]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a - b)) / largest(b.iter().copied())
}

fn along(frequency_hz: f64, linear: DVec3, angular: DVec3) -> Excitation {
    Excitation {
        frequency_hz,
        linear_shell_m_s2: linear,
        angular_shell_rad_s2: angular,
    }
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn prop_derivatives_are_differences(
        truth in parameters(),
        share in 0.2..0.8_f64,
        linear in prop::array::uniform3(-90.0..90.0_f64),
        angular in prop::array::uniform3(-1700.0..1700.0_f64),
    ) {
        let drawing = Geometry::PAPER;
        let lowest = mode_frequencies_hz(&truth::sensor(&truth))[0];
        let excitation = along(share * lowest, linear.into(), angular.into());
        let ours = response(&truth, &drawing, &excitation);
        let by_stiffness = difference(&truth, &drawing, &excitation, |p, share| {
            p.stiffness_per_mass_per_s2 *= share.exp();
        });
        within("d(f/m) / d ln(k/m)", derivative_off(&ours.by_log_stiffness_m_s2, &by_stiffness, &ours.force_per_mass_m_s2), tolerance::RESPONSE_DIFFERENCED);
        for (entry, by) in ours.by_inertia.iter().enumerate() {
            let size = truth.inertia_per_mass.xx_m2;
            let theirs = difference(&truth, &drawing, &excitation, |p, share| {
                let mut entries = p.inertia_per_mass.to_paper_order();
                entries[entry] += share * size;
                p.inertia_per_mass = InertiaPerMass::from_paper_order(entries);
            });
            within("d(f/m) / d(I/m)", derivative_off(&by.map(|b| b * size), &theirs, &ours.force_per_mass_m_s2), tolerance::RESPONSE_DIFFERENCED);
        }
    }

    #[test]
    fn inv_a_static_load_does_not_know_the_stiffness(
        truth in parameters(),
        drawing in geometry(),
        linear in prop::array::uniform3(-90.0..90.0_f64),
    ) {
        let excitation = along(0.0, linear.into(), DVec3::ZERO);
        let size = drawing.half_edge_m * drawing.half_edge_m;
        let inertia = InertiaPerMass::from_paper_order([size, size, size, 0.0, 0.0, 0.0]);
        let sensor = Parameters { inertia_per_mass: inertia, ..truth };
        let ours = response(&sensor, &drawing, &excitation);
        let jacobian = drawing.limb_jacobian();
        let load = Vector6::new(linear[0], linear[1], linear[2], 0.0, 0.0, 0.0);
        let solved = (jacobian.transpose() * jacobian).lu().solve(&load).expect("six axes carry load");
        within("static share", off(&ours.force_per_mass_m_s2, &(jacobian * solved).into()), tolerance::STATIC_SHARE);
        assert_eq!(ours.by_log_stiffness_m_s2, [0.0; LIMBS]);
    }

    #[test]
    fn prop_beyond_the_lowest_mode_is_refused(truth in parameters(), share in 1.001..3.0_f64) {
        let drawing = Geometry::PAPER;
        let k = truth.stiffness_per_mass_per_s2;
        let lowest = mode_frequencies_hz(&truth::sensor(&truth))[0];
        let sensor = LinearSensor::new(&drawing, &truth.inertia_per_mass, k).expect("a sound sensor");
        for frequency_hz in [share * lowest, -lowest, f64::NAN, f64::INFINITY] {
            let refused = matches!(
                sensor.response(&along(frequency_hz, DVec3::X, DVec3::ZERO)),
                Err(Error::OutOfRange { name: "frequency_hz", .. })
            );
            prop_assert!(refused, "{frequency_hz} Hz");
        }
        prop_assert!(sensor.response(&along(lowest / share, DVec3::X, DVec3::ZERO)).is_ok());
    }
}

/// A shaker: a harmonic that rises smoothly and then lasts.
#[derive(Clone)]
struct Shaker {
    excitation: Excitation,
    rise_s: f64,
}

impl Motion for Shaker {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let [_, envelope, ..] = smooth_step(time_s / self.rise_s);
        let wave = (core::f64::consts::TAU * self.excitation.frequency_hz * time_s).sin();
        (
            self.excitation.linear_shell_m_s2 * (envelope * wave),
            self.excitation.angular_shell_rad_s2 * (envelope * wave),
        )
    }
}

#[test]
fn ref_response_at_500_hz_is_mujocos() {
    const FREQUENCY_HZ: f64 = 500.0;
    /// Samples a period, Runge-Kutta steps a sample, periods that rise and periods that are looked at.
    const PLAN: (usize, usize, usize, usize) = (40, 5, 20, 10);
    let truth = truth::identified_parameters();
    let (samples, steps, rise, looked_at) = PLAN;
    for (linear, angular) in [
        (DVec3::new(30.0, -20.0, 40.0), DVec3::ZERO),
        (DVec3::ZERO, DVec3::new(-700.0, 900.0, 500.0)),
    ] {
        let excitation = along(FREQUENCY_HZ, linear, angular);
        let mut model = model(&truth, DVec3::Z, Mounting::AxisVertical);
        model.gravity_ground_m_s2 = DVec3::ZERO;
        let shaker = Shaker {
            excitation,
            rise_s: rise as f64 / FREQUENCY_HZ,
        };
        let run = sixaxis_reference::mujoco::simulate(
            &model,
            &shaker,
            (rise + looked_at) as f64 / FREQUENCY_HZ,
            FREQUENCY_HZ * samples as f64,
            steps,
        )
        .expect("a shaker's motion is simulated");
        // Over whole periods the product with the sine is half the amplitude that is in phase.
        let first = rise * samples;
        let theirs: [f64; LIMBS] = core::array::from_fn(|limb| {
            (first..first + looked_at * samples)
                .map(|i| {
                    let phase = core::f64::consts::TAU * i as f64 / samples as f64;
                    2.0 * phase.sin() * run.limb_force_per_mass_m_s2[i][limb]
                })
                .sum::<f64>()
                / (looked_at * samples) as f64
        });
        let ours = response(&truth, &Geometry::PAPER, &excitation).force_per_mass_m_s2;
        within(
            "nine forces at 500 Hz",
            off(&ours, &theirs),
            tolerance::SHAKEN,
        );
        let rigid = response(&truth, &Geometry::PAPER, &along(0.0, linear, angular));
        fails_clearly(
            "limbs that do not give way",
            off(&rigid.force_per_mass_m_s2, &theirs),
            tolerance::SHAKEN,
        );
    }
}

#[test]
fn stat_the_bound_is_attained() {
    const SAMPLES: usize = 100;
    const NOISE_OVER_LARGEST: f64 = 0.01;
    const DRAWS: u64 = 5000;
    /// Corrections of an estimate: each leaves the square of what is left, and noise of 1 % leaves little.
    const CORRECTIONS: usize = 2;
    let truth = truth::identified_parameters();
    let size_m2 = truth.inertia_per_mass.xx_m2;
    let excitations: Vec<Excitation> = [400.0, 500.0]
        .into_iter()
        .flat_map(|f| {
            [DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .flat_map(move |d| {
                    [
                        along(f, d * 90.0, DVec3::ZERO),
                        along(f, DVec3::ZERO, d * 1700.0),
                    ]
                })
        })
        .collect();
    // What the channels show of the scale factors 1 + x.
    let shown = |x: &DVector<f64>| -> DVector<f64> {
        let mut inertia = truth.inertia_per_mass.to_paper_order();
        for (entry, share) in inertia.iter_mut().zip(x.iter().skip(1 + LIMBS)) {
            *entry += share * size_m2;
        }
        let mut parameters = truth;
        parameters.inertia_per_mass = InertiaPerMass::from_paper_order(inertia);
        parameters.stiffness_per_mass_per_s2 *= x[0].exp();
        let rows = excitations.iter().flat_map(|e| {
            let f = response(&parameters, &Geometry::PAPER, e).force_per_mass_m_s2;
            (0..LIMBS).map(move |i| f[i]).collect::<Vec<_>>()
        });
        let rows: Vec<f64> = rows.collect();
        DVector::from_fn(rows.len(), |row, _| rows[row] * (-x[1 + row % LIMBS]).exp())
    };
    let mut information = Information::new(size_m2).expect("a size");
    let mut noise = Vec::new();
    for e in &excitations {
        let r = response(&truth, &Geometry::PAPER, e);
        let sigma = NOISE_OVER_LARGEST * largest(r.force_per_mass_m_s2);
        information.push(&r, sigma, SAMPLES).expect("noise");
        noise.extend([sigma; LIMBS]);
    }
    let bound = information
        .bound()
        .expect("everything is excited")
        .all_unknown;
    // A regressor by differences, weighted, that knows nothing of the derivatives under test.
    let rows = noise.len();
    let mut regressor = DMatrix::zeros(rows, UNKNOWNS);
    for unknown in 0..UNKNOWNS {
        let step = DVector::from_fn(UNKNOWNS, |i, _| if i == unknown { STEP } else { 0.0 });
        let slope = (shown(&step) - shown(&-step)) / (2.0 * STEP);
        for row in 0..rows {
            regressor[(row, unknown)] = slope[row] / noise[row];
        }
    }
    let inverse = regressor
        .pseudo_inverse(f64::EPSILON)
        .expect("the iteration ends");
    // An amplitude is known to the root of 2/N of a sample's noise.
    let spread = inverse.row(0).norm() * (2.0 / SAMPLES as f64).sqrt();
    within(
        "bound of ln(k/m)",
        (spread / bound - 1.0).abs(),
        tolerance::BOUND,
    );
    let nothing = DVector::zeros(UNKNOWNS);
    let exact = shown(&nothing);
    let mut rng = Pcg64::seed_from_u64(seed());
    let mut squares = 0.0;
    for _ in 0..DRAWS {
        // Sample by sample, then each channel's amplitude.
        let seen = DVector::from_fn(rows, |row, _| {
            let sum: f64 = (0..SAMPLES)
                .map(|i| {
                    let wave = (core::f64::consts::TAU * i as f64 / SAMPLES as f64).sin();
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    wave * (exact[row] * wave + noise[row] * unit)
                })
                .sum();
            2.0 * sum / SAMPLES as f64
        });
        let mut x = nothing.clone();
        for _ in 0..CORRECTIONS {
            let mut left = &seen - shown(&x);
            for (left, sigma) in left.iter_mut().zip(&noise) {
                *left /= sigma;
            }
            x += &inverse * left;
        }
        squares += (x[0] / bound).powi(2);
    }
    eprintln!("attained over bound: {}", (squares / DRAWS as f64).sqrt());
    within(
        "spread of ln(k/m) over its bound",
        chi_square_departure(squares, DRAWS as usize),
        tolerance::CHI_SQUARE,
    );
}

#[test]
fn law_too_few_directions_are_refused() {
    let truth = truth::identified_parameters();
    let mut information = Information::new(truth.inertia_per_mass.xx_m2).expect("a size");
    for f in [400.0, 500.0] {
        let r = response(&truth, &Geometry::PAPER, &along(f, DVec3::X, DVec3::ZERO));
        information.push(&r, 1.0, 1).expect("noise");
    }
    assert!(matches!(
        information.bound(),
        Err(Error::RankDeficient { .. })
    ));
    for noise in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let r = response(&truth, &Geometry::PAPER, &along(5.0, DVec3::X, DVec3::ZERO));
        assert!(information.push(&r, noise, 1).is_err(), "noise {noise}");
    }
}
