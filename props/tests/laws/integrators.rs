//! Orders of the schemes on the full equations, and attitude that stays a rotation.

use glam::{DQuat, DVec3};
use sixaxis_core::decouple::stream::Decoupler;
use sixaxis_core::paper::attitude;
use sixaxis_core::{Geometry, Scheme, Sensor, Settings};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::evidence::Row;
use sixaxis_props::manufactured::examples;
use sixaxis_props::manufactured::formulations::{
    Mass, ShellMotion, mass_attitude, mass_rate, shell_from_mass, solve,
};
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::manufactured::spin::spin;
use sixaxis_props::problem::rig;
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::threshold::log_slope;
use sixaxis_reference::rig::run::{Mounting, Run};

const RATE_HZ: f64 = 4_000.0;
const STEPS: usize = 20;

/// Largest error of the rate, rad/s.
fn rate_error(run: &SimulatedRun, scheme: Scheme) -> f64 {
    let parameters = truth::identified_parameters();
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(run, 0);
    let settings = Settings {
        scheme,
        gravity_ground_m_s2: recording.gravity_ground_m_s2,
        ..Settings::new(recording.sample_rate_hz)
    };
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: recording.gains(),
    };
    let mut decoupler =
        Decoupler::new(&sensor, &parameters, &settings).expect("parameters are sound");
    let mut error = 0.0;
    for row in &recording.voltage_v {
        if let Some(s) = decoupler.push(row).expect("samples are finite") {
            let truth = run.truth[s.sample as usize].rate_shell_rad_s;
            error = largest([error, (s.rate_shell_rad_s - truth).length()]);
        }
    }
    error
}

#[test]
fn order_of_every_scheme_on_simulated_motion() {
    let run = Run {
        rest_s: 0.01,
        ..rig::compound_run()
    };
    let parameters = truth::identified_parameters();
    let model = rig::model(&parameters, run.direction_ground, Mounting::AxisVertical);
    let fine = sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ, STEPS)
        .expect("the step is stable");
    for scheme in Scheme::ALL {
        let [coarse, half] = [8, 4].map(|factor| rate_error(&fine.decimated(factor), scheme));
        let order = (coarse / half).log2();
        within(
            format!("order of {}, simulated motion", scheme.name()),
            (order - f64::from(scheme.order())).abs(),
            tolerance::ORDER,
        );
    }
}

/// Finest step of the decade, s, and how many of them make each coarser one.
const FINEST_S: f64 = 3e-5;
const COARSER: [usize; 4] = [10, 5, 2, 1];
const FINEST_STEPS: usize = 4800;

/// Largest error of rate (rad/s) and of acceleration (m/s^2) with what the limbs say known exactly at each step.
fn exact_limb_errors(
    sensor: &Manufactured,
    truth: &[ShellMotion],
    scheme: Scheme,
    every: usize,
) -> [f64; 2] {
    let step_s = FINEST_S * every as f64;
    let moment = |i: usize| sensor.at(i as f64 * step_s);
    let start = mass_rate(&moment(0), DVec3::ZERO);
    let spin = spin(sensor, scheme, step_s, FINEST_STEPS / every, start);
    let mut attitude = DQuat::IDENTITY;
    let mut last = [DVec3::ZERO; 2];
    let mut errors = [0.0; 2];
    for (i, [rate, derivative]) in spin.into_iter().enumerate() {
        let moment = moment(i);
        let turn = moment.rotation;
        let [w_r, eps] = turn.rate();
        let w = turn.matrix() * rate - w_r;
        let now = [w, turn.matrix() * derivative + w_r.cross(w) - eps];
        if i > 0 {
            attitude = attitude::advance(attitude, [last[0], now[0]], [last[1], now[1]], step_s);
        }
        last = now;
        let mass = mass_attitude(&moment, attitude);
        let ours = shell_from_mass(sensor, &moment, rate, derivative, mass);
        let t = &truth[i * every];
        errors = [
            largest([errors[0], (w - t.rate_shell_rad_s).length()]),
            largest([
                errors[1],
                (ours.linear_ground_m_s2 - t.linear_ground_m_s2).length(),
            ]),
        ];
    }
    errors
}

#[test]
fn order_of_every_scheme_on_the_full_equations() {
    let sensor = examples::turning_from_rest();
    let truth = solve::<Mass>(&sensor, 1.0 / FINEST_S, FINEST_STEPS + 1, 4);
    let errors =
        |scheme: Scheme| COARSER.map(|every| exact_limb_errors(&sensor, &truth, scheme, every));
    for scheme in Scheme::ALL {
        let errors = errors(scheme);
        for (what, index) in [("rate", 0), ("acceleration", 1)] {
            let order = log_slope(
                COARSER
                    .iter()
                    .zip(errors)
                    .map(|(&every, e)| (every as f64, e[index])),
            );
            let theory = f64::from(scheme.order());
            let departure = match scheme {
                // Second order with a 64th of Heun's error; the interpolation's third order shows above that.
                Scheme::HeunSubstepped => (theory - order).max(0.0),
                _ => (order - theory).abs(),
            };
            Row::new(format!("order in {what}"), departure, tolerance::FULL_ORDER)
                .case(scheme.name())
                .sides(theory, order, "")
                .judge();
        }
    }
    let [heun, substepped] = [Scheme::Heun, Scheme::HeunSubstepped].map(|s| errors(s)[0][0]);
    within(
        "error of the sub-steps over Heun's",
        substepped / heun,
        tolerance::SUBSTEPS,
    );
}

/// Coefficients of the textbooks, newest first: Adams and Bashforth's predictors, Adams and Moulton's correctors.
const BASHFORTH: [&[f64]; 4] = [
    &[1.0],
    &[3.0 / 2.0, -1.0 / 2.0],
    &[23.0 / 12.0, -16.0 / 12.0, 5.0 / 12.0],
    &[55.0 / 24.0, -59.0 / 24.0, 37.0 / 24.0, -9.0 / 24.0],
];
const MOULTON: [&[f64]; 3] = [
    &[1.0 / 2.0, 1.0 / 2.0],
    &[5.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0],
    &[9.0 / 24.0, 19.0 / 24.0, -5.0 / 24.0, 1.0 / 24.0],
];

/// Euler's equation of the mass in its own axes, written down without principal axes: W' at a step.
struct Slope<'a> {
    sensor: &'a Manufactured,
    step_s: f64,
}

impl Slope<'_> {
    fn at(&self, step: usize, rate: DVec3) -> DVec3 {
        let inertia = self.sensor.inertia_mass_m2();
        let torque = self.sensor.at(step as f64 * self.step_s).torque_mass_m2_s2;
        inertia.inverse() * (torque - rate.cross(inertia * rate))
    }
}

/// Rates at every step by the textbook, with as many points as there are behind, up to `points`.
fn textbook(slope: &Slope, steps: usize, points: usize, corrected: bool) -> Vec<DVec3> {
    let sum = |weights: &[f64], slopes: &[DVec3]| {
        let newest_first = slopes.iter().rev();
        weights
            .iter()
            .zip(newest_first)
            .fold(DVec3::ZERO, |sum, (w, f)| sum + *f * *w)
    };
    let mut rates = vec![START];
    let mut slopes = vec![slope.at(0, START)];
    for step in 1..=steps {
        let rate = rates[rates.len() - 1];
        let behind = slopes.len().min(points);
        let mut next = rate + sum(BASHFORTH[behind - 1], &slopes) * slope.step_s;
        // An explicit scheme of several points takes its first step by Heun.
        if corrected || behind < points {
            let mut with_next = slopes.clone();
            with_next.push(slope.at(step, next));
            let weights = MOULTON[behind.min(MOULTON.len()) - 1];
            next = rate + sum(weights, &with_next) * slope.step_s;
        }
        slopes.push(slope.at(step, next));
        rates.push(next);
    }
    rates
}

const STEP_S: f64 = 1e-3;
/// Rate of the mass at the start, rad/s.
const START: DVec3 = DVec3::new(3.0, -2.0, 1.0);

#[test]
fn ref_schemes_are_the_textbooks() {
    const STEPS: usize = 40;
    let sensor = examples::turning();
    let slope = Slope {
        sensor: &sensor,
        step_s: STEP_S,
    };
    for (scheme, points, corrected) in [
        (Scheme::Euler, 1, false),
        (Scheme::Heun, 1, true),
        (Scheme::AdamsBashforth2, 2, false),
        (Scheme::AdamsMoulton4, 4, true),
    ] {
        let wanted = textbook(&slope, STEPS, points, corrected);
        let ours = spin(&sensor, scheme, STEP_S, STEPS, START);
        assert_eq!(ours.len(), wanted.len());
        let size = largest(wanted.iter().map(|w| w.length()));
        for ([ours, _], wanted) in ours.iter().zip(&wanted) {
            within(
                format!("{} against the textbook", scheme.name()),
                (*ours - *wanted).length() / size,
                tolerance::LAST_DIGITS,
            );
        }
    }
}

/// Runge and Kutta's scheme over a pair, its middle by Hermite's cubic.
#[test]
fn ref_pairs_are_runge_and_kuttas() {
    let sensor = examples::turning();
    let slope = Slope {
        sensor: &sensor,
        step_s: STEP_S,
    };
    let h = 2.0 * STEP_S;
    let mut wanted = vec![START];
    for first in [0, 2] {
        let start = wanted[first];
        let k1 = slope.at(first, start);
        let k2 = slope.at(first + 1, start + k1 * (h / 2.0));
        let k3 = slope.at(first + 1, start + k2 * (h / 2.0));
        let k4 = slope.at(first + 2, start + k3 * h);
        let end = start + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
        wanted.push((start + end) * 0.5 + (k1 - slope.at(first + 2, end)) * (h / 8.0));
        wanted.push(end);
    }
    let ours = spin(&sensor, Scheme::RungeKutta4, STEP_S, 4, START);
    assert_eq!(ours.len(), wanted.len());
    for ([ours, _], wanted) in ours.iter().zip(&wanted) {
        within(
            "Runge-Kutta over a pair",
            (*ours - *wanted).length() / START.length(),
            tolerance::LAST_DIGITS,
        );
    }
}

#[test]
fn inv_every_scheme_has_its_own_name() {
    let names: std::collections::BTreeSet<_> = Scheme::ALL.iter().map(|s| s.name()).collect();
    assert_eq!(names.len(), Scheme::ALL.len());
    assert!(names.iter().any(|name| name.contains("Heun")));
}
