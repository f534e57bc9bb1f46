//! One channel or two show more or less in all trials of one kind than in the others: a limb that was knocked before them and mended after, an
//! amplifier's range, a plug.
//!
//! A fit can take that for cross-talk: what a channel shows of all others adds to linear loads and takes from torques, or the other
//! way round. It accounts for such a day, with parameters that are off, so that the trials are fitted once more with the channels put right
//! in that kind of trial: it is believed where that leaves a fraction of the cross-talk of channels apart, of which a cable has little, or, of a day that was not accounted for, nothing
//! but noise and little of it. A laboratory whose channels apart have more of it by themselves (none was tried) is not told so.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::unknowns::Unknowns;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;

use super::{Unaccounted, agreement};
use crate::diagnosis::table::{Table, usable, weighted_median};
use crate::diagnosis::trial_case::{TrialCase, names};
use crate::finding::{Cause, Finding};
use crate::joint::JointReport;
use sixaxis_recordings::session::Role;

/// Departure of a channel's median response from what the others make one expect that is worth a look, relative.
const WORTH_A_LOOK: f64 = 4e-3;
/// Change that is named, relative, and one that is a gain's and no sensor's.
const NOTICED: f64 = 7e-3;
const GAINS: f64 = 0.2;
/// Trials of a kind.
const FEWEST: usize = 3;
/// Channels that are others: of nine six are the inertias' to explain.
const MOST: usize = 2;
/// Cross-talk of channels apart that hides one: beyond this, and so many times what is left where the channel is put right.
const CROSS_TALK: f64 = 1e-4;
const TIMES: f64 = 2.0;
/// Cross-talk of channels apart that is left at most where a day is accounted for with a channel put right and not as it is.
const ORDINARY: f64 = 5e-4;
/// Cross-talk of channels apart that a change of a channel hides in, over that change, at least: of channels that showed 1 and 2 % less six
/// thousandths and more were seen.
const HIDES: f64 = 0.005;
/// Share of the squares of all cross-talk of channels apart that one channel has where it is none: of nine that are alike each has a ninth, and it
/// three times that.
const OF_ONE: f64 = 1.0 / 3.0;
/// Squares by which the fit may be worse with it.
const BY_CHANCE: f64 = 30.0;
/// Steps of the search for the factor: each is a parabola's.
const STEPS: [f64; 2] = [0.02, 0.005];

const KINDS: [(Role, &str); 3] = [
    (Role::Angular, "angular"),
    (Role::HighFrequencyLinear, "fast linear"),
    (Role::Linear, "linear"),
];

/// What channels show in the trials of a kind over what they show in the others.
#[derive(Debug, Clone, Copy)]
struct Other {
    role: Role,
    factors: [f64; LIMBS],
}

impl Other {
    /// Channels that show more or less, from 0.
    fn channels(&self) -> impl Iterator<Item = usize> {
        (0..LIMBS).filter(|limb| (self.factors[*limb] - 1.0).abs() > NOTICED)
    }

    fn is_sensors(&self) -> bool {
        let within = self.factors.iter().all(|f| (f - 1.0).abs() < GAINS);
        within && self.channels().next().is_some()
    }
}

/// What accounts for all trials, if this does, and better than `accounting` where that does already.
pub fn tried(day: &Unaccounted<'_>, accounting: Option<&JointReport>) -> Option<Finding> {
    if accounting.is_some_and(|joint| left_for_others(joint) < CROSS_TALK) {
        return None;
    }
    let shares = StaticLoadSharing::new(&day.campaign.geometry).ok()?;
    let by_responses = || {
        let all = KINDS.iter();
        let all = all.filter_map(|(role, _)| best(&shares, day.cases, *role));
        let (other, table, _) = all.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let joint = put_right(day, &other, &table).filter(JointReport::accounts)?;
        is_better(&other, &joint, accounting).then_some((other, joint))
    };
    let by_cross_talk = || {
        let (other, joint) = of_one_row(day, &shares, day.joint.ok()?)?;
        is_better(&other, &joint, accounting).then_some((other, joint))
    };
    let both = [by_responses(), by_cross_talk()].into_iter().flatten();
    let (other, joint) =
        both.min_by(|(_, a), (_, b)| left_for_others(a).total_cmp(&left_for_others(b)))?;
    let (_, kind) = KINDS.iter().find(|(role, _)| *role == other.role)?;
    let concerned = day
        .cases
        .iter()
        .filter(|case| case.trial.role == other.role);
    let shown = other
        .channels()
        .map(|limb| format!("channel {} {:.3} times", limb + 1, other.factors[limb]));
    let evidence = format!(
        "the {kind} trials show other than the others, {} as much: with that put right all agree to the noise (misfit {:.2}) with cross-talk of {:.3} % between channels apart{}",
        shown.collect::<Vec<_>>().join(", "),
        joint.misfit.per_degree,
        100.0 * left_for_others(&joint),
        accounting.map_or(String::new(), |without| format!(
            ", as they are with {:.3} %",
            100.0 * left_for_others(without)
        ))
    );
    let advice = "see whether limb, plug or gain was another in these trials, and repeat them";
    let finding = Finding::new(Cause::FadingSensitivity, evidence, advice);
    let finding = finding.in_recordings(names(concerned));
    Some(finding.on_channels(other.channels()))
}

/// Whether less is left for cross-talk than in the fit that accounts for the day as it is, if one does, and that had as much of it as such a
/// change hides in.
fn is_better(other: &Other, joint: &JointReport, accounting: Option<&JointReport>) -> bool {
    let left = left_for_others(joint);
    accounting.map_or(left < ORDINARY, |without| {
        let less = TIMES * left < left_for_others(without);
        let off = other.factors.map(|factor| (factor - 1.0).abs());
        let change = off.into_iter().fold(0.0, f64::max);
        let hides = left_for_others(without) > HIDES * change;
        less && hides && joint.estimate.squares < without.estimate.squares + BY_CHANCE
    })
}

/// The channel that has most of the cross-talk of channels apart, put right in the kind of trials where the responses say so, and the fit with it. Errors of
/// wedges move what the responses say of the factor: of what the first fit leaves in that channel a second factor follows.
fn of_one_row(
    day: &Unaccounted<'_>,
    shares: &StaticLoadSharing,
    without: &JointReport,
) -> Option<(Other, JointReport)> {
    let rows = apart(without);
    let product =
        |a: &[f64; LIMBS], b: &[f64; LIMBS]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let squares = rows.map(|row| product(&row, &row));
    let limb = (0..LIMBS).max_by(|a, b| squares[*a].total_cmp(&squares[*b]))?;
    if squares[limb] < OF_ONE * squares.iter().sum::<f64>() {
        return None;
    }
    let of_kind = |role| {
        let mut other = Other {
            role,
            factors: [1.0; LIMBS],
        };
        refine(shares, day.cases, &mut other, limb)?;
        let (left, table) = with(shares, day.cases, &other)?;
        other.is_sensors().then_some((other, table, left))
    };
    let kinds = KINDS.iter().filter_map(|(role, _)| of_kind(*role));
    let (mut other, table, _) = kinds.min_by(|a, b| a.2.total_cmp(&b.2))?;
    let first = apart(&put_right(day, &other, &table)?);
    let left = product(&first[limb], &rows[limb]) / squares[limb];
    other.factors[limb] = 1.0 + (other.factors[limb] - 1.0) / (1.0 - left);
    let sensors = other.is_sensors();
    let joint = sensors.then(|| put_right(day, &other, &table)).flatten();
    joint
        .filter(JointReport::accounts)
        .map(|joint| (other, joint))
}

/// Spread of the shares that channels show of others that are not beside them.
fn left_for_others(joint: &JointReport) -> f64 {
    joint.estimate.spreads.cross_talk_apart
}

/// What channels show of others that are not beside them; a channel a row.
fn apart(joint: &JointReport) -> [[f64; LIMBS]; LIMBS] {
    let mut shares = joint.limbs().cross_talk;
    for (into, row) in shares.iter_mut().enumerate() {
        for (from, share) in row.iter_mut().enumerate() {
            if Unknowns::are_side_by_side(into, from) {
                *share = 0.0;
            }
        }
    }
    shares
}

/// The factors with which the responses agree best, one channel after the other, what they then agree on, and how far they are from it.
fn best(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    role: Role,
) -> Option<(Other, Table, f64)> {
    let of_kind = usable(cases).filter(|(case, _)| case.trial.role == role);
    if of_kind.count() < FEWEST {
        return None;
    }
    let mut other = Other {
        role,
        factors: [1.0; LIMBS],
    };
    let mut changed: Vec<usize> = Vec::new();
    while changed.len() < MOST {
        let Some(limb) = most_odd(shares, cases, &other).filter(|limb| !changed.contains(limb))
        else {
            break;
        };
        changed.push(limb);
        // The one before is off by a part of what this one is.
        for limb in changed.iter().rev() {
            refine(shares, cases, &mut other, *limb)?;
        }
    }
    let (left, table) = with(shares, cases, &other)?;
    other.is_sensors().then_some((other, table, left))
}

/// The channel whose responses depart most from what the others make one expect in the trials of a kind, with what is known put right.
fn most_odd(shares: &StaticLoadSharing, cases: &[TrialCase<'_>], other: &Other) -> Option<usize> {
    let (_, table) = with(shares, cases, other)?;
    let off = |limb: usize| {
        let of_kind = usable(cases).filter(|(case, _)| case.trial.role == other.role);
        let mut ratios: Vec<(f64, f64)> = of_kind
            .map(|(case, response)| {
                let (seen, expected) = table.compare(case, response);
                let seen = seen[limb] / other.factors[limb];
                (seen / expected[limb], expected[limb].abs())
            })
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        weighted_median(&mut ratios).map(|ratio| (limb, (ratio - 1.0).abs()))
    };
    let all = (0..LIMBS).filter_map(off);
    let (limb, most) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most > WORTH_A_LOOK).then_some(limb)
}

/// Moves one channel's factor to where the responses agree best.
fn refine(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    other: &mut Other,
    limb: usize,
) -> Option<()> {
    for step in STEPS {
        let at = |change: f64| {
            let mut moved = *other;
            moved.factors[limb] += change;
            with(shares, cases, &moved).map(|(cost, _)| cost)
        };
        let (below, here, above) = (at(-step)?, at(0.0)?, at(step)?);
        let bend = below + above - 2.0 * here;
        if bend > 0.0 {
            other.factors[limb] += (0.5 * step * (below - above) / bend).clamp(-GAINS, GAINS);
        }
    }
    Some(())
}

/// How far the responses are from agreeing with those channels put right, and what they then agree on.
fn with(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    other: &Other,
) -> Option<(f64, Table)> {
    let right: Vec<TrialCase<'_>> = cases
        .iter()
        .map(|case| {
            let mut right = TrialCase {
                force_n: Vec::new(),
                ..case.clone()
            };
            if case.trial.role == other.role
                && let Some(response) = &mut right.response
            {
                let channels = response.channels.iter_mut().zip(other.factors);
                channels.for_each(|(channel, factor)| *channel = *channel * factor.recip());
            }
            right
        })
        .collect();
    agreement(shares, &right)
}

/// The fit with those channels put right.
fn put_right(day: &Unaccounted<'_>, other: &Other, table: &Table) -> Option<JointReport> {
    day.fit_put_right(table, |trial| {
        if trial.role == other.role {
            for row in &mut trial.voltage_v {
                for (limb, u) in row.iter_mut().enumerate() {
                    let zero_v = day.drift.drift_v[limb];
                    *u = zero_v + (*u - zero_v) / other.factors[limb];
                }
            }
        }
    })
}
