//! A whole calibration day: its recordings, its session file and, for the judges, the truth.

use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;
use sixaxis_recordings::session::Session;

use super::Laboratory;
use super::check::check;
use super::defect::Defect;
use super::error::SessionError;
use super::instruments::Instruments;
use super::mount::mounts;
use super::plan::SessionPlan;
use super::recording::SimulatedRecording;
use super::schedule::{PlannedTrial, trial_count, trials};
use super::session_file::session;
use super::spoil::{at_rest, played};
use super::tap;
use super::trial::Recorder;
use crate::sensor::TrueSensor;

/// Random stream of the static record.
const STATIC_STREAM: u128 = 7;

/// A simulated session.
#[derive(Debug, Clone)]
pub struct SimulatedSession {
    /// The session file.
    pub session: Session,
    /// Its recordings, the static one first.
    pub recordings: Vec<SimulatedRecording>,
    /// What the laboratory does not know.
    pub truth: Truth,
}

/// The truth behind a session.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// The plan.
    pub plan: SessionPlan,
    /// The sensor's true parameters.
    pub parameters: TrueSensor,
    /// The instruments as they are.
    pub instruments: Instruments,
    /// The defect, its particulars drawn.
    pub defect: Option<Defect>,
}

/// Simulates a session.
///
/// # Errors
/// [`SessionError`].
pub fn simulate_session(plan: &SessionPlan) -> Result<SimulatedSession, SessionError> {
    simulate_session_watched(plan, &|_| {})
}

/// Simulated time of all trials, ms: the work that [`simulate_session_watched`] reports on.
///
/// # Errors
/// [`SessionError::Plan`].
pub fn work_ms(plan: &SessionPlan) -> Result<u64, SessionError> {
    check(plan)?;
    let trials: u64 = trials(&plan.rig, plan.trials_per_step, None)
        .iter()
        .map(trial_ms)
        .sum();
    Ok(trials + plan.rig.taps as u64 * tap::WORK_MS)
}

fn trial_ms(trial: &PlannedTrial) -> u64 {
    (1e3 * trial.run.duration_s()) as u64
}

/// Simulates a session and says of each trial, when it is done, how long it was, ms; from any thread.
///
/// # Errors
/// [`SessionError`].
pub fn simulate_session_watched(
    plan: &SessionPlan,
    done_ms: &(dyn Fn(u64) + Sync),
) -> Result<SimulatedSession, SessionError> {
    check(plan)?;
    let defect = plan.true_defect();
    let defect = defect.as_ref();
    let played = &played(plan, defect);
    let laboratory = Laboratory {
        sensor: plan.true_sensor(),
        chain: played.measuring_chain(),
        instruments: played.true_instruments(),
        seed: plan.seed,
    };
    let recorder = Recorder {
        plan: played,
        defect,
        laboratory,
        mounts: mounts(played),
    };
    let mut recordings = vec![static_record(plan, &laboratory, defect)];
    let of_trials: Vec<SimulatedRecording> = trials(&played.rig, plan.trials_per_step, defect)
        .par_iter()
        .enumerate()
        .map(|(index, trial)| {
            let recording = recorder.record(index, trial)?;
            done_ms(trial_ms(trial));
            Ok(recording)
        })
        .collect::<Result<_, SessionError>>()?;
    recordings.extend(of_trials);
    let of_taps: Vec<SimulatedRecording> = (0..plan.rig.taps)
        .into_par_iter()
        .map(|index| {
            let recording = recorder.record_tap(index)?;
            done_ms(tap::WORK_MS);
            Ok(recording)
        })
        .collect::<Result<_, SessionError>>()?;
    recordings.extend(of_taps);
    Ok(SimulatedSession {
        session: session(plan, defect, &recordings),
        recordings,
        truth: Truth {
            plan: plan.clone(),
            parameters: laboratory.sensor,
            instruments: laboratory.instruments,
            // A share of the day is told by the recordings that it has, which may be none.
            defect: defect.map(|defect| Defect {
                place: defect.place(trial_count(plan.trials_per_step)),
                ..*defect
            }),
        },
    })
}

/// The static record with what a defect makes of it.
fn static_record(
    plan: &SessionPlan,
    laboratory: &Laboratory,
    defect: Option<&Defect>,
) -> SimulatedRecording {
    let zero = laboratory.sensor.zero_drift_v;
    let mut recording = laboratory.record_at_rest(
        plan.static_duration_s,
        plan.static_rate_hz,
        |share| at_rest(plan, zero, defect, share).0,
        &mut Pcg64::new(u128::from(plan.seed), STATIC_STREAM),
    );
    let samples = recording.voltage_v.len() as f64;
    for (sample, row) in recording.voltage_v.iter_mut().enumerate() {
        let (_, factor) = at_rest(plan, zero, defect, sample as f64 / samples);
        *row = core::array::from_fn(|limb| factor[limb] * row[limb]);
    }
    recording
}
