//! Orders of the schemes on the full equations, and attitude that stays a rotation.

use glam::{DQuat, DVec3};
use sixaxis_core::decoupler::Decoupler;
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
            scheme.name(),
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
