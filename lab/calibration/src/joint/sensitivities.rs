//! What the joint fit says of the channels' sensitivities: each trial has its own, and an ordinary room leaves them alike.
//!
//! One that goes along with the day is fading. Where most of the nine do so alike, it is one thing that all channels share: the standard
//! that they are held against, or the temperature of the sensor. One channel's that is another from some trial on has stepped: a piezo that was knocked, a
//! plug that was seated anew; or it is another in the trials that turn. Any other that one channel has in one trial is that channel's there. Several in one trial or in several are
//! something else's doing: an exchange, a turned polarity.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::Known;

use super::JointReport;
use super::account::SIGNIFICANT;
use crate::diagnosis::level::of_one_channel;
use crate::finding::{Cause, Finding};
use crate::series::median;

/// Change of one channel's sensitivity in one trial, or over the day, relative, from which it is more than an ordinary room's.
const SENSITIVITY: f64 = 0.01;
/// Change beyond which a step is no sensor's but a gain's, relative.
const GAINS: f64 = 0.2;
/// Trials on either side of a step.
const FEWEST: usize = 3;
/// Share of a channel's change that others of the same trial may have beside it.
const BESIDE: f64 = 0.2;
/// Channels from which on a change is all channels'.
const MOST: usize = 2 * LIMBS / 3;
/// Share of a change by which another one may differ that has the same cause.
const ALIKE: f64 = 0.3;
/// Share of its sensitivities' scatter that a line over the day, or a step, explains where a channel fades or steps.
const EXPLAINED: f64 = 0.9;

/// How one channel's sensitivity changes over the day, relative.
#[derive(Debug, Clone, Copy)]
enum Course {
    /// Along the line that most channels share.
    WithTheOthers,
    /// Along a line, from the first trial to the last.
    Fading(f64),
    /// From the trial of this index on.
    Step(usize, f64),
    /// In the trials that turn.
    Turning(f64),
}

/// Line through the values of all trials.
struct Line {
    /// From the first trial to the last.
    change: f64,
    /// Squares about the mean that it explains, and all of them.
    explained: f64,
    whole: f64,
}

impl Line {
    /// None through fewer than two values.
    fn through(values: &[f64]) -> Option<Self> {
        let last = values.len().checked_sub(1).filter(|last| *last > 0)? as f64;
        let (mean, whole) = mean_and_squares(values);
        let place = |trial: usize| trial as f64 / last - 0.5;
        let (mut product, mut squares) = (0.0, 0.0);
        for (trial, value) in values.iter().enumerate() {
            product += place(trial) * (value - mean);
            squares += place(trial) * place(trial);
        }
        let change = product / squares;
        Some(Self {
            change,
            explained: change * product,
            whole,
        })
    }

    /// Whether it is more than an ordinary room's, and what the values do.
    fn is_named(&self) -> bool {
        self.change.abs() > SENSITIVITY && self.explained > EXPLAINED * self.whole
    }
}

/// What most channels' sensitivities change by alike.
struct Common {
    /// From the first trial to the last, relative.
    change: f64,
    /// The channels that do.
    alike: [bool; LIMBS],
}

/// Two groups of trials.
struct Levels {
    /// What one shows more than the other, relative.
    change: f64,
    /// Share of all trials' scatter that this is.
    explained: f64,
}

impl JointReport {
    /// Whether at most one channel of a trial, and one trial of a channel, has a sensitivity of its own that no course over the day explains.
    pub(super) fn odd_channels_are_single(&self) -> bool {
        let courses: [bool; LIMBS] = core::array::from_fn(|limb| self.course(limb).is_some());
        let odd: Vec<[bool; LIMBS]> = self
            .estimate
            .trials
            .iter()
            .map(|trial| {
                core::array::from_fn(|limb| !courses[limb] && is_odd(trial.sensitivity[limb]))
            })
            .collect();
        let count = |all: &mut dyn Iterator<Item = bool>| all.filter(|odd| *odd).count();
        odd.iter()
            .all(|trial| count(&mut trial.iter().copied()) <= 1)
            && (0..LIMBS).all(|limb| count(&mut odd.iter().map(|trial| trial[limb])) <= 1)
    }

    /// The course of a channel's sensitivity over the day, if it has one that is more than an ordinary room's. Several channels that step
    /// have not been knocked together.
    fn course(&self, limb: usize) -> Option<Course> {
        if self.common().is_some_and(|common| common.alike[limb]) {
            return Some(Course::WithTheOthers);
        }
        if let Some(change) = self.fading(limb) {
            return Some(Course::Fading(change));
        }
        let course = |limb| {
            let step = self
                .step(limb)
                .map(|(from, change)| Course::Step(from, change));
            step.or_else(|| self.turning(limb).map(Course::Turning))
        };
        let mut others = (0..LIMBS).filter(|other| *other != limb);
        course(limb).filter(|_| others.all(|other| course(other).is_none()))
    }

    /// What a channel shows in each trial, and its mean and squares about that.
    fn values(&self, limb: usize) -> (Vec<f64>, f64, f64) {
        let trials = self.estimate.trials.iter();
        let values: Vec<f64> = trials.map(|t| t.sensitivity[limb].value).collect();
        let (mean, squares) = mean_and_squares(&values);
        (values, mean, squares)
    }

    fn is_certain(&self, limb: usize) -> bool {
        let mut trials = self.estimate.trials.iter();
        trials.any(|t| is_significant(t.sensitivity[limb]))
    }

    fn fading(&self, limb: usize) -> Option<f64> {
        let line = Line::through(&self.values(limb).0)?;
        (self.is_certain(limb) && line.is_named()).then_some(line.change)
    }

    /// The change over the day that most channels share. Each channel's own scatter hides it more than that of their mean does: where one of
    /// them is certain, the others need not be.
    fn common(&self) -> Option<Common> {
        let changes: Vec<f64> = (0..LIMBS)
            .map(|limb| Some(Line::through(&self.values(limb).0)?.change))
            .collect::<Option<_>>()?;
        let usual = median(changes.iter().copied())?;
        let alike: [bool; LIMBS] = core::array::from_fn(|limb| is_alike(changes[limb], usual));
        let count = alike.iter().filter(|alike| **alike).count();
        let is_certain = (0..LIMBS).any(|limb| alike[limb] && self.is_certain(limb));
        let trials = self.estimate.trials.iter();
        let means = trials.map(|trial| {
            let of_all = trial.sensitivity.iter().zip(alike);
            let of_those = of_all.filter(|(_, alike)| *alike).map(|(own, _)| own.value);
            of_those.sum::<f64>() / count as f64
        });
        let line = Line::through(&means.collect::<Vec<f64>>())?;
        (count >= MOST && is_certain && line.is_named()).then_some(Common {
            change: line.change,
            alike,
        })
    }

    /// By how much the sensitivities of most channels change alike from the first trial to the last, relative, where that is more than an
    /// ordinary room's.
    pub fn common_change(&self) -> Option<f64> {
        self.common().map(|common| common.change)
    }

    /// Whether they change as they seem to where the standard that they are held against changes by so much over the day.
    pub fn is_the_accelerometers(&self, accelerometer_changes: f64) -> bool {
        self.common_change()
            .is_some_and(|change| is_alike(-accelerometer_changes, change))
    }

    /// The trial from which on a channel shows more or less, and by how much.
    fn step(&self, limb: usize) -> Option<(usize, f64)> {
        let trials = self.estimate.trials.len();
        let of = |from: usize| Some((from, self.two_levels(limb, |trial| trial >= from)?));
        let all = (FEWEST..trials.saturating_sub(FEWEST - 1)).filter_map(of);
        let (from, levels) = all.max_by(|a, b| a.1.explained.total_cmp(&b.1.explained))?;
        self.is_named(limb, &levels)
            .then_some((from, levels.change))
    }

    /// By how much more a channel shows in the trials that turn.
    fn turning(&self, limb: usize) -> Option<f64> {
        let turns = |trial: usize| self.estimate.trials[trial].centre_m.is_some();
        let levels = self.two_levels(limb, turns)?;
        self.is_named(limb, &levels).then_some(levels.change)
    }

    /// What a channel shows in some trials against the others.
    fn two_levels(&self, limb: usize, wanted: impl Fn(usize) -> bool) -> Option<Levels> {
        let (values, mean, whole) = self.values(limb);
        let (mut some, mut others) = (Vec::new(), Vec::new());
        for (trial, value) in values.iter().enumerate() {
            if wanted(trial) {
                &mut some
            } else {
                &mut others
            }
            .push(*value);
        }
        let counts = [some.len() as f64, others.len() as f64];
        let change = some.iter().sum::<f64>() / counts[0] - others.iter().sum::<f64>() / counts[1];
        let explained = change * change * counts[0] * counts[1] / values.len() as f64;
        (some.len().min(others.len()) >= FEWEST).then(|| Levels {
            change: change / (1.0 + mean),
            explained: explained / whole,
        })
    }

    fn is_named(&self, limb: usize, levels: &Levels) -> bool {
        let size = levels.change.abs();
        self.is_certain(limb) && size > SENSITIVITY && size < GAINS && levels.explained > EXPLAINED
    }

    /// Sensitivities that change over the day, or that are one trial's. By the rig the standard accelerometer changes by so much.
    pub(super) fn sensitivities(&self, accelerometer_changes: Option<f64>) -> Vec<Finding> {
        let common = self.common_change();
        let mut findings: Vec<Finding> =
            Vec::from_iter(common.map(|change| of_all(change, accelerometer_changes)));
        for limb in 0..LIMBS {
            let course = self.course(limb);
            findings.extend(course.and_then(|course| of_a_course(limb, course, &self.recordings)));
            for (trial, name) in self.estimate.trials.iter().zip(&self.recordings) {
                let own = trial.sensitivity[limb];
                if course.is_none() && is_odd(own) {
                    findings.push(if is_alone(limb, &trial.sensitivity) {
                        one_channel(limb, name, 1.0 + own.value)
                    } else {
                        several_channels(limb, name, own.value)
                    });
                }
            }
        }
        findings
    }

    /// The largest sensitivity that one of several channels, or one channel in several trials, has of its own: channel from 0 and relative change.
    pub(super) fn most_odd(&self) -> Option<(usize, f64)> {
        let trials = self.estimate.trials.iter();
        let odd = trials.flat_map(|trial| (0..LIMBS).map(|limb| (limb, trial.sensitivity[limb])));
        odd.filter(|(limb, own)| is_odd(*own) && self.course(*limb).is_none())
            .map(|(limb, own)| (limb, own.value))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

fn mean_and_squares(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    (
        mean,
        values.iter().map(|value| (value - mean).powi(2)).sum(),
    )
}

fn is_alike(change: f64, other: f64) -> bool {
    (change - other).abs() < ALIKE * other.abs()
}

/// Whether a sensitivity is none that an ordinary room gives a channel.
fn is_odd(own: Known) -> bool {
    own.value.abs() > SENSITIVITY && is_significant(own)
}

/// Whether a sensitivity is not the usual one.
fn is_significant(own: Known) -> bool {
    own.value.abs() > SIGNIFICANT * own.deviation
}

/// Whether no two other channels of the trial have left their sensitivities as well, by a share of what this one has.
fn is_alone(limb: usize, sensitivity: &[Known; LIMBS]) -> bool {
    let least = BESIDE * sensitivity[limb].value.abs();
    let moved = |own: &Known| own.value.abs() > least.max(SIGNIFICANT * own.deviation);
    sensitivity.iter().filter(|own| moved(own)).count() <= 2
}

/// What most channels share over the day. Of trials held against a standard that comes to read more, all channels show less; what the rig
/// says of that standard tells which of the two it is.
fn of_all(change: f64, accelerometer_changes: Option<f64>) -> Finding {
    let evidence = format!(
        "all channels' sensitivities change alike, by {:+.2} % from the first trial to the last",
        100.0 * change
    );
    let (which, advice) = match accelerometer_changes {
        Some(by) if is_alike(-by, change) => (
            format!(
                "by the rig's stroke it is the standard accelerometer, which changes by {:+.2} %",
                100.0 * by
            ),
            "check the standard accelerometer's sensitivity at the beginning and at the end of a day, and let it come to the room's temperature",
        ),
        Some(by) if by.abs() < ALIKE * change.abs() => (
            format!(
                "as the sensor's do with its temperature: by the rig's stroke the standard accelerometer changes by {:.2} %",
                100.0 * by.abs()
            ),
            "let the sensor come to the room's temperature before the first trial, and keep the room's",
        ),
        _ => (
            "as they do where the standard accelerometer's sensitivity changes the other way, or the sensor's temperature".to_owned(),
            "check the standard accelerometer's sensitivity at the beginning and at the end of a day, and let the sensor come to the room's temperature",
        ),
    };
    Finding::new(
        Cause::FadingSensitivity,
        format!("{evidence}; {which}"),
        advice,
    )
}

/// A channel whose sensitivity changes over the day by itself.
fn of_a_course(limb: usize, course: Course, names: &[String]) -> Option<Finding> {
    let (evidence, advice) = match course {
        Course::WithTheOthers => return None,
        Course::Fading(change) => (
            format!(
                "the channel's sensitivity changes by {:+.2} % from the first trial to the last",
                100.0 * change
            ),
            "let the sensor come to the room's temperature, and look for moisture in its connector",
        ),
        Course::Step(from, change) => (
            format!(
                "the channel's sensitivity steps by {:+.2} % before {}, and stays so",
                100.0 * change,
                names.get(from).map_or("", String::as_str)
            ),
            "see what happened to the limb, its plug or its amplifier's gain there, and calibrate with the trials of one side",
        ),
        Course::Turning(change) => (
            format!(
                "the channel's sensitivity is another by {:+.2} % in the angular trials",
                100.0 * change
            ),
            "see whether limb, plug or gain was another in the angular trials, and repeat them",
        ),
    };
    Some(Finding::new(Cause::FadingSensitivity, evidence, advice).on_channels([limb]))
}

/// Several channels in one trial show other than in the others, this one most.
fn several_channels(limb: usize, name: &str, by: f64) -> Finding {
    let evidence = format!(
        "several channels show more or less than in the other trials, channel {} by {:+.2} %",
        limb + 1,
        100.0 * by
    );
    let advice = "check that this recording is this sensor's, in this state";
    Finding::new(Cause::Unexplained, evidence, advice).in_recordings([name])
}

/// One channel in one trial shows so many times what it shows in the others.
fn one_channel(limb: usize, name: &str, factor: f64) -> Finding {
    let (cause, advice) = of_one_channel(factor);
    let evidence = format!("the channel shows {factor:.4} times what it shows in the other trials");
    let finding = Finding::new(cause, evidence, advice);
    finding.in_recordings([name]).on_channels([limb])
}
