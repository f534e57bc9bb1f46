//! Orders of the schemes on the full equations, and attitude that stays a rotation.

use glam::{DQuat, DVec3};
use sixaxis_core::decoupler::Decoupler;
use sixaxis_core::dynamics::Instant;
use sixaxis_core::integrator::{Integrator, Settled};
use sixaxis_core::{Geometry, Scheme, Sensor, Settings, attitude};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::evidence::Row;
use sixaxis_props::manufactured::examples;
use sixaxis_props::manufactured::formulations::{Mass, ShellMotion, exact_instant, solve};
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::tolerance;
use sixaxis_reference::campaign::{self, Laboratory};
use sixaxis_reference::paper;
use sixaxis_reference::recording::SimulatedRun;
use sixaxis_reference::rig::{Mounting, Run};
use sixaxis_reference::threshold::log_slope;

const RATE_HZ: f64 = 4_000.0;
const STEPS: usize = 20;

/// Largest error of the rate, rad/s.
fn rate_error(run: &SimulatedRun, scheme: Scheme) -> f64 {
    let parameters = paper::identified_parameters();
    let recording = Laboratory::noise_free(parameters).record(run, 0);
    let settings = Settings {
        scheme,
        gravity_ground_m_s2: recording.gravity_ground_m_s2,
        ..Settings::new(recording.sample_rate_hz)
    };
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: recording.gains,
    };
    let mut decoupler =
        Decoupler::new(&sensor, &parameters, &settings).expect("parameters are sound");
    let mut error = 0.0;
    for row in &recording.voltage_v {
        for s in decoupler
            .push(row)
            .expect("samples are finite")
            .into_iter()
            .flatten()
        {
            let truth = run.truth[s.sample as usize].rate_shell_rad_s;
            error = largest([error, (s.rate_shell_rad_s - truth).length()]);
        }
    }
    error
}

#[test]
fn order_of_every_scheme_on_simulated_motion() {
    let [.., trial] = campaign::compound(Mounting::AxisVertical);
    let run = Run {
        rest_s: 0.01,
        ..trial.run
    };
    let model = trial.model(&paper::identified_parameters());
    let fine = SimulatedRun::simulate(&model, &run, RATE_HZ, STEPS).expect("the step is stable");
    for scheme in Scheme::ALL {
        let [coarse, half] = [8, 4].map(|factor| rate_error(&fine.decimated(factor), scheme));
        let order = (coarse / half).log2();
        within(
            &format!("order of {}, simulated motion", scheme.name()),
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
    let mut integrator = Integrator::new(scheme, step_s, DVec3::ZERO);
    let mut settled: Vec<Settled> = Vec::new();
    for i in (0..=FINEST_STEPS).step_by(every) {
        let instant = exact_instant(sensor, i as f64 * FINEST_S);
        settled.extend(integrator.push(instant).into_iter().flatten());
    }
    let mut attitude = DQuat::IDENTITY;
    let mut errors = [0.0; 2];
    for (i, pair) in settled.windows(2).enumerate() {
        attitude = attitude::advance(
            attitude,
            [pair[0].rate_shell_rad_s, pair[1].rate_shell_rad_s],
            [0, 1].map(|k| pair[k].angular_acceleration_shell_rad_s2),
            step_s,
        );
        let (now, t) = (&pair[1], &truth[(i + 1) * every]);
        let force = now
            .instant
            .specific_force_shell_m_s2(now.rate_shell_rad_s, now.angular_acceleration_shell_rad_s2);
        let acceleration = attitude * force + sensor.gravity_ground_m_s2;
        errors = [
            largest([
                errors[0],
                (now.rate_shell_rad_s - t.rate_shell_rad_s).length(),
            ]),
            largest([errors[1], (acceleration - t.linear_ground_m_s2).length()]),
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
            Row::new(
                format!("order in {what}"),
                departure,
                tolerance::FULL_ORDER.limit,
            )
            .case(scheme.name())
            .sides(theory, order, "")
            .judge(tolerance::FULL_ORDER);
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

/// Rates at every `step_s` by the textbook, with as many points as there are behind, up to `points`.
fn textbook(instants: &[Instant], step_s: f64, points: usize, corrected: bool) -> Vec<DVec3> {
    let sum = |weights: &[f64], slopes: &[DVec3]| {
        let newest_first = slopes.iter().rev();
        weights
            .iter()
            .zip(newest_first)
            .fold(DVec3::ZERO, |sum, (w, f)| sum + *f * *w)
    };
    let mut rates = vec![DVec3::ZERO];
    let mut slopes = vec![instants[0].angular_acceleration_shell_rad_s2(DVec3::ZERO)];
    for instant in &instants[1..] {
        let rate = rates[rates.len() - 1];
        let behind = slopes.len().min(points);
        let mut next = rate + sum(BASHFORTH[behind - 1], &slopes) * step_s;
        // An explicit scheme of several points takes its first step by Heun.
        if corrected || behind < points {
            let mut with_next = slopes.clone();
            with_next.push(instant.angular_acceleration_shell_rad_s2(next));
            next = rate + sum(MOULTON[behind.min(MOULTON.len()) - 1], &with_next) * step_s;
        }
        slopes.push(instant.angular_acceleration_shell_rad_s2(next));
        rates.push(next);
    }
    rates
}

#[test]
fn ref_schemes_are_the_textbooks() {
    const STEP_S: f64 = 1e-3;
    let sensor = examples::turning();
    let instants: Vec<Instant> = (0..40)
        .map(|i| exact_instant(&sensor, f64::from(i) * STEP_S))
        .collect();
    for (scheme, points, corrected) in [
        (Scheme::Euler, 1, false),
        (Scheme::Heun, 1, true),
        (Scheme::AdamsBashforth2, 2, false),
        (Scheme::AdamsMoulton4, 4, true),
    ] {
        let wanted = textbook(&instants, STEP_S, points, corrected);
        let mut integrator = Integrator::new(scheme, STEP_S, DVec3::ZERO);
        let size = largest(wanted.iter().map(|w| w.length()));
        for (instant, wanted) in instants.iter().zip(&wanted) {
            let [settled, none] = integrator.push(*instant);
            assert!(none.is_none());
            let ours = settled.expect("one sample settles one").rate_shell_rad_s;
            within(
                &format!("{} against the textbook", scheme.name()),
                (ours - *wanted).length() / size,
                tolerance::LAST_DIGITS,
            );
        }
    }
}

/// Runge and Kutta's scheme over a pair, its middle by Hermite's cubic, and Heun for a sample left over.
#[test]
fn ref_pairs_are_runge_and_kuttas() {
    const STEP_S: f64 = 1e-3;
    let sensor = examples::turning();
    let [a, b, c, d] = [0.0, 1.0, 2.0, 3.0].map(|i| exact_instant(&sensor, i * STEP_S));
    let (h, f) = (2.0 * STEP_S, |i: &Instant, w| {
        i.angular_acceleration_shell_rad_s2(w)
    });
    let start = DVec3::new(3.0, -2.0, 1.0);
    let k1 = f(&a, start);
    let k2 = f(&b, start + k1 * (h / 2.0));
    let k3 = f(&b, start + k2 * (h / 2.0));
    let k4 = f(&c, start + k3 * h);
    let end = start + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    let middle = (start + end) * 0.5 + (k1 - f(&c, end)) * (h / 8.0);
    let last = end + (f(&c, end) + f(&d, end + f(&c, end) * STEP_S)) * (STEP_S / 2.0);
    let mut integrator = Integrator::new(Scheme::RungeKutta4, STEP_S, start);
    let mut ours = Vec::new();
    for instant in [a, b, c, d] {
        ours.extend(integrator.push(instant).into_iter().flatten());
    }
    ours.extend(integrator.finish());
    let ours: Vec<DVec3> = ours.iter().map(|s| s.rate_shell_rad_s).collect();
    assert_eq!(ours.len(), 4);
    for (ours, wanted) in ours.iter().zip([start, middle, end, last]) {
        within(
            "Runge-Kutta over a pair",
            (*ours - wanted).length() / end.length(),
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
