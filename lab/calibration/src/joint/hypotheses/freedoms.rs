//! One freedom more: something that the session does not state and that all recordings may have, or that it states and they have not,
//! with an unknown of its own.

mod standards;

use core::f64::consts::TAU;

use rayon::prelude::*;
use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::unknowns::AMPLIFIER_CORNER;
use sixaxis_core::identify::joint::{Certificates, Known};

use super::Unaccounted;
use crate::finding::{Cause, Finding};
use crate::joint::{JointReport, Knowledge, at_rest};
use crate::trial::Trial;

/// Corner of an amplifier that nobody stated, or that is not the stated one, Hz: where it is looked for first, and how far about.
const CORNER_HZ: (f64, f64) = (0.05, 1.0);
/// Delay of a channel that nobody stated, s: how far about none it is looked for.
const DELAY_S: f64 = 0.02;

/// Standard deviations of its unknown from which a freedom is needed: one that is not takes up what is left of anything, but little.
const BEYOND_DOUBT: f64 = 30.0;
/// Share of a signal that a delay puts into quadrature at the fastest drive, or a high-pass at the slowest, from which it is
/// worth a word. Converters that take their channels in turn do less.
pub(super) const WORTH_A_WORD: f64 = 1e-3;

/// Frees what the session says of standards and channels, if it leaves room for that.
type Freed = fn(&Unaccounted<'_>, &mut Certificates) -> Option<()>;
/// What is said of it; none if its unknown is not told beyond doubt.
type Told = fn(&Fitted<'_>) -> Option<Finding>;

/// A fit with a freedom more.
struct Fitted<'a> {
    joint: &'a JointReport,
    /// What the session says.
    stated: &'a Knowledge,
    /// What is taken instead.
    taken: &'a Knowledge,
    /// Of the drives.
    slowest_rad_s: f64,
    fastest_rad_s: f64,
}

const FREEDOMS: [(Freed, Told); 10] = [
    (high_pass, amplifier),
    (no_high_pass, no_amplifier),
    (standards::lag, standards::gyroscope),
    (standards::gyroscope_delay, standards::delayed_gyroscope),
    (
        standards::gyroscope_delay_alone,
        standards::delayed_gyroscope,
    ),
    (standards::no_accelerometer_lag, standards::accelerometer),
    (standards::accelerometer_lag, standards::late_accelerometer),
    (
        standards::accelerometer_delay,
        standards::delayed_accelerometer,
    ),
    (
        standards::accelerometer_delay_alone,
        standards::delayed_accelerometer,
    ),
    (delays, late_channels),
];

/// The fits of a day with each freedom for which the session leaves room, and what is taken instead of what it says.
pub(super) struct Fits(Vec<(Told, Knowledge, JointReport)>);

impl Fits {
    pub(super) fn of(day: &Unaccounted<'_>) -> Self {
        let trials: Vec<&Trial> = day.campaign.trials.iter().map(|(trial, _)| trial).collect();
        let rest = at_rest(day.drift);
        let of = |(free, told): &(Freed, Told)| {
            let mut freed = *day.knowledge;
            free(day, &mut freed.certificates)?;
            let joint = day.fit(&trials, &rest, &day.start, &freed)?;
            Some((*told, freed, joint))
        };
        Self(FREEDOMS.par_iter().filter_map(of).collect())
    }

    /// The freedoms that account for all trials.
    pub(super) fn accounting(&self, day: &Unaccounted<'_>) -> Vec<Finding> {
        self.that(day, JointReport::accounts)
    }

    /// Those that leave next to nothing of what the trials contradict each other by, but more than white noise.
    pub(super) fn but_for_coloured_noise(&self, day: &Unaccounted<'_>) -> Vec<Finding> {
        // Where no fit was possible the trials contradict each other by more than any that is.
        let mut found = self.that(day, |joint| match day.joint {
            Ok(before) => joint.leaves_little_of(&before.misfit),
            Err(_) => joint.nearly_accounts(),
        });
        for finding in &mut found {
            finding.evidence = finding.evidence.replace(
                "all trials agree to the noise",
                "all trials agree but for noise that is not white",
            );
        }
        found
    }

    fn that(&self, day: &Unaccounted<'_>, will_do: impl Fn(&JointReport) -> bool) -> Vec<Finding> {
        let trials = || day.campaign.trials.iter().map(|(trial, _)| trial);
        let drives = || trials().map(|trial| TAU * trial.frequency_hz);
        let fits = self.0.iter().filter(|(_, _, joint)| will_do(joint));
        fits.filter_map(|(told, taken, joint)| {
            told(&Fitted {
                joint,
                stated: day.knowledge,
                taken,
                slowest_rad_s: drives().fold(f64::INFINITY, f64::min),
                fastest_rad_s: drives().fold(0.0, f64::max),
            })
        })
        .collect()
    }
}

/// An unknown with its standard deviation.
fn known(joint: &JointReport, at: usize) -> Known {
    Known {
        value: joint.estimate.unknowns.values[at],
        deviation: joint.estimate.covariance[(at, at)].sqrt(),
    }
}

/// An unknown that is beyond doubt, if it is positive.
fn told(joint: &JointReport, at: usize) -> Option<f64> {
    let found = known(joint, at);
    (found.value > BEYOND_DOUBT * found.deviation).then_some(found.value)
}

fn about((value, deviation): (f64, f64)) -> Known {
    Known { value, deviation }
}

fn high_pass(_: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    let anywhere = about((TAU * CORNER_HZ.0, TAU * CORNER_HZ.1));
    let stated = free.amplifier_corner_rad_s.replace(anywhere);
    stated.is_none().then_some(())
}

/// A corner too low for its lead to show lends each channel a straight line of its own, which other things have as well.
fn amplifier(fit: &Fitted<'_>) -> Option<Finding> {
    let corner_rad_s = told(fit.joint, AMPLIFIER_CORNER)?;
    if corner_rad_s <= WORTH_A_WORD * fit.slowest_rad_s {
        return None;
    }
    Some(Finding::new(
        Cause::HighPassMisstated,
        format!(
            "with a high-pass of {:.4} Hz on every channel all trials agree to the noise, and without one they do not",
            corner_rad_s / TAU
        ),
        "state preprocessing.amplifier_high_pass_hz as the amplifier's manual has it",
    ))
}

fn no_high_pass(_: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    free.amplifier_corner_rad_s.take().map(|_| ())
}

fn no_amplifier(fit: &Fitted<'_>) -> Option<Finding> {
    let corner_hz = fit.stated.certificates.amplifier_corner_rad_s?.value / TAU;
    Some(Finding::new(
        Cause::HighPassMisstated,
        format!(
            "without the stated high-pass of {corner_hz} Hz all trials agree to the noise, and with it they do not"
        ),
        "take preprocessing.amplifier_high_pass_hz out of the session, if the amplifiers have none",
    ))
}

fn delays(_: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    free.channel_delay_s = DELAY_S;
    Some(())
}

/// Channels that are behind the standards or ahead of them. One clock for all nine is the standards' to be late.
fn late_channels(fit: &Fitted<'_>) -> Option<Finding> {
    let joint = fit.joint;
    let mut late: Vec<(usize, f64)> = Vec::new();
    for limb in 0..LIMBS {
        let delay = known(joint, joint.estimate.unknowns.delay(limb)?);
        if delay.value.abs() > BEYOND_DOUBT * delay.deviation {
            late.push((limb, delay.value));
        }
    }
    if !late
        .iter()
        .any(|(_, delay)| delay.abs() * fit.fastest_rad_s > WORTH_A_WORD)
    {
        return None;
    }
    let times = late.iter().map(|(_, delay)| 1e3 * delay);
    let (least, most) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), t| {
        (least.min(t), most.max(t))
    });
    let who = match late.len() {
        LIMBS => "all nine channels are",
        1 => "this channel is, beyond doubt,",
        _ => "these channels are, beyond doubt,",
    };
    let by = match late.len() {
        1 => format!("{most:.3}"),
        _ => format!("{least:.3} to {most:.3}"),
    };
    let evidence = format!(
        "with delays all trials agree to the noise, and without they do not: {who} {by} ms behind the standards"
    );
    let advice = "record all channels and the standards on one clock, started at once, or state the delays that there are: [channels] limbs_lag_us of the \
         channels, reference_start_s of standards in a file of their own";
    let finding = Finding::new(Cause::ClockMismatch, evidence, advice);
    Some(match late.len() {
        LIMBS => finding,
        _ => finding.on_channels(late.iter().map(|(limb, _)| *limb)),
    })
}
