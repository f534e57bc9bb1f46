//! Two or three limbs dead at once, by what their own channels show: such limbs span a plane of the rows or all of them, and the
//! rows alone cannot say which they are.
//!
//! A set may explain a failure if each of its channels is flat since the alarm and was not so before, each of its limbs is what the
//! rows miss, and the rows that are free of the set are quiet. But a channel is flat where its load is constant, too. It is believed to
//! have failed if it was loud just before the alarm and is at zero since, if it moved before and is flat for longer since, or, as long
//! as the set leaves a relation to contradict it, if it is flat for long while the load that the other limbs imply moves.

use super::class::CLASS_OF;
use super::history::History;
use super::misfit::Misfit;
use super::noise::{RowNoise, cross, dot, unit};
use super::step::Ring;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::ROWS;

/// Samples before the alarm that may be of the failure already, samples that say whether a channel was loud, and whether it moved.
const MARGIN: u64 = 16;
const LOUD: u64 = 32;
const MOVED: u64 = 192;
/// Samples for which no channel is flat in the turn of a motion, and standard deviations by which its mean has changed when it
/// was another before.
const STOPPED: u64 = 512;
const CHANGED: f64 = 1.5;
/// Mean square over that of noise from which a channel was loud, or moved.
const BEYOND_NOISE: f64 = 3.0;
/// Correlation of neighbouring sizes from which a course is a motion and not noise.
const SMOOTH_COURSE: f64 = 0.5;

/// What the channels were like before an alarm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Before {
    loud: LimbSet,
    moved: LimbSet,
    mean: [f64; LIMBS],
    /// Whether the alarm is not the first one of this failure, so that all this is of long before.
    pub long_ago: bool,
}

impl Before {
    /// Of a failure that began with sample `since` at the earliest; `signal` is a channel's voltage in its noise.
    pub fn new(ring: &Ring, since: u64, signal: impl Fn(usize, f64) -> f64) -> Self {
        let mut before = Self::default();
        let end = since.saturating_sub(MARGIN);
        for limb in 0..LIMBS {
            let sums = |from: u64| {
                let stretch = ring.stretch(limb, from, end).map(|v| signal(limb, v));
                stretch.fold((0.0_f64, 0.0, 0.0), |(n, sum, square), y| {
                    (n + 1.0, sum + y, square + y * y)
                })
            };
            let (n, sum, square) = sums(end.saturating_sub(LOUD));
            before.mean[limb] = sum / n.max(1.0);
            if n > 0.5 * LOUD as f64 && square > BEYOND_NOISE * n {
                before.loud = before.loud.with(limb);
            }
            let (n, sum, square) = sums(end.saturating_sub(MOVED));
            if n > 0.5 * MOVED as f64 && square - sum * sum / n > BEYOND_NOISE * n {
                before.moved = before.moved.with(limb);
            }
        }
        before
    }

    /// Limbs that moved and are flat now.
    pub fn stopped(&self, history: &History) -> LimbSet {
        let flat = history.flat();
        flat.minus(flat.minus(self.moved))
    }
}

/// The sets that may explain the rows and no subset of which does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sets {
    /// How many there are.
    pub count: usize,
    /// Limbs that are in all of them.
    pub common: LimbSet,
    /// The first one, if its limbs are believed to have failed.
    pub believed: Option<LimbSet>,
}

/// Looks for sets of two and three dead limbs; those in `gone` are out of the question.
pub(super) fn sets(
    noise: &RowNoise,
    misfit: &Misfit<'_>,
    history: &History,
    before: &Before,
    gone: LimbSet,
) -> Sets {
    let flat = history.flat().minus(gone);
    let mut found = Sets::default();
    let mut pairs = [LimbSet::EMPTY; LIMBS * (LIMBS - 1) / 2];
    let mut count = 0;
    for size in 2..=noise.relations() {
        for set in LimbSet::of_size(size).filter(|set| set.minus(flat).is_empty()) {
            let minimal = pairs.iter().take(count).all(|p| !p.minus(set).is_empty());
            if !minimal {
                continue;
            }
            let Some(believed) = explains(noise, misfit, history, before, set) else {
                continue;
            };
            if let Some(place) = pairs.get_mut(count).filter(|_| size == 2) {
                *place = set;
                count += 1;
            }
            if found.count == 0 {
                found.common = set;
                found.believed = believed.then_some(set);
            }
            found.common = found.common.minus(found.common.minus(set));
            found.count += 1;
        }
    }
    found
}

/// Whether some flat limb shows in no relation that is left without `limbs`, so that it may have failed with them unseen.
pub(super) fn may_hide(noise: &RowNoise, history: &History, limbs: LimbSet, gone: LimbSet) -> bool {
    let left = noise.without(limbs);
    let shows = |limb: usize| {
        let class = CLASS_OF.get(limb).copied().unwrap_or(0);
        left.length(class) > 0.0
    };
    let others = history.flat().minus(limbs).minus(gone);
    others.indices().any(|limb| !shows(limb))
}

/// Whether a set may explain the rows, and then whether its limbs are believed to have failed.
fn explains(
    noise: &RowNoise,
    misfit: &Misfit<'_>,
    history: &History,
    before: &Before,
    set: LimbSet,
) -> Option<bool> {
    let contradicted = noise.relations() > set.len();
    let direction = |limb: usize| {
        let class = CLASS_OF.get(limb).copied().unwrap_or(0);
        *noise.direction(class)
    };
    let mut others = set.indices();
    let (a, b) = (others.next()?, others.next()?);
    let third = others.next();
    let normal = unit(&cross(&direction(a), &direction(b)))?;
    if third.is_none() && contradicted && !misfit.is_quiet_along(&normal) {
        return None;
    }
    // The direction in which only one limb of the set shows.
    let own = |limb: usize, others: [usize; 2]| -> Option<[f64; ROWS]> {
        let own = match third {
            Some(_) => unit(&cross(&direction(others[0]), &direction(others[1]))),
            None => unit(&cross(&direction(others[0]), &normal)),
        }?;
        // Of three limbs in one plane none shows by itself.
        (dot(&own, &direction(limb)).abs() > 1e-6).then_some(own)
    };
    let fails = |limb: usize, others: [usize; 2]| {
        let own = own(limb, others)?;
        let [loud, moves] = misfit.is_loud_along(&own);
        let moves =
            moves && history.lagged_along(&own) > SMOOTH_COURSE * history.energy_along(&own);
        let moved = before.moved.contains(limb);
        let mean = before.mean.get(limb).copied().unwrap_or(0.0);
        let changed = moved || (history.mean(limb) - mean).abs() > CHANGED;
        let stepped = before.loud.contains(limb) && history.is_at_zero(limb);
        let long = history.samples >= STOPPED;
        let shown = (stepped || (moved && long)) && !before.long_ago;
        let believed = shown || (moves && contradicted && long);
        (loud && (changed || moves)).then_some(believed)
    };
    Some(match third {
        None => fails(a, [b, b])? & fails(b, [a, a])?,
        Some(c) => fails(a, [b, c])? & fails(b, [c, a])? & fails(c, [a, b])?,
    })
}
