//! Short runs of the calibration rig with the paper's sensor or one like it, simulated, recorded and decoupled: what most
//! suites on MuJoCo begin with.

use crate::truth;
use glam::DVec3;
use sixaxis_core::{Parameters, SixAxis};
use sixaxis_reference::laboratory::plan::RigPlan;
use sixaxis_reference::laboratory::schedule::compound_trials;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

use crate::compare::largest;

/// Sample rate, Hz, and Runge-Kutta steps from sample to sample.
pub const RATE_HZ: f64 = 10_000.0;
/// See [`RATE_HZ`].
pub const STEPS: usize = 4;

/// The simulated sensor with the paper's drawing, hung as the mounting has it.
pub fn model(parameters: &Parameters, direction: DVec3, mounting: Mounting) -> SensorModel {
    truth::model(parameters, mounting.gravity_ground_m_s2(direction))
}

/// The fastest run of Tables 4 to 6: compound motion at 5 Hz.
pub fn compound_run() -> Run {
    let [.., fastest] = compound_trials(&RigPlan::one_turn(Mounting::AxisVertical));
    fastest.run
}

/// Half a turn up and half a turn down at 5 Hz: short, and as violent as the rig gets.
pub fn short_run(mode: Mode, direction: DVec3) -> Run {
    Run {
        rest_s: 0.005,
        ramp_periods: 0.5,
        steady_periods: 0.25,
        ..Run::new(mode, 5.0, direction)
    }
}

/// Sample rate, Hz, of the runs of a short campaign, and Runge-Kutta steps from sample to sample.
pub const CAMPAIGN_RATE_HZ: f64 = 2_000.0;
/// See [`CAMPAIGN_RATE_HZ`].
pub const CAMPAIGN_STEPS: usize = 20;
/// Directions that span space, each with something of the others.
pub const DIRECTIONS: [DVec3; 3] = [
    DVec3::new(1.0, 0.2, 0.1),
    DVec3::new(-0.1, 1.0, 0.3),
    DVec3::new(0.2, -0.2, 1.0),
];

/// Simulates one trial of a short campaign: half a turn up and half a turn at full speed.
///
/// # Panics
/// If the simulation refuses.
pub fn simulate_trial(
    parameters: &Parameters,
    mode: Mode,
    frequency_hz: f64,
    direction: DVec3,
) -> SimulatedRun {
    let run = Run {
        rest_s: 0.01,
        ramp_periods: 0.5,
        steady_periods: 0.5,
        ..Run::new(mode, frequency_hz, direction)
    };
    let model = model(parameters, direction, Mounting::AxisVertical);
    sixaxis_reference::mujoco::simulate_run(&model, &run, CAMPAIGN_RATE_HZ, CAMPAIGN_STEPS)
        .expect("a run within the rig's limits simulates")
}

/// Simulates [`short_run`].
///
/// # Panics
/// If the simulation refuses.
pub fn simulate(
    parameters: &Parameters,
    mode: Mode,
    direction: DVec3,
    mounting: Mounting,
) -> SimulatedRun {
    let run = short_run(mode, direction);
    sixaxis_reference::mujoco::simulate_run(
        &model(parameters, direction, mounting),
        &run,
        RATE_HZ,
        STEPS,
    )
    .expect("a run within the rig's limits simulates")
}

/// Largest error of the accelerations over the peak of the vector: linear and angular.
pub fn errors(samples: &[SixAxis], run: &SimulatedRun) -> [f64; 2] {
    let (mut error, mut peak) = ([0.0; 2], [0.0; 2]);
    for s in samples {
        let t = &run.truth[s.sample as usize];
        for (i, (ours, truth)) in [
            (s.linear_ground_m_s2, t.linear_ground_m_s2),
            (s.angular_ground_rad_s2, t.angular_ground_rad_s2),
        ]
        .into_iter()
        .enumerate()
        {
            error[i] = largest([error[i], (ours - truth).length()]);
            peak[i] = largest([peak[i], truth.length()]);
        }
    }
    [error[0] / peak[0], error[1] / peak[1]]
}
