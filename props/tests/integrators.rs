//! Orders of the schemes on the full equations, and attitude that stays a rotation.

use glam::{DQuat, DVec3};
use sixaxis_core::decoupler::Decoupler;
use sixaxis_core::{Geometry, Scheme, Sensor, Settings, attitude};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::tolerance;
use sixaxis_reference::campaign::{self, Laboratory};
use sixaxis_reference::paper;
use sixaxis_reference::recording::SimulatedRun;
use sixaxis_reference::rig::{Mounting, Run};

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
            scheme.name(),
            (order - f64::from(scheme.order())).abs(),
            tolerance::ORDER,
        );
    }
}

#[test]
fn inv_attitude_stays_a_rotation() {
    let mut q = DQuat::IDENTITY;
    let step_s = 1e-4;
    for i in 0..1_000_000_u32 {
        let t = f64::from(i) * step_s;
        let rate = |t: f64| DVec3::new(50.0 * t.sin(), 30.0 * (1.3 * t).cos(), -20.0);
        let slope = |t: f64| DVec3::new(50.0 * t.cos(), -39.0 * (1.3 * t).sin(), 0.0);
        q = attitude::advance(
            q,
            [rate(t), rate(t + step_s)],
            [slope(t), slope(t + step_s)],
            step_s,
        );
    }
    within(
        "norm of the quaternion",
        (q.length() - 1.0).abs(),
        tolerance::ROUNDING,
    );
}

#[test]
fn order_attitude_is_of_fourth_order() {
    // A rate that turns: without the commutator term the order would be two.
    let rate = |t: f64| DVec3::new(20.0 * (9.0 * t).cos(), 20.0 * (9.0 * t).sin(), 5.0);
    let slope = |t: f64| DVec3::new(-180.0 * (9.0 * t).sin(), 180.0 * (9.0 * t).cos(), 0.0);
    let end = |steps: u32| {
        let h = 1.0 / f64::from(steps);
        (0..steps).fold(DQuat::IDENTITY, |q, i| {
            let (a, b) = (f64::from(i) * h, f64::from(i + 1) * h);
            attitude::advance(q, [rate(a), rate(b)], [slope(a), slope(b)], h)
        })
    };
    let truth = end(20_000);
    let error = |steps| {
        (end(steps) - truth)
            .length()
            .min((end(steps) + truth).length())
    };
    let order = (error(200) / error(400)).log2();
    within(
        "order of the attitude",
        (order - 4.0).abs(),
        tolerance::ORDER,
    );
}
