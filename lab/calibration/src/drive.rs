//! Frequency of the drive: what the session states of a trial, by which its low-pass and its harmonics go, against what was recorded.

use sixaxis_core::LIMBS;

use crate::diagnosis::structure::varies_as_noise;
use crate::finding::{Cause, Finding};
use crate::report::TrialReport;
use crate::response::frequency;
use crate::series::upper_median;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Share by which a stated frequency may be off: a corner of the low-pass that is off by it takes as much off.
const OFF: f64 = 0.05;
/// Factor by which it is another motion's, and nothing can be done with the trial.
const ANOTHER: f64 = 1.5;
/// Share by which two drives at one setting may differ.
const SAME: f64 = 0.01;
/// Largest over smallest ratio of seen to stated frequencies that have one cause.
const ALIKE: f64 = 1.1;

/// Frequency by a trial's own standards and clock, where one shows three cycles or more; of two, the one nearer to what is stated.
#[must_use]
pub fn seen_hz(trial: &Trial) -> Option<f64> {
    let of = |series: &[f64]| frequency(series, trial.sample_rate_hz);
    let far = |hz: &f64| (hz / trial.frequency_hz).ln().abs();
    let linear = of(&trial.accelerometer_m_s2);
    let angular = of(&trial.gyroscope_rad_s);
    match trial.role {
        Role::Linear | Role::HighFrequencyLinear => linear,
        Role::Angular => angular,
        Role::Validation => {
            let both = [linear, angular].into_iter().flatten();
            both.min_by(|a, b| far(a).total_cmp(&far(b)))
        }
        Role::Static | Role::Tap => None,
    }
}

/// The same by the standard that trials of its kind do not need.
fn seen_hz_of_the_other(trial: &Trial) -> Option<f64> {
    let series = match trial.role {
        Role::Linear | Role::HighFrequencyLinear => &trial.gyroscope_rad_s,
        Role::Angular => &trial.accelerometer_m_s2,
        Role::Static | Role::Tap | Role::Validation => return None,
    };
    frequency(series, trial.sample_rate_hz)
}

/// The frequency as seen, where the session states another.
pub(crate) fn misstated_hz(report: &TrialReport) -> Option<f64> {
    let off = |seen_hz: &f64| (seen_hz / report.frequency_hz - 1.0).abs() > OFF;
    report.seen_hz.filter(off)
}

/// Both frequencies, and what the session's is used for.
pub(crate) fn both_in_words(stated_hz: f64, seen_hz: f64) -> String {
    format!(
        "the standards move at {seen_hz:.3} Hz by the recording's clock and the drive at {stated_hz:.3} Hz by the session, by which the low-pass goes"
    )
}

/// Recordings, each with its frequency as stated and as seen, of which each turns as another one should: in words.
pub(crate) fn exchanged(recordings: &[(&str, f64, f64)]) -> Option<String> {
    let turns_as = |seen_hz: f64| {
        let mut others = recordings.iter();
        others.find(|(_, stated_hz, _)| (seen_hz / stated_hz - 1.0).abs() < SAME)
    };
    let mut of: Vec<&str> = Vec::new();
    for (_, _, seen_hz) in recordings {
        of.push(turns_as(*seen_hz)?.0);
    }
    let each_once = recordings.iter().all(|(name, ..)| of.contains(name));
    let (first, _, seen_hz) = recordings.first()?;
    (each_once && recordings.len() > 1).then(|| {
        format!(
            "each turns as another of them should, {first} at the {seen_hz:.3} Hz of {}",
            of[0]
        )
    })
}

/// What to do about recordings that were exchanged.
pub(crate) const EXCHANGED: &str =
    "see which recording each entry of the session names: file, or reference_file";

/// Frequency by the nine channels of a trial, the middle one of those that show any.
fn of_limbs_hz(trial: &Trial) -> Option<f64> {
    let of = |limb: usize| {
        let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[limb]).collect();
        frequency(&series, trial.sample_rate_hz)
    };
    upper_median((0..LIMBS).filter_map(of))
}

/// Whether neither the standard that a trial needs nor most channels show more than noise.
fn nothing_moves(trial: &Trial) -> bool {
    let linear = || varies_as_noise(&trial.accelerometer_m_s2);
    let angular = || varies_as_noise(&trial.gyroscope_rad_s);
    let still = match trial.role {
        Role::Linear | Role::HighFrequencyLinear => linear(),
        Role::Angular => angular(),
        Role::Validation => linear() && angular(),
        Role::Static | Role::Tap => false,
    };
    let of_limbs = (0..LIMBS).filter(|limb| {
        let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[*limb]).collect();
        varies_as_noise(&series)
    });
    still && of_limbs.count() > LIMBS / 2
}

/// Takes out the trials in which nothing moves, and says so.
fn without_motion(trials: &mut Vec<Trial>) -> Option<Finding> {
    let still: Vec<Trial> = trials
        .extract_if(.., |trial| nothing_moves(trial))
        .collect();
    let evidence = "nothing moves: standard and channels show noise alone";
    let advice = "see whether the drive ran, and whether the file is this trial's; record it again";
    let finding = Finding::new(Cause::Unreadable, evidence, advice);
    (!still.is_empty()).then(|| finding.in_recordings(still.into_iter().map(|trial| trial.name)))
}

/// Takes out the trials whose drive is stated to be another's altogether, or whose standard does not show it, and says so.
pub(crate) fn set_aside(trials: &mut Vec<Trial>) -> Vec<Finding> {
    let still = without_motion(trials);
    let mut found: Vec<Finding> = still.into_iter().collect();
    found.extend(of_other_drives(trials));
    found
}

fn of_other_drives(trials: &mut Vec<Trial>) -> Vec<Finding> {
    let another = |trial: &Trial| {
        let seen_hz = seen_hz(trial)?;
        let far = !(1.0 / ANOTHER..=ANOTHER).contains(&(seen_hz / trial.frequency_hz));
        // What is not far off is another motion's where the channels move as stated.
        let off = || (seen_hz / trial.frequency_hz - 1.0).abs() > OFF;
        let limbs_as_stated =
            || of_limbs_hz(trial).is_some_and(|hz| (hz / trial.frequency_hz - 1.0).abs() < SAME);
        (far || off() && limbs_as_stated()).then_some(seen_hz)
    };
    let all = trials.len();
    let mut apart: Vec<(Trial, f64)> = Vec::new();
    for trial in std::mem::take(trials) {
        match another(&trial) {
            Some(seen_hz) => apart.push((trial, seen_hz)),
            None => trials.push(trial),
        }
    }
    let each = apart.iter().map(|(trial, seen_hz)| {
        let name = trial.name.as_str();
        (name, trial.frequency_hz, *seen_hz)
    });
    if let Some(evidence) = exchanged(&each.collect::<Vec<_>>()) {
        let finding = Finding::new(Cause::ClockMismatch, evidence, EXCHANGED);
        return vec![finding.in_recordings(apart.into_iter().map(|(trial, _)| trial.name))];
    }
    let (mut found, mut other_kind) = (Vec::new(), Vec::new());
    apart.retain(|(trial, seen_hz)| {
        let as_stated = |hz: &f64| (hz / trial.frequency_hz - 1.0).abs() < OFF;
        let Some(limbs_hz) = of_limbs_hz(trial).filter(as_stated) else {
            return true;
        };
        let evidence = format!(
            "the nine channels move at {limbs_hz:.3} Hz, as stated, and the standard does not: by its signal it would be {seen_hz:.3} Hz"
        );
        if seen_hz_of_the_other(trial).is_some_and(|hz| as_stated(&hz)) {
            other_kind.push(trial.name.clone());
            return false;
        }
        let advice = "see the plug of the standard that this trial needs, reference_file and reference_start_s, and record the trial again";
        found.push(Finding::new(Cause::Unreadable, evidence, advice).in_trial(trial));
        false
    });
    if !other_kind.is_empty() {
        let evidence = "the nine channels move as stated, and of the standards only the one that trials of the other kind need";
        let advice =
            "see whether files or roles of linear and angular trials are exchanged in the session";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        found.push(finding.in_recordings(other_kind));
    }
    found.extend(of_another_drive(&apart, all));
    found
}

/// Trials, each with the frequency that was seen, of so many in all.
fn of_another_drive(trials: &[(Trial, f64)], all: usize) -> Option<Finding> {
    let (first, seen_hz) = trials.first()?;
    let factors = || {
        let each = trials.iter();
        each.map(|(trial, seen_hz)| seen_hz / trial.frequency_hz)
    };
    let most = factors().fold(0.0, f64::max);
    let least = factors().fold(f64::INFINITY, f64::min);
    let by_the_clock = trials.len() == all && all > 1 && most < ALIKE * least;
    let both = both_in_words(first.frequency_hz, *seen_hz);
    let evidence = match trials.len() {
        1 => both,
        _ => format!("in the first of them {both}"),
    };
    let advice = what_to_correct((most * least).sqrt(), by_the_clock);
    let finding = Finding::new(Cause::ClockMismatch, evidence, advice);
    Some(finding.in_recordings(trials.iter().map(|(trial, _)| &trial.name)))
}

/// Frequencies that were seen, over the stated ones, of one or of all recordings: what to correct.
fn what_to_correct(factor: f64, all: bool) -> &'static str {
    let is = |unit: f64| (factor / unit).ln().abs() < ANOTHER.ln();
    if is(1e-3) {
        "the time stamps are milliseconds: write them in seconds, or give sample_rate_hz and leave them out"
    } else if is(1e-6) {
        "the time stamps are microseconds: write them in seconds, or give sample_rate_hz and leave them out"
    } else if is(1.0 / 60.0) {
        "frequency_hz is in turns a minute: give turns a second"
    } else if is(1.0 / core::f64::consts::TAU) && all {
        "frequency_hz is in radians a second: give turns a second"
    } else if all {
        "check the recordings' clock against the recorder, which all are off by the same factor: sample_rate_hz or \
         reference_sample_rate_hz where the session has one, the rate or the time stamps in the files where it has none"
    } else {
        "correct frequency_hz if the drive ran so; if it ran as stated, the clock of these recordings: sample_rate_hz, \
         reference_sample_rate_hz, or the time stamps; or name the right reference_file"
    }
}
