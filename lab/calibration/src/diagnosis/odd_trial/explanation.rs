//! What a trial that departs from the others is tried against: a factor, a channel, an exchange, another direction; other gains are in
//! [`gains`].

mod gains;

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};
use sixaxis_core::LIMBS;

pub(crate) use gains::OTHER_RANGES;

use super::NOTICED;
use crate::diagnosis::level::{
    cause_of, factor_in_words, of_one_channel, reason, reason_of_a_rate,
};
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::response::Response;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// How near to -1 a factor on all channels is of a motion the other way.
const OPPOSITE: f64 = 0.1;
/// Times what a standard reads from which it reads nothing: beyond any unit and any sensitivity.
const NOTHING: f64 = 1e4;
/// Share of what one explanation leaves that another one leaves where it is the better of two.
const CLEARLY: f64 = 0.5;
/// Share of the departure that may be left once a cause is taken into account.
const LEFT: f64 = 0.1;
/// Angle from which a wedge is called loose, degrees; what is below is its workshop's tolerance.
const LOOSE_DEG: f64 = 0.7;
/// Factor within which a direction that the channels show is a unit vector's: a wedge does not scale.
const LENGTH: f64 = 1.25;

/// A trial that departs from the others, and what it is tried against.
pub(super) struct Odd<'a> {
    table: &'a Table,
    case: &'a TrialCase<'a>,
    response: &'a Response,
    departure: f64,
    seen: [f64; LIMBS],
    expected: [f64; LIMBS],
    /// Channels that count.
    counts: Vec<usize>,
    size: f64,
}

/// Whether the trial moved in a direction other than the stated one.
pub(super) enum OtherDirection {
    /// Another direction explains nothing.
    None,
    /// It explains the departure and lies within a wedge's play: not reported.
    WithinPlay,
    /// It explains it and is another wedge's.
    Loose(Finding),
}

impl<'a> Odd<'a> {
    pub(super) fn new(
        table: &'a Table,
        case: &'a TrialCase<'a>,
        response: &'a Response,
        departure: f64,
    ) -> Self {
        let (seen, expected) = table.compare(case, response);
        Self {
            table,
            case,
            response,
            departure,
            seen,
            expected,
            counts: (0..LIMBS)
                .filter(|i| !case.ignored[*i] && !table.silent[*i])
                .collect(),
            size: table.size(case, response, &expected),
        }
    }

    /// A finding of this trial alone.
    fn finding(
        &self,
        cause: Cause,
        evidence: impl Into<String>,
        advice: impl Into<String>,
    ) -> Finding {
        Finding::new(cause, evidence, advice).in_trial(self.case.trial)
    }

    /// What a hypothesis leaves of the departure, over the trial's size.
    fn rest(&self, of: &dyn Fn(usize) -> f64) -> f64 {
        self.counts
            .iter()
            .map(|i| (self.seen[*i] - of(*i)).powi(2))
            .sum::<f64>()
            .sqrt()
            / self.size
    }

    /// What a hypothesis may leave to be taken for the explanation.
    fn enough(&self) -> f64 {
        (LEFT * self.departure).max(0.5 * NOTICED)
    }

    /// How much of `own` explains what `other` does not, by least squares, and what both leave.
    fn amount(&self, own: &[f64; LIMBS], other: &[f64; LIMBS]) -> (f64, f64) {
        let sum = |of: &dyn Fn(usize) -> f64| self.counts.iter().map(|i| of(*i)).sum::<f64>();
        let amount = sum(&|i| (self.seen[i] - other[i]) * own[i]) / sum(&|i| own[i] * own[i]);
        (amount, self.rest(&|i| amount * own[i] + other[i]))
    }

    /// One factor on all channels.
    pub(super) fn one_factor(&self) -> Option<Finding> {
        let (common, left) = self.amount(&self.expected, &[0.0; LIMBS]);
        let evidence =
            format!("all channels are {common:.4} times what the other trials make one expect");
        let advice = if (common + 1.0).abs() < OPPOSITE {
            "turn the sign of this recording's direction in the session, or see to the polarity of the standard"
        } else {
            "check this recording's gains and units, and the sensitivity of the standard"
        };
        (left < self.enough()).then(|| self.finding(cause_of(common), evidence, advice))
    }

    /// One standard's factor, where a run travels and turns: the channels have their shares of what the other standard reads, and of this
    /// one's motion another amount.
    pub(super) fn one_standard(&self) -> Option<Finding> {
        if self.case.trial.role != Role::Validation {
            return None;
        }
        let share = |linear: f64, angular: f64| -> [f64; LIMBS] {
            let of = Response {
                linear_over_waveform: linear,
                angular_over_waveform: angular,
                ..self.response.clone()
            };
            self.table.compare(self.case, &of).1
        };
        let read = (
            self.response.linear_over_waveform,
            self.response.angular_over_waveform,
        );
        // Where hardly anything but one of both moves the channels, its factor is next to one on all of them.
        let (_, by_one_factor) = self.amount(&self.expected, &[0.0; LIMBS]);
        let limit = self.enough().min(CLEARLY * by_one_factor);
        let amount = |own: [f64; LIMBS], other: [f64; LIMBS]| {
            let (amount, left) = self.amount(&own, &other);
            (left < limit).then_some(amount)
        };
        let (standard, factor, why) = amount(share(1.0, 0.0), share(0.0, read.1))
            .map(|amount| amount / read.0)
            .map(|factor| ("accelerometer", factor, reason(factor)))
            .or_else(|| {
                let factor = amount(share(0.0, 1.0), share(read.0, 0.0))? / read.1;
                Some(("gyroscope", factor, reason_of_a_rate(factor)))
            })?;
        let (cause, evidence) = if factor.abs() > NOTHING {
            (
                Cause::Unreadable,
                format!(
                    "the standard {standard} reads nothing of the motion that the channels show"
                ),
            )
        } else if (factor + 1.0).abs() < OPPOSITE {
            (
                Cause::InvertedChannel,
                format!(
                    "the standard {standard} reads the other way round than in the other trials"
                ),
            )
        } else {
            (
                cause_of(factor),
                format!(
                    "by the channels the true motion is {} what the standard {standard} reads; {why}",
                    factor_in_words(factor)
                ),
            )
        };
        let advice = format!(
            "check unit, sensitivity, polarity and cable of the standard {standard} in this recording"
        );
        Some(self.finding(cause, evidence, advice))
    }

    /// One channel.
    pub(super) fn one_channel(&self) -> Option<Finding> {
        let (seen, expected) = (&self.seen, &self.expected);
        let off = |i: usize| (seen[i] - expected[i]).abs();
        let worst = self
            .counts
            .iter()
            .copied()
            .max_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap_or(0);
        let left = self.rest(&|i| if i == worst { seen[i] } else { expected[i] });
        if left >= self.enough() || left.is_nan() {
            return None;
        }
        let factor = seen[worst] / expected[worst];
        let (cause, advice) = of_one_channel(factor);
        let evidence = format!(
            "the channel shows {factor:.4} times what the other trials make one expect, the others agree"
        );
        Some(self.finding(cause, evidence, advice).on_channels([worst]))
    }

    /// Two channels exchanged in this recording alone: the gain stays with the amplifier and the limb comes along, or two columns have
    /// each other's names, and the gains are the limbs' already.
    pub(super) fn exchanged(&self) -> Option<Finding> {
        let h = &self.table.mass_over_scale_kg;
        let gain = &self.case.trial.gains.gain_n_per_v;
        let plugs = |own: usize, from: usize| h[from] / h[own];
        let names = |own: usize, from: usize| h[from] * gain[own] / (h[own] * gain[from]);
        let of_plugs = self.exchanged_by(plugs).map(|pair| {
            (
                pair,
                "exchanged in this recording, the two agree with the other trials",
                "check the plugs, or give this recording its own [recording.channels]",
            )
        });
        let of_names = || {
            self.exchanged_by(names).map(|pair| {
                (
                    pair,
                    "with their names exchanged in this recording, and gains left as they are, the two agree with the other trials",
                    "give this recording its own [recording.channels]",
                )
            })
        };
        let ((a, b), evidence, advice) = of_plugs.or_else(of_names)?;
        let finding = self.finding(Cause::SwappedChannels, evidence, advice);
        Some(finding.on_channels([a, b]))
    }

    /// All nine names moved on by some places, as by a heading that begins a column too early.
    pub(super) fn moved_on(&self) -> Option<Finding> {
        let h = &self.table.mass_over_scale_kg;
        let gain = &self.case.trial.gains.gain_n_per_v;
        let by = (1..LIMBS).find(|by| {
            let with = |own: usize| {
                let from = (own + by) % LIMBS;
                self.expected[from] * h[from] * gain[own] / (h[own] * gain[from])
            };
            self.rest(&with) < self.enough()
        })?;
        let evidence = format!(
            "what stands in channel 1 of this recording is limb {}'s, and so on: with all nine names moved on they agree with the other trials",
            by + 1
        );
        let advice = "see whether the headings of this file begin a column too early or too late, or give it its own [recording.channels]";
        Some(self.finding(Cause::SwappedChannels, evidence, advice))
    }

    /// The pair whose exchange explains the trial, where a channel then shows so many times what is expected of the other.
    fn exchanged_by(&self, factor: impl Fn(usize, usize) -> f64) -> Option<(usize, usize)> {
        let other = |own: usize, from: usize| self.expected[from] * factor(own, from);
        let explains = |(a, b): &(usize, usize)| {
            let with = |i: usize| match i {
                i if i == *a => other(*a, *b),
                i if i == *b => other(*b, *a),
                i => self.expected[i],
            };
            self.rest(&with) < self.enough()
        };
        let from = |n: usize, a: usize| self.counts[n + 1..].iter().map(move |b| (a, *b));
        let mut pairs = (self.counts.iter().enumerate()).flat_map(|(n, a)| from(n, *a));
        pairs.find(explains)
    }

    /// Another direction.
    pub(super) fn other_direction(&self, all: &[&Trial]) -> OtherDirection {
        let found = direction(
            self.table,
            self.response,
            &self.counts,
            &self.seen,
            self.size,
        );
        let Some((direction, left)) = found else {
            return OtherDirection::None;
        };
        let one = 1.0 / LENGTH..=LENGTH;
        if left >= self.enough() || left.is_nan() || !one.contains(&direction.length()) {
            return OtherDirection::None;
        }
        let v = direction.normalize();
        let angle = v
            .angle_between(self.case.trial.direction_ground)
            .to_degrees();
        if angle <= LOOSE_DEG {
            return OtherDirection::WithinPlay;
        }
        let near = |other: &&&Trial| {
            other.role == self.case.trial.role
                && v.angle_between(other.direction_ground).to_degrees() < LOOSE_DEG
        };
        let advice = match all.iter().find(near) {
            Some(other) => format!(
                "see whether its direction or its file is that of {}: that one is stated to move so",
                other.name
            ),
            None => "tighten the wedge and repeat, or check the stated direction".to_owned(),
        };
        let evidence = format!(
            "the channels show motion along ({:.3}, {:.3}, {:.3}), {angle:.1}° from the stated direction",
            v.x, v.y, v.z
        );
        OtherDirection::Loose(self.finding(Cause::LooseWedge, evidence, advice))
    }

    /// Another sensor's where many channels depart; otherwise unexplained.
    pub(super) fn nothing_else(&self) -> Finding {
        let departs =
            |i: &&usize| (self.seen[**i] - self.expected[**i]).abs() > 0.5 * NOTICED * self.size;
        let percent = 100.0 * self.departure;
        let (cause, evidence, advice) = if self.counts.iter().filter(departs).count() >= 3 {
            (
                Cause::ForeignTrial,
                format!(
                    "the channels depart by {percent:.1} % from what the other trials agree on, and neither a factor, an exchange nor another direction explains it"
                ),
                "check that this recording is this sensor's, in this state, and one run's alone",
            )
        } else {
            (
                Cause::Unexplained,
                format!("departs by {percent:.1} % from what the other trials agree on"),
                "look at the trial's curves in the report, and repeat it",
            )
        };
        self.finding(cause, evidence, advice)
    }
}

/// The direction, not normalised, that the channels show, and what it leaves.
fn direction(
    table: &Table,
    response: &Response,
    counts: &[usize],
    seen: &[f64; LIMBS],
    size: f64,
) -> Option<(DVec3, f64)> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &i in counts {
        let share = Vector3::from(table.share(i, response).to_array());
        normal += share * share.transpose();
        right += share * seen[i];
    }
    let d = normal.try_inverse()? * right;
    let d = DVec3::new(d[0], d[1], d[2]);
    let left = counts
        .iter()
        .map(|&i| (seen[i] - table.share(i, response).dot(d)).powi(2))
        .sum::<f64>()
        .sqrt();
    Some((d, left / size))
}
