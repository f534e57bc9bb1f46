//! Plugs that were put in otherwise from one trial on, up to one, or all day: two channels exchanged, where limb and piezo come along and the
//! amplifier stays, or one with its polarity turned, which may be in a single trial, too, as a standard's may; and two names exchanged in writing, where gains stay with the limbs. Several of these
//! one after the other put right whatever order they are in.
//!
//! Which, and from which trial on, is looked for among the channels' responses, where a pair and a trial cost less than a millisecond; the
//! joint fit then says whether the trials agree to the noise with these put right.

use core::ops::Range;
use std::borrow::Cow;

use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Gains, LIMBS, Parameters};

use super::{Unaccounted, agreeing, agreement, start};
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::joint::{at_rest, record};
use crate::response::ChannelResponse;
use crate::trial::Trial;

/// Share of the squared departures that an exchange may leave to be worth a fit.
const WORTH_A_FIT: f64 = 0.5;
/// Share of them that one more exchange may leave to be a part of the matter: a row of names that is out by one is eight exchanges.
const ONE_MORE: f64 = 0.9;
/// Relative difference of two costs that is rounding.
const SAME_COST: f64 = 1e-6;
/// First ones from which more are looked for.
const STARTS: usize = 3;

/// What was done to plugs, or to names. Each is put right by doing it again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Plugs {
    Exchanged(usize, usize),
    /// In writing only: what stands in one channel came through the other's amplifier.
    Misnamed(usize, usize),
    Inverted(usize),
    /// A standard's, which is the same as a direction that is stated the other way round.
    OfTheStandard,
}

/// Two limbs.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..LIMBS).flat_map(|a| (a + 1..LIMBS).map(move |b| (a, b)))
}

impl Plugs {
    /// All that can be done to one, two or a standard. Of equal ranges names and plugs are the same.
    fn all(cases: &[TrialCase<'_>]) -> impl Iterator<Item = Self> {
        let of_equal_ranges = |(a, b): (usize, usize)| {
            let mut gains = cases.iter().map(|case| &case.trial.gains.gain_n_per_v);
            gains.all(|gain| gain[a] == gain[b])
        };
        let exchanged = pairs().map(|(a, b)| Self::Exchanged(a, b));
        let misnamed = pairs().filter(move |pair| !of_equal_ranges(*pair));
        exchanged
            .chain(misnamed.map(|(a, b)| Self::Misnamed(a, b)))
            .chain((0..LIMBS).map(Self::Inverted))
            .chain([Self::OfTheStandard])
    }

    /// Voltages.
    fn put_right(self, channels_v: &mut [f64; LIMBS]) {
        match self {
            Self::Exchanged(a, b) | Self::Misnamed(a, b) => channels_v.swap(a, b),
            Self::Inverted(a) => channels_v[a] = -channels_v[a],
            Self::OfTheStandard => {}
        }
    }

    /// Responses, which are forces by the gains that are written.
    fn responses_put_right(self, channels: &mut [ChannelResponse; LIMBS], gains: &Gains) {
        match self {
            Self::Exchanged(a, b) => channels.swap(a, b),
            Self::Misnamed(a, b) => {
                let over = gains.gain_n_per_v[a] / gains.gain_n_per_v[b];
                (channels[a], channels[b]) = (channels[b] * over, channels[a] * (1.0 / over));
            }
            Self::Inverted(a) => channels[a] = channels[a] * -1.0,
            // What the channels show of a standard the other way round.
            Self::OfTheStandard => channels.iter_mut().for_each(|c| *c = *c * -1.0),
        }
    }

    /// The trial with each limb's signal in its own channel, and with the gain of the amplifier that it went through.
    fn trial_put_right(self, trial: &Trial) -> Trial {
        let mut right = trial.clone();
        right
            .voltage_v
            .iter_mut()
            .for_each(|row| self.put_right(row));
        if let Self::Exchanged(a, b) = self {
            right.gains.gain_n_per_v.swap(a, b);
        }
        if self == Self::OfTheStandard {
            let series = [&mut right.accelerometer_m_s2, &mut right.gyroscope_rad_s];
            for x in series.into_iter().flatten() {
                *x = -*x;
            }
        }
        right
    }

    /// Cause, channels from 1, what makes the trials agree, what to do.
    fn in_words(self) -> (Cause, Vec<usize>, String, String) {
        match self {
            Self::Exchanged(a, b) => {
                let (a, b) = (a + 1, b + 1);
                (
                    Cause::SwappedChannels,
                    vec![a, b],
                    format!("channels {a} and {b} exchanged"),
                    format!(
                        "exchange channels {a} and {b} in the [channels] of the session or of these recordings, and with them entries {a} and {b} of \
                         each gain_n_per_v, since a range stays with its amplifier; or exchange the plugs and record again"
                    ),
                )
            }
            Self::Misnamed(a, b) => {
                let (a, b) = (a + 1, b + 1);
                (
                    Cause::SwappedChannels,
                    vec![a, b],
                    format!(
                        "the names of channels {a} and {b} exchanged and the gains left as they are"
                    ),
                    format!(
                        "exchange names {a} and {b} in the [channels] of the session or of these recordings, and leave gain_n_per_v as it is: its \
                         entries are the limbs' already"
                    ),
                )
            }
            Self::Inverted(a) => (
                Cause::InvertedChannel,
                vec![a + 1],
                format!("channel {} inverted", a + 1),
                format!("turn channel {} in these recordings, or its plug", a + 1),
            ),
            Self::OfTheStandard => (
                Cause::WrongScaling,
                Vec::new(),
                "the standard of this trial reversed".to_owned(),
                "turn the sign of this recording's direction in the session, or see to the polarity of the standard"
                    .to_owned(),
            ),
        }
    }
}

/// That, one after the other, in the trials from one on or up to one. Several are exchanges of one kind, all day.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Replugged {
    plugs: Vec<Plugs>,
    trials: Range<usize>,
}

impl Replugged {
    fn trial_put_right(&self, trial: &Trial) -> Trial {
        let put_right = |trial: Trial, plugs: &Plugs| plugs.trial_put_right(&trial);
        self.plugs.iter().fold(trial.clone(), put_right)
    }

    /// Cause, channels from 1, what makes the trials agree, what to do.
    fn in_words(&self) -> (Cause, Vec<usize>, String, String) {
        if let [one] = self.plugs[..] {
            return one.in_words();
        }
        // Channels, from 1, in which the limbs' signals stand.
        let mut order: [usize; LIMBS] = core::array::from_fn(|limb| limb + 1);
        for plugs in &self.plugs {
            if let Plugs::Exchanged(a, b) | Plugs::Misnamed(a, b) = *plugs {
                order.swap(a, b);
            }
        }
        let moved = (1..=LIMBS).filter(|channel| order[channel - 1] != *channel);
        let list = order.map(|channel| channel.to_string()).join(", ");
        let (with, advice) = if matches!(self.plugs.first(), Some(Plugs::Exchanged(..))) {
            (
                "each with its gain",
                "and those of each gain_n_per_v with them, since a range stays with its amplifier; or put the plugs right and record again",
            )
        } else {
            (
                "and gains left as they are",
                "and leave gain_n_per_v as it is: its entries are the limbs' already",
            )
        };
        (
            Cause::SwappedChannels,
            moved.collect(),
            format!("channels {list} taken for limbs 1 to 9, {with},"),
            format!("put the present entries of [channels] limbs into the order {list}, {advice}"),
        )
    }
}

/// The exchange that accounts for all trials, or several that do.
pub fn tried(day: &Unaccounted<'_>) -> Option<Finding> {
    let shares = StaticLoadSharing::new(&day.campaign.geometry).ok()?;
    // What was found of trials before was found with channels taken for each other.
    let cases: Vec<TrialCase<'_>> = day
        .cases
        .iter()
        .map(|case| TrialCase {
            ignored: [false; LIMBS],
            explained: false,
            ..case.clone()
        })
        .collect();
    let (as_they_are, _) = agreement(&shares, &cases)?;
    let worth_a_fit = |found: &Agreeing| found.cost < WORTH_A_FIT * as_they_are;
    let accounting = |found: Agreeing| accounts(day, &found);
    one(&shares, &cases, &day.campaign.design)
        .filter(worth_a_fit)
        .and_then(accounting)
        .or_else(|| {
            several(&shares, &cases, &day.campaign.design)
                .filter(worth_a_fit)
                .and_then(accounting)
        })
}

/// Whether the trials agree to the noise with that put right.
fn accounts(day: &Unaccounted<'_>, found: &Agreeing) -> Option<Finding> {
    let Agreeing { found, table, .. } = found;
    let trials: Vec<Cow<'_, Trial>> = day
        .campaign
        .trials
        .iter()
        .enumerate()
        .map(|(index, (trial, _))| {
            if found.trials.contains(&index) {
                Cow::Owned(found.trial_put_right(trial))
            } else {
                Cow::Borrowed(trial)
            }
        })
        .collect();
    let fitted = |trial: &&Cow<'_, Trial>| record(trial).is_some();
    let (before, after) = (&trials[..found.trials.start], &trials[found.trials.end..]);
    let all_day = !before.iter().chain(after).any(|trial| fitted(&trial));
    let mut rest = at_rest(day.drift);
    if all_day {
        for plugs in &found.plugs {
            plugs.put_right(&mut rest.drift_v);
            plugs.put_right(&mut rest.deviation_v);
        }
        rest.deviation_v = rest.deviation_v.map(f64::abs);
    }
    let start = start(table, &rest, &day.campaign.design);
    let borrowed: Vec<&Trial> = trials.iter().map(AsRef::as_ref).collect();
    let joint = day.accounting(&borrowed, &rest, &start, day.knowledge)?;
    let names = trials[found.trials.clone()].iter();
    let names = names.map(|trial| trial.name.clone());
    let (cause, channels, with, advice) = found.in_words();
    Some(Finding {
        cause,
        recordings: if all_day { Vec::new() } else { names.collect() },
        channels,
        evidence: agreeing(&with, &joint),
        advice,
    })
}

/// What was done, how far trials are from agreeing with that put right, and the scale factors and inertias they then have.
#[derive(Debug, Clone)]
struct Agreeing {
    found: Replugged,
    cost: f64,
    table: Table,
}

impl Agreeing {
    /// By what it costs. Plugs and names that were exchanged all day cost the same, and gains of the wrong amplifier are what tells them
    /// apart: scale factors are then far from the design's.
    fn agrees_better(&self, than: &Self, design: &Parameters) -> bool {
        if (self.cost - than.cost).abs() > SAME_COST * self.cost.max(than.cost) {
            return self.cost < than.cost;
        }
        let from_design = |of: &Self| -> f64 {
            let scale = design.scale_per_mass_per_kg.iter();
            let factors = of.table.mass_over_scale_kg.iter().zip(scale);
            factors.map(|(h, scale)| (h * scale).abs().ln().abs()).sum()
        };
        from_design(self) < from_design(than)
    }
}

/// The one thing with which the trials' responses agree best.
fn one(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    design: &Parameters,
) -> Option<Agreeing> {
    let mut best: Option<Agreeing> = None;
    for plugs in Plugs::all(cases) {
        let mut look = |trials: Range<usize>, cases: &[TrialCase<'_>]| {
            let Some((cost, table)) = agreement(shares, cases) else {
                return;
            };
            // Inverted in some trials and in all others fit alike: a scale factor has its design's sign.
            let has_its_sign = match plugs {
                Plugs::Inverted(a) => {
                    table.mass_over_scale_kg[a] * design.scale_per_mass_per_kg[a] > 0.0
                }
                _ => true,
            };
            let plugs = vec![plugs];
            let found = Replugged { plugs, trials };
            let this = Agreeing { found, cost, table };
            if has_its_sign
                && best
                    .as_ref()
                    .is_none_or(|best| this.agrees_better(best, design))
            {
                best = Some(this);
            }
        };
        if plugs != Plugs::OfTheStandard {
            each_end(cases, plugs, &mut look);
        }
        if matches!(plugs, Plugs::Inverted(_) | Plugs::OfTheStandard) {
            each_alone(cases, plugs, &mut look);
        }
    }
    best
}

/// The exchanges of one kind, one after the other and all day, with which they agree best.
fn several(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    design: &Parameters,
) -> Option<Agreeing> {
    let of_a_kind = |kind: fn(usize, usize) -> Plugs| {
        let mut firsts: Vec<Agreeing> = pairs()
            .filter_map(|(a, b)| with_one_more(shares, cases, &[], kind(a, b)))
            .collect();
        firsts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        firsts.truncate(STARTS);
        firsts.into_iter().map(move |mut best| {
            while best.found.plugs.len() < LIMBS - 1 {
                let next = pairs()
                    .filter_map(|(a, b)| {
                        with_one_more(shares, cases, &best.found.plugs, kind(a, b))
                    })
                    .min_by(|a, b| a.cost.total_cmp(&b.cost))
                    .filter(|next| next.cost < ONE_MORE * best.cost);
                match next {
                    Some(next) => best = next,
                    None => break,
                }
            }
            best
        })
    };
    of_a_kind(Plugs::Exchanged)
        .chain(of_a_kind(Plugs::Misnamed))
        .reduce(|best, other| match other.agrees_better(&best, design) {
            true => other,
            false => best,
        })
}

fn with_one_more(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    before: &[Plugs],
    more: Plugs,
) -> Option<Agreeing> {
    let plugs = [before, &[more]].concat();
    let mut cases = cases.to_vec();
    for plugs in &plugs {
        put_right(&mut cases, *plugs);
    }
    let (cost, table) = agreement(shares, &cases)?;
    let trials = 0..cases.len();
    let found = Replugged { plugs, trials };
    Some(Agreeing { found, cost, table })
}

/// Shows the cases put right in the last one, in the last two ... in all of them, and in the first one, in the first two ...
fn each_end(
    cases: &[TrialCase<'_>],
    plugs: Plugs,
    mut show: impl FnMut(Range<usize>, &[TrialCase<'_>]),
) {
    let count = cases.len();
    let mut right = cases.to_vec();
    for from in (0..count).rev() {
        put_right(&mut right[from..=from], plugs);
        show(from..count, &right);
    }
    right.clone_from_slice(cases);
    for last in 0..count.saturating_sub(1) {
        put_right(&mut right[last..=last], plugs);
        show(0..last + 1, &right);
    }
}

/// Shows the cases with a single one put right: a channel that shows little of a motion is not suspected of anything there.
fn each_alone(
    cases: &[TrialCase<'_>],
    plugs: Plugs,
    mut show: impl FnMut(Range<usize>, &[TrialCase<'_>]),
) {
    let mut right = cases.to_vec();
    for at in 0..cases.len() {
        put_right(&mut right[at..=at], plugs);
        show(at..at + 1, &right);
        right[at].clone_from(&cases[at]);
    }
}

fn put_right(cases: &mut [TrialCase<'_>], plugs: Plugs) {
    for case in cases {
        if let Some(response) = &mut case.response {
            plugs.responses_put_right(&mut response.channels, &case.trial.gains);
        }
    }
}
