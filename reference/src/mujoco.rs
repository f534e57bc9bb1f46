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
use simulation::{Simulation, SimulationError, Snapshot};

/// Version of the MuJoCo library in use, as it reports itself.
pub fn version() -> &'static str {
    mujoco_rs::mujoco_version()
}

/// A motion as it is simulated, sample after sample and without an end; nothing is kept of what has gone by.
pub struct Playing<'a, M> {
    simulation: Simulation,
    motion: &'a M,
    step_s: f64,
    steps_per_sample: usize,
    samples: usize,
}

impl<'a, M: Motion> Playing<'a, M> {
    /// With `steps_per_sample` Runge-Kutta steps from sample to sample.
    ///
    /// # Errors
    /// Those of [`Simulation::new`].
    pub fn new(
        model: &SensorModel,
        motion: &'a M,
        sample_rate_hz: f64,
        steps_per_sample: usize,
    ) -> Result<Self, SimulationError> {
        let step_s = 1.0 / (sample_rate_hz * steps_per_sample as f64);
        Ok(Self {
            simulation: Simulation::new(model, step_s)?,
            motion,
            step_s,
            steps_per_sample,
            samples: 0,
        })
    }

    /// The state at the next sample.
    ///
    /// # Errors
    /// Those of [`Simulation::step`].
    pub fn next_sample(&mut self) -> Result<Snapshot, SimulationError> {
        let first = self.samples * self.steps_per_sample;
        self.samples += 1;
        let mut take = |step: usize| {
            // Counting steps keeps time exact; adding steps up would not.
            self.simulation.set_time_s(step as f64 * self.step_s);
            self.simulation.step(self.motion)
        };
        let now = take(first)?;
        for step in first + 1..first + self.steps_per_sample {
            take(step)?;
        }
        Ok(now)
    }
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
    let samples = (duration_s * sample_rate_hz).floor() as usize + 1;
    let mut playing = Playing::new(model, motion, sample_rate_hz, steps_per_sample)?;
    let mut result = SimulatedMotion {
        motion: motion.clone(),
        gravity_ground_m_s2: model.gravity_ground_m_s2,
        sample_rate_hz,
        limb_force_per_mass_m_s2: Vec::with_capacity(samples),
        truth: Vec::with_capacity(samples),
    };
    for _ in 0..samples {
        let now = playing.next_sample()?;
        let forces = &mut result.limb_force_per_mass_m_s2;
        forces.push(now.limb_force_per_mass_m_s2);
        result.truth.push(now.true_motion());
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
