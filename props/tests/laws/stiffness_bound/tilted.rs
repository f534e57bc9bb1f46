//! The bound with tilted limbs: forces against MuJoCo, the bound against differences of an exact equilibrium, and an estimator
//! that attains it.

use core::f64::consts::TAU;

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector6};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::identify::stiffness_bound::{Excitation, Information, LinearSensor, Response};
use sixaxis_core::{Geometry, LIMBS, Parameters};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::evidence::Row;
use sixaxis_props::problem::rig;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::compliant::elongations_m;
use sixaxis_reference::geometry;
use sixaxis_reference::rig::run::{Mode, Mounting, Run, SLIDER_AMPLITUDE_M, WEDGES};

const RATE_HZ: f64 = 1000.0;
/// Steps of MuJoCo in a sample: 20 us each.
const STEPS: usize = 50;
const FREQUENCY_HZ: f64 = 5.0;

fn linear_sensor(parameters: &Parameters) -> LinearSensor {
    LinearSensor::new(
        &Geometry::PAPER,
        &parameters.inertia_per_mass,
        parameters.stiffness_per_mass_per_s2,
    )
    .expect("a sound sensor")
}

/// Sine of the phase and cosine of twice the phase, which is all that a force's change by k/m consists of: damping is in
/// quadrature.
fn harmonics(values: &[(f64, [f64; LIMBS])]) -> [[f64; LIMBS]; 2] {
    let count = values.len() as f64;
    let part = |wave: fn(f64) -> f64| {
        core::array::from_fn(|limb| {
            let sum = values.iter().map(|(phase, f)| wave(*phase) * f[limb]);
            2.0 * sum.sum::<f64>() / count
        })
    };
    [part(f64::sin), part(|phase| (2.0 * phase).cos())]
}

/// ln(k/m) moved up and down by this.
const MOVED: f64 = 0.3;

#[test]
fn ref_tilted_limbs_are_mujocos() {
    let truth = truth::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    for mode in [Mode::Linear, Mode::Angular] {
        let run = Run::new(mode, FREQUENCY_HZ, direction);
        let steady = run.steady_span_s();
        let (first, last) = (steady.0 * RATE_HZ, steady.1 * RATE_HZ);
        let at = |by: f64| {
            let mut moved = truth;
            moved.stiffness_per_mass_per_s2 *= by.exp();
            let model = rig::model(&moved, direction, Mounting::AxisVertical);
            let played = sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ, STEPS)
                .expect("a run of the rig simulates");
            let forces = played.limb_force_per_mass_m_s2;
            let samples = first.round() as usize..last.round() as usize;
            samples.map(|i| forces[i]).collect::<Vec<_>>()
        };
        let (up, down) = (at(MOVED), at(-MOVED));
        // The crank has turned by half of its run-up; a harmonic's acceleration is against its travel.
        let phase = |i: usize| {
            let turns = 0.5 * run.ramp_periods + i as f64 / (last - first).round();
            TAU * (turns + 0.5)
        };
        // What goes with m/k changes by twice the hyperbolic sine.
        let theirs: Vec<(f64, [f64; LIMBS])> = up
            .iter()
            .zip(&down)
            .enumerate()
            .map(|(i, (up, down))| {
                let change = |limb: usize| (up[limb] - down[limb]) / (2.0 * MOVED.sinh());
                (phase(i), core::array::from_fn(change))
            })
            .collect();
        let omega2 = (TAU * FREQUENCY_HZ).powi(2);
        let (travel, rotation) = run.amplitudes();
        let excitation = Excitation {
            frequency_hz: FREQUENCY_HZ,
            linear_shell_m_s2: run.direction_ground * (travel * omega2),
            angular_shell_rad_s2: run.direction_ground * (rotation * omega2),
        };
        let gravity = Mounting::AxisVertical.gravity_ground_m_s2(direction);
        let sensor = linear_sensor(&truth);
        let ours = |get: fn(&Response) -> [f64; LIMBS]| -> Vec<(f64, [f64; LIMBS])> {
            let tilted = |phase| sensor.tilted(&excitation, gravity, phase).expect("sound");
            (theirs.iter())
                .map(|(phase, _)| (*phase, get(&tilted(*phase))))
                .collect()
        };
        let (theirs, ours) = (
            harmonics(&theirs),
            harmonics(&ours(|r| r.by_log_stiffness_m_s2)),
        );
        let size = largest(theirs.as_flattened().iter().copied());
        let pairs = || ours.as_flattened().iter().zip(theirs.as_flattened());
        Row::new(
            "d(f/m) / d ln(k/m), limbs tilted",
            largest(pairs().map(|(a, b)| a - b)) / size,
            tolerance::TILTED_BY_STIFFNESS,
        )
        .case(format_args!("{mode:?}"))
        .judge();
        let linear = sensor
            .response(&excitation)
            .expect("sound")
            .by_log_stiffness_m_s2;
        let apart = largest((0..LIMBS).map(|i| linear[i] - theirs[0][i]));
        let missing = largest(theirs[1]);
        Row::new(
            "the same in linear theory",
            apart.max(missing) / size,
            tolerance::TILTED_BY_STIFFNESS,
        )
        .case(format_args!("{mode:?}"))
        .control(tolerance::NO_TILT)
        .judge();
    }
}

/// One trial: linear motion, its gravity.
type Trial = (Excitation, DVec3);

fn linear_trials(frequencies: usize) -> Vec<Trial> {
    (0..frequencies)
        .flat_map(|step| {
            let frequency_hz = 4.0 + step as f64 / (frequencies - 1) as f64;
            WEDGES[..3].iter().map(move |direction| {
                let omega2 = (TAU * frequency_hz).powi(2);
                let excitation = Excitation {
                    frequency_hz,
                    linear_shell_m_s2: *direction * (SLIDER_AMPLITUDE_M * omega2),
                    angular_shell_rad_s2: DVec3::ZERO,
                };
                (
                    excitation,
                    Mounting::AxisVertical.gravity_ground_m_s2(*direction),
                )
            })
        })
        .collect()
}

/// Forces of a mass that hangs in equilibrium with its load, limbs where they then are: from elongations alone, which are exact.
///
/// J^T f = load with f = -k dl(x) and J = d(dl)/dx at x, by differences; the mass's own acceleration is that of its first-order
/// motion.
fn exact(
    parameters: &Parameters,
    (excitation, gravity): &Trial,
    phase: f64,
) -> SVector<f64, LIMBS> {
    /// Displacements that elongations are differenced over, m and rad.
    const STEP: f64 = 1e-7;
    const ITERATIONS: usize = 4;
    let k = parameters.stiffness_per_mass_per_s2;
    let elongations = |x: &Vector6<f64>| -> SVector<f64, LIMBS> {
        let [r, phi] = [0, 3].map(|i| DVec3::new(x[i], x[i + 1], x[i + 2]));
        elongations_m(&geometry::Geometry::PAPER, r, phi).into()
    };
    let jacobian = |x: &Vector6<f64>| {
        SMatrix::<f64, LIMBS, 6>::from_columns(&core::array::from_fn::<_, 6, _>(|axis| {
            let mut step = Vector6::zeros();
            step[axis] = STEP;
            (elongations(&(x + step)) - elongations(&(x - step))) / (2.0 * STEP)
        }))
    };
    let at_rest = jacobian(&Vector6::zeros());
    let inverse = (at_rest.transpose() * at_rest)
        .try_inverse()
        .expect("limbs that hold");
    let sin = phase.sin();
    let a = excitation.linear_shell_m_s2;
    let stacked = |v: DVec3| Vector6::new(v.x, v.y, v.z, 0.0, 0.0, 0.0);
    let omega2 = (TAU * excitation.frequency_hz).powi(2);
    // x = -G load / k swings with its load, and its acceleration is -omega^2 x.
    let relative = inverse * stacked(a * sin) * (omega2 / k);
    let turning = truth::sensor(parameters).inertia_per_mass.tensor_m2()
        * DVec3::new(relative[3], relative[4], relative[5]);
    let mut load = stacked(a * sin - *gravity) + relative;
    for axis in 0..3 {
        load[3 + axis] = turning[axis];
    }
    let mut x = Vector6::zeros();
    for _ in 0..ITERATIONS {
        let missing = jacobian(&x).transpose() * elongations(&x) + load / k;
        x -= inverse * missing;
    }
    elongations(&x) * -k
}

/// Phases of a period.
const PHASES: usize = 8;
/// Unknowns here: ln(k/m) and nine ln of scale factors; drifts are taken off with each trial's mean.
const UNKNOWNS: usize = 1 + LIMBS;

/// What the channels show of all trials in turn, by ln(k/m) and scale factors that are off by `x`, each trial's mean taken off.
fn shown(trials: &[Trial], x: &DVector<f64>) -> DVector<f64> {
    let mut parameters = truth::identified_parameters();
    parameters.stiffness_per_mass_per_s2 *= x[0].exp();
    let rows = trials.iter().flat_map(|trial| {
        let phase = |i: usize| TAU * i as f64 / PHASES as f64;
        let forces: Vec<_> = (0..PHASES)
            .map(|i| exact(&parameters, trial, phase(i)))
            .collect();
        let mean = forces.iter().sum::<SVector<f64, LIMBS>>() / PHASES as f64;
        forces.into_iter().flat_map(move |f| {
            let f = f - mean;
            (0..LIMBS)
                .map(move |i| f[i] * (-x[1 + i]).exp())
                .collect::<Vec<_>>()
        })
    });
    DVector::from_vec(rows.collect())
}

/// Noise of each trial, m/s^2: a share of the largest channel's amplitude.
fn noise(sensor: &LinearSensor, trials: &[Trial], share: f64) -> Vec<f64> {
    let of = |(excitation, _): &Trial| {
        share
            * largest(
                sensor
                    .response(excitation)
                    .expect("sound")
                    .force_per_mass_m_s2,
            )
    };
    trials.iter().map(of).collect()
}

/// Core's bound from these trials.
fn bound(sensor: &LinearSensor, trials: &[Trial], noise: &[f64], samples: usize) -> [f64; 2] {
    let size_m2 = truth::identified_parameters().inertia_per_mass.xx_m2;
    let mut tilted = Information::new(size_m2).expect("a size");
    let mut linear = tilted.clone();
    for ((excitation, gravity), noise) in trials.iter().zip(noise) {
        let phases: Vec<Response> = (0..PHASES)
            .map(|i| TAU * i as f64 / PHASES as f64)
            .map(|phase| sensor.tilted(excitation, *gravity, phase).expect("sound"))
            .collect();
        tilted.push_trial(&phases, *noise, samples).expect("noise");
        let response = sensor.response(excitation).expect("sound");
        linear.push(&response, *noise, samples).expect("noise");
    }
    [tilted, linear].map(|information| information.bound_with_inertia_known().expect("excited"))
}

/// The regressor by differences of the exact forces, each row over its noise.
fn regressor(trials: &[Trial], noise: &[f64]) -> DMatrix<f64> {
    /// Large against rounding over a share of 1e-6, small against one.
    const STEP: f64 = 1e-2;
    let columns: Vec<DVector<f64>> = (0..UNKNOWNS)
        .map(|unknown| {
            let step = DVector::from_fn(UNKNOWNS, |i, _| if i == unknown { STEP } else { 0.0 });
            let mut slope = (shown(trials, &step) - shown(trials, &-step)) / (2.0 * STEP.sinh());
            for (row, value) in slope.iter_mut().enumerate() {
                *value /= noise[row / (PHASES * LIMBS)];
            }
            slope
        })
        .collect();
    DMatrix::from_columns(&columns)
}

#[test]
fn ref_the_tilted_bound_is_that_of_an_exact_equilibrium() {
    const SAMPLES: usize = 100_000;
    let sensor = linear_sensor(&truth::identified_parameters());
    let trials = linear_trials(20);
    for (what, share) in [("noise of 1 %", 0.01), ("60 dB", 1e-3 / 2.0_f64.sqrt())] {
        let noise = noise(&sensor, &trials, share);
        let [ours, linear] = bound(&sensor, &trials, &noise, SAMPLES);
        let regressor = regressor(&trials, &noise);
        let inverse = regressor
            .pseudo_inverse(f64::EPSILON)
            .expect("the iteration ends");
        let theirs = inverse.row(0).norm() * (PHASES as f64 / SAMPLES as f64).sqrt();
        eprintln!("{what}: {ours} by core, {theirs} by differences, {linear} in linear theory");
        Row::new(
            "bound of ln(k/m), limbs tilted",
            (ours / theirs - 1.0).abs(),
            tolerance::TILTED_BOUND,
        )
        .case(what)
        .sides(theirs, ours, "")
        .judge();
        fails_clearly(
            format!("bound in linear theory, {what}"),
            (linear / theirs - 1.0).abs(),
            tolerance::TILTED_BOUND,
        );
    }
}

#[test]
fn stat_the_tilted_bound_is_attained() {
    const SAMPLES: usize = 100_000;
    const DRAWS: u64 = 400;
    const CORRECTIONS: usize = 3;
    /// Noise over the largest channel: few trials have to tell k/m to some per cent, for it to be linear.
    const SHARE: f64 = 1e-4;
    let sensor = linear_sensor(&truth::identified_parameters());
    let trials = linear_trials(2);
    let noise = noise(&sensor, &trials, SHARE);
    let [bound, _] = bound(&sensor, &trials, &noise, SAMPLES);
    let inverse = regressor(&trials, &noise)
        .pseudo_inverse(f64::EPSILON)
        .expect("the iteration ends");
    let mut rng = Pcg64::seed_from_u64(seed());
    let mut squares = 0.0;
    for _ in 0..DRAWS {
        // A truth that the estimator does not begin with.
        let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut off = DVector::from_fn(UNKNOWNS, |_, _| 1e-3 * unit());
        off[0] = 3.0 * bound * unit();
        let mut seen = shown(&trials, &off);
        // Of a phase as many samples as there are to it.
        let spread = (PHASES as f64 / SAMPLES as f64).sqrt();
        for (row, value) in seen.iter_mut().enumerate() {
            *value += noise[row / (PHASES * LIMBS)] * spread * unit();
        }
        let mut x = DVector::zeros(UNKNOWNS);
        for _ in 0..CORRECTIONS {
            let mut left = &seen - shown(&trials, &x);
            for (row, left) in left.iter_mut().enumerate() {
                *left /= noise[row / (PHASES * LIMBS)];
            }
            x += &inverse * left;
        }
        squares += ((x[0] - off[0]) / bound).powi(2);
    }
    eprintln!("attained over bound: {}", (squares / DRAWS as f64).sqrt());
    within(
        "spread of ln(k/m) over its tilted bound",
        chi_square_departure(squares, DRAWS as usize),
        tolerance::CHI_SQUARE,
    );
}
