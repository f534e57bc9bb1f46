//! A session's recordings, read, sorted by what they are for, and conditioned.
//!
//! A recording that cannot be used is a finding, not an error: the rest is still worth knowing.

use rayon::prelude::*;

use super::Watch;
use crate::conditioning::{Conditioned, Conditioning};
use crate::error::{Error, Result};
use crate::load;
use crate::suspicion::{Cause, Finding};
use crate::trial::Trial;
use sixaxis_recordings::session::{Role, SessionFile, Stage};

/// Corner of the low-pass for validation runs over the drive's frequency: what is compared there is the gyroscope's second
/// derivative, and its noise must stay out. The drive loses 7e-6, the same on both sides.
pub const VALIDATION_CORNER: f64 = 4.4;

/// What there is to judge.
pub(super) struct Gathered {
    /// The static record, if one could be read.
    pub at_rest: Option<Trial>,
    /// Trials of steps 2 to 4 and validation runs, conditioned.
    pub trials: Vec<(Trial, Conditioned)>,
    /// Taps.
    pub struck: Vec<Trial>,
    /// The conditioning that was done, but for validation runs.
    pub conditioning: Conditioning,
    /// What could not be used.
    pub findings: Vec<Finding>,
}

/// Reads and cleans all recordings.
///
/// # Errors
/// [`sixaxis_recordings::Error::Session`]: a session whose own statements cannot be.
pub(super) fn gather(file: &SessionFile, watch: &dyn Watch) -> Result<Gathered> {
    let entries = &file.session.recording;
    watch.stage("reading", entries.len());
    let loaded: Vec<Result<Trial>> = (0..entries.len())
        .into_par_iter()
        .map(|index| {
            let trial = load::trial(file, index);
            watch.part();
            trial
        })
        .collect();
    let mut findings = Vec::new();
    let mut at_rest = None;
    let mut moving = Vec::new();
    let mut struck = Vec::new();
    for (entry, trial) in entries.iter().zip(loaded) {
        match trial {
            Ok(trial) if entry.role == Role::Static && at_rest.is_none() => at_rest = Some(trial),
            // The first static record counts; one more at the end of the day does no harm.
            Ok(_) if entry.role == Role::Static => {}
            Ok(trial) if entry.role == Role::Tap => struck.push(trial),
            Ok(trial) => moving.push(trial),
            Err(error @ Error::Recording(sixaxis_recordings::Error::Session { .. })) => {
                return Err(error);
            }
            Err(error) => {
                findings.push(unreadable(
                    &entry.file.display().to_string(),
                    error.to_string(),
                ));
            }
        }
    }
    if at_rest.is_none() && findings.is_empty() {
        findings.push(Finding {
            cause: Cause::Unreadable,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: "the session has no static record, and step 1 needs one".to_owned(),
            advice: "record the sensor at rest for ten minutes and enter it with role = \"static\""
                .to_owned(),
        });
    }
    let conditioning = Conditioning::of(&file.session);
    watch.stage("conditioning", moving.len());
    let conditioned: Vec<(Trial, sixaxis_core::Result<Conditioned>)> = moving
        .into_par_iter()
        .map(|trial| {
            let mut own = conditioning.clone();
            if trial.role == Role::Validation
                && let Stage::On(low_pass) = &mut own.stages.low_pass
            {
                low_pass.times_drive = VALIDATION_CORNER;
                low_pass.plus_hz = 0.0;
            }
            let conditioned = own.condition(&trial);
            watch.part();
            (trial, conditioned)
        })
        .collect();
    let mut trials = Vec::new();
    for (trial, conditioned) in conditioned {
        match conditioned {
            Ok(conditioned) => trials.push((trial, conditioned)),
            Err(error) => findings.push(unreadable(&trial.name, error.to_string())),
        }
    }
    Ok(Gathered {
        at_rest,
        trials,
        struck,
        conditioning,
        findings,
    })
}

fn unreadable(name: &str, evidence: String) -> Finding {
    Finding {
        cause: Cause::Unreadable,
        recordings: vec![name.to_owned()],
        channels: Vec::new(),
        evidence,
        advice: "mend or replace the recording; `sixaxis inspect` shows what is in it".to_owned(),
    }
}
