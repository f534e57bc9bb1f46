//! What the simulated laboratory is, and the calibration day that it is for.

use sixaxis_recordings::session::{Entry, Role, Session};
use sixaxis_reference::laboratory::plan::{Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::schedule::{PlannedTrial, trials};
use sixaxis_reference::laboratory::session_file;

/// Length of the static record, s.
pub const STATIC_S: f64 = 30.0;

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Seed of sensor, instruments and noise.
    pub seed: u64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Trials of each of steps 2 to 4.
    pub trials_per_step: usize,
    /// What computes the runs.
    pub engine: Engine,
}

impl Settings {
    /// The plan: a sensor scattered about the design, everything else as the paper has it.
    pub fn plan(&self) -> SessionPlan {
        SessionPlan {
            seed: self.seed,
            sensor: SensorChoice::Random,
            engine: self.engine,
            trials_per_step: self.trials_per_step,
            sample_rate_hz: self.sample_rate_hz,
            ..SessionPlan::default()
        }
    }

    /// What the laboratory writes down beforehand: sensor, instruments, rig, no recordings.
    pub fn session(&self) -> Session {
        session_file::session(&self.plan(), None, &[])
    }

    /// The calibration day: each recording with its length, s.
    pub fn day(&self) -> Vec<(Entry, f64)> {
        let plan = self.plan();
        let at_rest = Entry::new("static", Role::Static);
        let moving = |trial: &PlannedTrial| {
            let entry = Entry {
                direction: Some(trial.run.direction_ground.to_array()),
                frequency_hz: Some(trial.run.frequency_hz),
                ..Entry::new(&trial.name, trial.role)
            };
            (entry, trial.run.duration_s())
        };
        let planned = trials(&plan.rig, plan.trials_per_step, None);
        let mut all = vec![(at_rest, STATIC_S)];
        all.extend(planned.iter().map(moving));
        all
    }
}
