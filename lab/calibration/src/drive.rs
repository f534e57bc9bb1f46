//! Frequency of the drive: what the session states of a trial, by which its low-pass and its harmonics go, against what was recorded.

mod along;

use sixaxis_core::LIMBS;

use crate::diagnosis::structure::varies_as_noise;
use crate::finding::{Cause, Finding};
use crate::frequency::frequency;
use crate::report::TrialReport;
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
pub fn seen_hz(trial: &Trial) -> Option<f64> {
    let of = |series: &[f64]| frequency(series, trial.sample_rate_hz, trial.frequency_hz);
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
    frequency(series, trial.sample_rate_hz, trial.frequency_hz)
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
        frequency(&series, trial.sample_rate_hz, trial.frequency_hz)
    };
    upper_median((0..LIMBS).filter_map(of))
}

/// Whether the standard that a trial needs, or both of a run that needs both, shows noise and no drive in it: it says nothing of any clock.
pub(crate) fn shows_noise_alone(trial: &Trial) -> bool {
    seen_hz(trial).is_none() && standard_varies_as_noise(trial)
}

fn standard_goes_along(trial: &Trial) -> bool {
    holds_of_standards(trial, |series| along::goes_along(series, &trial.voltage_v))
}

fn standard_varies_as_noise(trial: &Trial) -> bool {
    holds_of_standards(trial, varies_as_noise)
}

/// Whether something holds of the standard that a trial needs, or of both where it needs both.
fn holds_of_standards(trial: &Trial, holds: impl Fn(&[f64]) -> bool) -> bool {
    let linear = || holds(&trial.accelerometer_m_s2);
    let angular = || holds(&trial.gyroscope_rad_s);
    match trial.role {
        Role::Linear | Role::HighFrequencyLinear => linear(),
        Role::Angular => angular(),
        Role::Validation => linear() && angular(),
        Role::Static | Role::Tap => false,
    }
}

/// Whether neither the standard that a trial needs nor most channels show more than noise.
fn nothing_moves(trial: &Trial) -> bool {
    let of_limbs = (0..LIMBS).filter(|limb| {
        let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[*limb]).collect();
        varies_as_noise(&series)
    });
    standard_varies_as_noise(trial) && of_limbs.count() > LIMBS / 2
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
    let turns_otherwise = |trial: &Trial, seen_hz: f64| {
        let far = !(1.0 / ANOTHER..=ANOTHER).contains(&(seen_hz / trial.frequency_hz));
        // What is not far off is another motion's where the channels move as stated, and not with it.
        let off = || (seen_hz / trial.frequency_hz - 1.0).abs() > OFF;
        let limbs_as_stated =
            || of_limbs_hz(trial).is_some_and(|hz| (hz / trial.frequency_hz - 1.0).abs() < SAME);
        far || off() && limbs_as_stated() && !standard_goes_along(trial)
    };
    let all = trials.len();
    let (mut apart, mut still) = (Vec::new(), Vec::new());
    for trial in std::mem::take(trials) {
        match seen_hz(&trial) {
            Some(seen_hz) if turns_otherwise(&trial, seen_hz) => apart.push((trial, seen_hz)),
            None if shows_noise_alone(&trial) => still.push(trial),
            _ => trials.push(trial),
        }
    }
    let each = apart.iter().map(|(trial, seen_hz)| {
        let name = trial.name.as_str();
        (name, trial.frequency_hz, *seen_hz)
    });
    let mut standards = OfStandards::default();
    if let Some(evidence) = exchanged(&each.collect::<Vec<_>>()) {
        let finding = Finding::new(Cause::ClockMismatch, evidence, EXCHANGED);
        let names = apart.into_iter().map(|(trial, _)| trial.name);
        standards.found.push(finding.in_recordings(names));
        apart = Vec::new();
    }
    apart.retain(|(trial, seen_hz)| {
        let as_stated = |hz: &f64| (hz / trial.frequency_hz - 1.0).abs() < OFF;
        let limbs_hz = of_limbs_hz(trial).filter(as_stated);
        if limbs_hz.is_some() {
            let shows =
                format!("and the standard does not: by its signal it would be {seen_hz:.3} Hz");
            standards.does_not_go_along(trial, limbs_hz, &shows);
        }
        limbs_hz.is_none()
    });
    for trial in &still {
        let shows = "and the standard shows noise alone";
        standards.does_not_go_along(trial, of_limbs_hz(trial), shows);
    }
    let mut found = standards.findings();
    found.extend(of_another_drive(&apart, all));
    found
}

/// Trials whose channels move, and whose standard does not go along.
#[derive(Default)]
struct OfStandards {
    found: Vec<Finding>,
    /// Those of which the other standard does.
    of_the_other_kind: Vec<String>,
    /// Whether the drive of one of these is none of the session's.
    not_as_stated: bool,
}

impl OfStandards {
    /// Notes a trial whose channels move at `limbs_hz`, if they show it, and what its standard `shows`.
    fn does_not_go_along(&mut self, trial: &Trial, limbs_hz: Option<f64>, shows: &str) {
        let as_stated = limbs_hz.is_some_and(|hz| (hz / trial.frequency_hz - 1.0).abs() < OFF);
        let along = |hz: f64| limbs_hz.is_some_and(|limbs_hz| (hz / limbs_hz - 1.0).abs() < OFF);
        if seen_hz_of_the_other(trial).is_some_and(along) {
            self.of_the_other_kind.push(trial.name.clone());
            self.not_as_stated |= !as_stated;
            return;
        }
        let evidence = match limbs_hz {
            Some(hz) => format!(
                "the nine channels move at {hz:.3} Hz{}, {shows}",
                if as_stated { ", as stated" } else { "" }
            ),
            None => shows.trim_start_matches("and ").to_owned(),
        };
        let advice = "see the plug of the standard that this trial needs, reference_file and reference_start_s, and record the trial again";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        self.found.push(finding.in_trial(trial));
    }

    fn findings(mut self) -> Vec<Finding> {
        if !self.of_the_other_kind.is_empty() {
            let evidence = format!(
                "the nine channels move{}, and of the standards only the one that trials of the other kind need",
                if self.not_as_stated { "" } else { " as stated" }
            );
            let advice = "see whether files or roles of linear and angular trials are exchanged in the session";
            let finding = Finding::new(Cause::Unreadable, evidence, advice);
            self.found
                .push(finding.in_recordings(self.of_the_other_kind));
        }
        self.found
    }
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
