//! A session's recordings sorted by what they are for, and conditioned.
//!
//! A recording that cannot be used is a finding, not an error: the rest can still be calibrated with.

use std::io::ErrorKind;
use std::path::Path;

use rayon::prelude::*;
use sixaxis_core::{Geometry, Parameters};

use crate::conditioning::{Conditioned, Conditioning};
use crate::drive;
use crate::error::{Error, Result};
use crate::finding::{self, Cause, Finding, in_a_sentence};
use crate::progress::Progress;
use crate::reference_clock::{self, RateDifference};
use crate::series::deviation;
use crate::set_aside;
use crate::steps::Campaign;
use crate::trial::Trial;
use sixaxis_recordings::session::{LowPass, Role, Session, SessionFile, Stage};

/// Corner of the low-pass for validation runs over the drive's frequency: what is compared there is the gyroscope's second
/// derivative, and its noise must stay out. The drive loses 7e-6, the same on both sides.
pub const VALIDATION_CORNER: f64 = 4.4;

/// What a calibration works on.
#[derive(Debug, Clone)]
pub struct PreparedSession {
    /// The static record, if there is one.
    pub at_rest: Option<Trial>,
    /// Further ones.
    pub further_rests: Vec<Trial>,
    /// Trials of steps 2 to 4 and validation runs, conditioned, and the static record's voltages.
    pub campaign: Campaign,
    /// Taps.
    pub taps: Vec<Trial>,
    /// The conditioning of all trials but validation runs.
    pub conditioning: Conditioning,
    /// Recordings that cannot be used, those of one cause together.
    pub findings: Vec<Finding>,
    /// How files end that break off, each with its recordings.
    pub broken_off: Vec<(String, Vec<String>)>,
    /// By how much standards in files of their own are sampled faster than stated, where that was taken off.
    pub reference_clock: Option<RateDifference>,
}

impl PreparedSession {
    /// Reads and conditions all recordings of a session. Where standards have files of their own, with a quartz of their own, these are read at
    /// the rate that the trials show.
    ///
    /// # Errors
    /// [`sixaxis_recordings::Error::Session`]: a session whose own statements cannot be.
    pub fn read(file: &SessionFile, progress: &dyn Progress) -> Result<Self> {
        let stated = Self::read_faster(file, 0.0, progress)?;
        let read_faster = |faster| Self::read_faster(file, faster, progress);
        reference_clock::taken_off(&file.session, stated, read_faster)
    }

    /// Reads and conditions them with standards in files of their own sampled faster than stated by this share of their rate.
    fn read_faster(
        file: &SessionFile,
        reference_faster: f64,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let entries = &file.session.recording;
        progress.stage("reading", entries.len());
        let loaded: Vec<Result<(Trial, Option<String>)>> = (0..entries.len())
            .into_par_iter()
            .map(|index| {
                let trial = Trial::read_faster(file, index, reference_faster);
                progress.part();
                trial
            })
            .collect();
        let mut findings = Vec::new();
        let mut trials = Vec::new();
        let mut cuts: Vec<(String, Vec<String>)> = Vec::new();
        for (entry, trial) in entries.iter().zip(loaded) {
            match trial {
                Ok((trial, cut)) => {
                    if let Some(cut) = cut {
                        match cuts.iter_mut().find(|(other, _)| *other == cut) {
                            Some((_, names)) => names.push(trial.name.clone()),
                            None => cuts.push((cut, vec![trial.name.clone()])),
                        }
                    }
                    trials.push(trial);
                }
                Err(error @ Error::Recording(sixaxis_recordings::Error::Session { .. })) => {
                    return Err(error);
                }
                Err(error) => {
                    let name = entry.file.display().to_string();
                    let path = file.resolve(&entry.file);
                    let advice = advice(&error, &path);
                    let error = error.to_string();
                    let path = path.display().to_string();
                    // The finding names the recording; without it, one cause is one sentence.
                    let cause = error.strip_prefix(&path).unwrap_or(&error);
                    let cause = cause.trim_start_matches([':', ',', ' ']);
                    finding::unreadable(&mut findings, &name, cause, advice);
                }
            }
        }
        if findings.is_empty() {
            findings.extend(missing(&trials));
        }
        let mut prepared = Self::of(&file.session, trials, progress);
        findings.append(&mut prepared.findings);
        prepared.findings = findings;
        prepared.broken_off = cuts;
        Ok(prepared)
    }

    /// Sorts and conditions recordings that are in memory, as a session says.
    pub fn of(session: &Session, recordings: Vec<Trial>, progress: &dyn Progress) -> Self {
        Self::new(
            Conditioning::of(session),
            session.sensor.geometry(),
            session.sensor.design(),
            recordings,
            progress,
        )
    }

    /// The same of a sensor with these lengths and design values.
    pub fn new(
        conditioning: Conditioning,
        geometry: Geometry,
        design: Parameters,
        recordings: Vec<Trial>,
        progress: &dyn Progress,
    ) -> Self {
        let mut at_rest: Option<Trial> = None;
        let mut further_rests = Vec::new();
        let mut moving = Vec::new();
        let mut taps = Vec::new();
        for trial in recordings {
            match trial.role {
                // The first static record counts; one more at the end of the day says whether it still holds.
                Role::Static if at_rest.is_none() => at_rest = Some(trial),
                Role::Static => further_rests.push(trial),
                Role::Tap => taps.push(trial),
                _ => moving.push(trial),
            }
        }
        let mut findings = set_aside::copies(&mut moving);
        if conditioning.stages.outliers.settings().is_none() {
            findings.extend(set_aside::wild_standards(&mut moving));
        }
        findings.extend(drive::set_aside(&mut moving));
        findings.extend(set_aside::not_whole(&mut moving));
        if let Some(line) = conditioning.stages.detrend.settings() {
            findings.extend(moves_at_rest(&moving, line.rest_s));
        }
        findings.extend(without_the_drive(&moving, &conditioning));
        findings.extend(without_the_slope(&moving, &conditioning));
        progress.stage("conditioning", moving.len());
        let conditioned: Vec<(Trial, sixaxis_core::Result<Conditioned>)> = moving
            .into_par_iter()
            .map(|trial| {
                let conditioned = for_role(&conditioning, trial.role).condition(&trial);
                progress.part();
                (trial, conditioned)
            })
            .collect();
        let mut trials = Vec::new();
        for (trial, conditioned) in conditioned {
            match conditioned {
                Ok(conditioned) => trials.push((trial, conditioned)),
                Err(error) => {
                    finding::unreadable(&mut findings, &trial.name, &error.to_string(), MEND);
                }
            }
        }
        let static_voltage_v = at_rest.as_ref().map(|rest| rest.voltage_v.clone());
        Self {
            campaign: Campaign {
                geometry,
                design,
                static_voltage_v: static_voltage_v.unwrap_or_default(),
                trials,
            },
            at_rest,
            further_rests,
            taps,
            conditioning,
            findings,
            broken_off: Vec::new(),
            reference_clock: None,
        }
    }
}

impl PreparedSession {
    /// What was done to recordings beyond what the session says.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let clock = self.reference_clock.iter();
        clock.map(RateDifference::in_words).collect()
    }

    /// What recordings that can be used and are not whole leave to be desired.
    pub(crate) fn reservations(&self) -> impl Iterator<Item = String> {
        self.broken_off.iter().map(|(cut, names)| {
            let names = in_a_sentence(names).unwrap_or_default();
            format!("{names}: {cut}; record it again, or see that nothing of the trial is missing")
        })
    }
}

/// What the four steps cannot do without and the session has no recording of.
fn missing(trials: &[Trial]) -> impl Iterator<Item = Finding> {
    let wanted = [
        (
            Role::Static,
            "no static record, and step 1 needs one",
            "record the sensor at rest for ten minutes and enter it with role = \"static\"",
        ),
        (
            Role::Linear,
            "no linear trial, and step 2 needs some along at least three directions that are not in one plane",
            "record the sensor on the slider, on at least three wedges, and enter each trial with role = \"linear\"",
        ),
        (
            Role::Angular,
            "no angular trial, and step 3 needs some about at least three axes that are not in one plane",
            "record the sensor on the pinion, on at least three wedges, and enter each trial with role = \"angular\"",
        ),
    ];
    wanted
        .into_iter()
        .filter(|(role, ..)| !trials.iter().any(|trial| trial.role == *role))
        .map(|(_, lacks, advice)| {
            let evidence = format!("the session has {lacks}");
            Finding::new(Cause::Unreadable, evidence, advice)
        })
}

/// Corner of the low-pass over the drive's frequency below which less than a tenth of the motion is left.
const DRIVE_LOST: f64 = 0.75;
/// Share of the drive's angular acceleration by which the derivative may be off: as much as a validation run may be.
const SLOPE_LOST: f64 = 0.05;

/// Trials whose low-pass takes off the motion itself.
fn without_the_drive(trials: &[Trial], conditioning: &Conditioning) -> Option<Finding> {
    let evidence = |trial: &Trial| {
        let corner_hz = for_role(conditioning, trial.role).corner_hz(trial)?;
        (corner_hz < DRIVE_LOST * trial.frequency_hz).then(|| format!(
            "preprocessing.low_pass takes off the motion itself: its corner is {corner_hz:.2} Hz where the drive turns at {:.2} Hz",
            trial.frequency_hz
        ))
    };
    let advice = "set times_drive and plus_hz so that the corner is some times the drive's frequency; 4 and 8 are taken without";
    lost(trials, evidence, advice)
}

/// Trials whose angular acceleration the derivative does not show.
fn without_the_slope(trials: &[Trial], conditioning: &Conditioning) -> Option<Finding> {
    let evidence = |trial: &Trial| {
        let turns = matches!(trial.role, Role::Angular | Role::Validation);
        let differentiator = conditioning.differentiator(trial).ok().filter(|_| turns)?;
        let gain = differentiator.relative_gain(trial.frequency_hz);
        ((gain - 1.0).abs() > SLOPE_LOST).then(|| format!(
            "preprocessing.differentiator shows {gain:.3} of an angular acceleration at the drive's {:.2} Hz: its {} samples are too many for {} Hz",
            trial.frequency_hz,
            2 * conditioning.stages.differentiator.half_width + 1,
            trial.sample_rate_hz
        ))
    };
    let advice = "set half_width smaller, or order higher; 3 and 4 are taken without";
    lost(trials, evidence, advice)
}

/// Trials whose motion a stage takes off, with what is said of the first.
fn lost(
    trials: &[Trial],
    evidence: impl Fn(&Trial) -> Option<String>,
    advice: &str,
) -> Option<Finding> {
    let lost = || trials.iter().filter(|trial| evidence(trial).is_some());
    let finding = Finding::new(Cause::Unreadable, evidence(lost().next()?)?, advice);
    Some(finding.in_recordings(lost().map(|trial| &trial.name)))
}

/// Standard deviation of a standard within what is taken for rest, over that of the whole run, beyond which it is none.
const MOVES: f64 = 0.2;

/// Runs that move where a line is laid through their rests.
fn moves_at_rest(trials: &[Trial], rest_s: f64) -> Option<Finding> {
    // About the mean, for a standard may have a zero of its own. The standard of another motion shows noise, as much in a rest as in
    // the run: it does not clear a trial, nor does it accuse one.
    let moves = |trial: &&Trial| {
        let samples = (rest_s * trial.sample_rate_hz) as usize;
        let standards = [&trial.accelerometer_m_s2, &trial.gyroscope_rad_s];
        let mut shown = standards
            .into_iter()
            .filter(|s| deviation(s) > 0.0)
            .peekable();
        shown.peek().is_some()
            && shown.all(|series| {
                let samples = samples.min(series.len());
                let [first, last] = [&series[..samples], &series[series.len() - samples..]];
                deviation(first).max(deviation(last)) > MOVES * deviation(series)
            })
    };
    let moving: Vec<&Trial> = trials.iter().filter(moves).collect();
    let evidence = format!(
        "preprocessing.detrend lays a line through the first and the last {rest_s} s as rests, and the standards move there"
    );
    let advice =
        "take preprocessing.detrend out of the session, or state the rest_s that the runs have";
    let finding = Finding::new(Cause::Unreadable, evidence, advice);
    match moving.len() {
        0 => None,
        all if all == trials.len() => Some(finding),
        _ => Some(finding.in_recordings(moving.iter().map(|trial| &trial.name))),
    }
}

/// Validation runs have a low-pass of their own, whatever corner and order the session states for the others: what they are judged by needs
/// it. Without one they have none, either: of records without noise it takes off more than there is to be taken off.
pub(crate) fn for_role(conditioning: &Conditioning, role: Role) -> Conditioning {
    let mut own = conditioning.clone();
    if role == Role::Validation
        && let Stage::On(low_pass) = &mut own.stages.low_pass
    {
        *low_pass = LowPass {
            times_drive: VALIDATION_CORNER,
            plus_hz: 0.0,
            ..LowPass::default()
        };
    }
    own
}

/// What to do about a recording that cannot be used, where it says no more.
const MEND: &str = "mend or replace the recording; `sixaxis inspect` shows what is in it";

/// What to do about one that was refused so.
fn advice(error: &Error, recording: &Path) -> &'static str {
    use sixaxis_recordings::Error as Refusal;
    match error {
        Error::Recording(Refusal::Io { path, source }) if source.kind() == ErrorKind::NotFound => {
            if path.to_string_lossy().contains('\\') {
                "write / between the folders of the session's files"
            } else if path != recording {
                "correct `reference_file` in the session, which is relative to the session file, or put the recording of the standards there"
            } else {
                "correct `file` in the session, which is relative to the session file, or put the recording there"
            }
        }
        Error::Recording(Refusal::NoSuchChannel { .. }) => {
            "correct the names in the session's [channels], or give the recording its own"
        }
        Error::Recording(Refusal::UnitContradicted { .. }) => {
            "take the unit out of the session's [channels] where the files state theirs, or mend the file's heading if that is wrong"
        }
        Error::Recording(Refusal::Unit { .. }) => {
            "see that each name in the session's [channels] is that of its channel, accelerometer and gyroscope above all, and state the unit there if the file has none"
        }
        Error::Recording(Refusal::TooShort { which, .. }) if !which.is_empty() => {
            "see whether reference_file is this trial's, and reference_start_s and reference_sample_rate_hz are right: in s and Hz"
        }
        _ => MEND,
    }
}
