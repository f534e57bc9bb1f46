//! Gains that a trial may have been recorded with instead of the stated ones.

use sixaxis_core::LIMBS;

use super::{LEFT, Odd};
use crate::finding::{Cause, Finding};
use crate::trial::Trial;

/// Ratios of one range of an amplifier to another.
const RANGES: [f64; 9] = [1.0, 2.0, 2.5, 4.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// How near to one of them a channel's factor is.
const A_RANGE: f64 = 0.02;
/// Share of a trial's size that a channel should show to be judged by its factor.
const SHOWN: f64 = 0.05;
/// Channels from which factors that are ranges are none by chance.
const FEWEST_RANGES: usize = 6;

/// What to do about gains of other ranges.
pub(crate) const OTHER_RANGES: &str = "correct gain_n_per_v against the amplifiers' panel, or see whether the file is another trial's";

/// The ratio of ranges that a factor is; none for another factor.
fn ranges(factor: f64) -> Option<f64> {
    let all = RANGES.into_iter().flat_map(|range| [range, 1.0 / range]);
    let near = |range: &f64| (factor / range - 1.0).abs() < A_RANGE;
    all.into_iter().find(near)
}

impl Odd<'_> {
    /// The gains that the session states for another trial.
    pub(in super::super) fn gains_of_another(&self, all: &[&Trial]) -> Option<Finding> {
        let own = &self.case.trial.gains.gain_n_per_v;
        let left = |other: &&&Trial| {
            let factor = |i: usize| other.gains.gain_n_per_v[i] / own[i];
            let squares = self
                .counts
                .iter()
                .map(|i| (self.seen[*i] * factor(*i) - self.expected[*i]).powi(2));
            squares.sum::<f64>().sqrt() / self.size
        };
        let others = all.iter().filter(|other| other.gains.gain_n_per_v != *own);
        // Of a trial that is off by fifty times its size the usual share would be anything.
        let other = others
            .min_by(|a, b| left(a).total_cmp(&left(b)))
            .filter(|other| left(other) < self.enough().min(LEFT))?;
        let evidence = format!(
            "with the gains that the session states for {} the channels agree with the other trials",
            other.name
        );
        let advice = format!(
            "correct this recording's gain_n_per_v, or see whether its file and that of {} are exchanged",
            other.name
        );
        Some(self.finding(Cause::WrongScaling, evidence, advice))
    }

    /// Gains written as volts per newton.
    pub(in super::super) fn gains_inverted(&self) -> Option<Finding> {
        let own = &self.case.trial.gains.gain_n_per_v;
        let squares = self
            .counts
            .iter()
            .map(|i| (self.seen[*i] / own[*i].powi(2) - self.expected[*i]).powi(2));
        let left = squares.sum::<f64>().sqrt() / self.size;
        let evidence =
            "with one over each of its gain_n_per_v the channels agree with the other trials";
        let advice = "state this recording's gains in N/V: they are written in V/N";
        (left < self.enough().min(LEFT))
            .then(|| self.finding(Cause::WrongScaling, evidence, advice))
    }

    /// Other gains: each channel is off by a step of an amplifier's range, or not at all.
    pub(in super::super) fn gains_of_other_ranges(&self) -> Option<Finding> {
        let shown = |i: &&usize| self.expected[**i].abs() > SHOWN * self.size;
        let mut factors = [None; LIMBS];
        let mut judged = 0;
        for i in self.counts.iter().filter(shown) {
            factors[*i] = Some(ranges(self.seen[*i] / self.expected[*i])?);
            judged += 1;
        }
        let own = &self.case.trial.gains.gain_n_per_v;
        // Without what a quotient of decimal numbers leaves of rounding.
        let asked: [String; LIMBS] = core::array::from_fn(|i| {
            let rounded = |factor: f64| (1e6 * own[i] / factor).round() / 1e6;
            factors[i].map_or_else(|| "?".to_owned(), |factor| rounded(factor).to_string())
        });
        let moved = factors.iter().flatten().any(|factor| *factor != 1.0);
        (judged >= FEWEST_RANGES && moved).then(|| {
            let evidence = format!(
                "each channel is off by a step of an amplifier's range or not at all: with gains of {} N/V (?: its signal does not tell) they agree with the other trials",
                asked.join(", ")
            );
            self.finding(Cause::WrongScaling, evidence, OTHER_RANGES)
        })
    }

    /// One gain for all channels, where every other recording has a range of its own for each.
    pub(in super::super) fn gains_of_none(&self, all: &[&Trial]) -> Option<Finding> {
        let is_one = |trial: &Trial| trial.gains.gain_n_per_v.windows(2).all(|g| g[0] == g[1]);
        let own = self.case.trial;
        let alone = is_one(own) && all.iter().filter(|trial| is_one(trial)).count() == 1;
        (alone && all.len() > 1).then(|| {
            let evidence = format!(
                "by the session all nine gains are {} N/V here, and ranges differ in every other recording",
                own.gains.gain_n_per_v[0]
            );
            let advice = "state this recording's own gain_n_per_v";
            self.finding(Cause::WrongScaling, evidence, advice)
        })
    }
}
