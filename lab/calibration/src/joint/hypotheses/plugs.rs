//! Plugs that were put in otherwise from one trial on, up to one, or all day: two channels exchanged, where limb and piezo come along and the
//! amplifier stays, or one with its polarity turned, which may be in a single trial, too, as a standard's may; and two names exchanged in writing, where gains stay with the limbs. Several of these
//! one after the other put right whatever order they are in.
//!
//! Which, and from which trial on, is looked for among the channels' responses, where a pair and a trial cost less than a millisecond; the
//! joint fit then says whether the trials agree to the noise with these put right.

mod replugged;

use core::ops::Range;
use std::borrow::Cow;

use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{LIMBS, Parameters};

use self::replugged::{Plugs, Replugged, pairs};
use super::{Unaccounted, agreeing, agreement, start};
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::Finding;
use crate::joint::{at_rest, record};
use crate::trial::Trial;

/// Share of the squared departures that an exchange may leave to be worth a fit.
const WORTH_A_FIT: f64 = 0.5;
/// Share of them that one more exchange may leave to be a part of the matter: a row of names that is out by one is eight exchanges.
const ONE_MORE: f64 = 0.9;
/// Relative difference of two costs that is rounding.
const SAME_COST: f64 = 1e-6;
/// First ones from which more are looked for.
const STARTS: usize = 3;

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
