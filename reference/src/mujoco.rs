//! MuJoCo as truth: the sensor as two free bodies and nine tendons, its shell driven exactly along a prescribed motion.
//!
//! [`model`] writes the sensor in MuJoCo's XML, [`simulation`] takes its steps. [`ring_down`] measures the six natural modes,
//! [`threshold`] repeats Fig. 7. Behind the feature `mujoco`: without it nothing here exists and nothing is linked.

pub mod model;
pub mod ring_down;
pub mod simulation;
mod state;
pub mod threshold;

use crate::motion::{Motion, SimulatedMotion, SimulatedRun};
use crate::rig::run::Run;
use model::SensorModel;
use simulation::{Simulation, SimulationError};

/// Version of the MuJoCo library in use, as it reports itself.
#[must_use]
pub fn version() -> &'static str {
    mujoco_rs::mujoco_version()
}

/// Simulates `duration_s` of a motion with `steps_per_sample` Runge-Kutta steps from sample to sample.
///
/// # Errors
/// Those of [`Simulation`].
pub fn simulate<M: Motion + Clone>(
    model: &SensorModel,
    motion: &M,
    duration_s: f64,
    sample_rate_hz: f64,
    steps_per_sample: usize,
) -> Result<SimulatedMotion<M>, SimulationError> {
    let step_s = 1.0 / (sample_rate_hz * steps_per_sample as f64);
    let samples = (duration_s * sample_rate_hz).floor() as usize + 1;
    let mut simulation = Simulation::new(model, step_s)?;
    let mut result = SimulatedMotion {
        motion: motion.clone(),
        gravity_ground_m_s2: model.gravity_ground_m_s2,
        sample_rate_hz,
        limb_force_per_mass_m_s2: Vec::with_capacity(samples),
        truth: Vec::with_capacity(samples),
    };
    for sample in 0..samples {
        for substep in 0..steps_per_sample {
            let step = sample * steps_per_sample + substep;
            // Counting steps keeps time exact; adding steps up would not.
            simulation.set_time_s(step as f64 * step_s);
            let now = simulation.step(motion)?;
            if substep == 0 {
                let forces = &mut result.limb_force_per_mass_m_s2;
                forces.push(now.limb_force_per_mass_m_s2);
                result.truth.push(now.true_motion());
            }
        }
    }
    Ok(result)
}

/// [`simulate`] for a whole run of the rig.
///
/// # Errors
/// Those of [`Simulation`].
pub fn simulate_run(
    model: &SensorModel,
    run: &Run,
    sample_rate_hz: f64,
    steps_per_sample: usize,
) -> Result<SimulatedRun, SimulationError> {
    let duration_s = run.duration_s();
    simulate(model, run, duration_s, sample_rate_hz, steps_per_sample)
}
