//! The kind of a failure, and the limb among those that share a signature, from the statistics of the failure and of the channels since the alarm.
//!
//! Every sample gives the failure's size a_t = e_t + noise. Each kind restricts the course e_t: constant (the zero jumped), constant
//! and ramp (the zero drifts), in proportion to the channel's own signal (the sensitivity jumped), white (noise), zero (it has
//! passed). Each is fitted by least squares, and its coefficients cost ln(n)/2 each (Schwarz's criterion). A dead or a stuck channel
//! does not restrict e_t but shows itself: a dead one is at its zero and has only its noise, a stuck one has not even that. The
//! noise in the monitor's settings must therefore be at least the converter's own.
//!
//! # Ambiguous pairs
//! Let e_t be any course. "Limb 2 fails by e_t" and "limb 4 fails by e_t" give the same three rows, since the columns of the pair are
//! equal, and the two loads that they imply differ by the load that only these two limbs bear: either explains all nine channels
//! exactly. Forces therefore never resolve a pair; these do:
//!
//! * the course is in proportion to one channel's signal and not to the other's (sensitivity);
//! * one channel is constant (stuck, or dead while the load that the other limbs imply moves as no drift does);
//! * one channel is rough where the motion is smooth (noise), or steps (zero, a contact that fails for moments).
//!
//! A slow drift has none of these; the result is then the pair. Without limbs that have failed before, more limbs than two share a
//! signature, and are distinguished, or not, likewise.

use super::history::History;
use super::misfit::MORE;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use super::verdict::Kind;
use crate::float::{ln, sqrt};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// ln of the odds from which a kind is accepted before all samples are in: a hundred to one.
const KIND: f64 = 4.6;
/// ln of the odds from which a limb of an ambiguous pair is accepted: a thousand to one.
const LIMB_OF_PAIR: f64 = 6.9;
/// Share of its noise that a channel has at most if it is stuck: of 32 samples of noise one in 100,000 has so little.
const NOISELESS: f64 = 0.25;
/// Mean square of a signal over that of its noise from which a sensitivity is observable.
const LOUD: f64 = 10.0;
/// Correlation of neighbouring sizes from which a course is a motion and not noise.
const SMOOTH_COURSE: f64 = 0.5;
/// Standard deviations of roughness, and of a step, from which one channel of a pair has it, and up to which the other has not.
const ROUGH: f64 = 6.0;
const SMOOTH: f64 = 4.0;
const STEPS: f64 = 6.0;
const NO_STEP: f64 = 4.5;

/// Kind, limb or limbs, and ln of the odds of both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Best kind.
    pub kind: Kind,
    /// The limb, or both of an ambiguous pair.
    pub limbs: LimbSet,
    /// Against the next best kind.
    pub kind_ln_odds: f64,
    /// Against the other limb of the pair.
    pub partner_ln_odds: f64,
    /// A channel shows only noise and may yet turn out dead.
    open: bool,
}

impl Judgement {
    /// Whether more samples are unlikely to change it.
    #[must_use]
    pub fn is_firm(&self) -> bool {
        let resolved =
            self.limbs.len() == 1 || matches!(self.kind, Kind::Offset | Kind::Drift | Kind::Passed);
        self.kind_ln_odds > KIND && resolved && !self.open
    }
}

/// Judges a class by the statistics since the alarm: one of `limbs` has failed; `steps` are the channels' largest steps about the
/// alarm, in standard deviations.
#[must_use]
pub fn judge(
    noise: &RowNoise,
    class: usize,
    limbs: LimbSet,
    rows: &Moments,
    history: &History,
    steps: &[f64; LIMBS],
) -> Judgement {
    let n = rows.samples() as f64;
    let direction = noise.direction(class);
    let [mean, slope] = rows.mean_and_slope();
    let (mean, slope) = (dot(direction, &mean), dot(direction, &slope));
    let energy = rows.energy_along(direction);
    let cost = 0.5 * ln(n);
    let mut best = Best::default();
    best.offer(Kind::Passed, 0.0);
    best.offer(Kind::Offset, 0.5 * mean * mean - cost);
    best.offer(
        Kind::Drift,
        0.5 * (mean * mean + slope * slope) - 2.0 * cost,
    );
    best.offer(Kind::NoiseBurst, super::likelihood::gain(energy, n) - cost);
    let spread = sqrt(2.0 * n);
    let fails = energy > n + MORE * spread;
    // The load of a dead limb in motion: neither a zero that jumps or drifts nor noise.
    let moves = energy - mean * mean - slope * slope > n + MORE * spread
        && history.lagged_along(direction) > SMOOTH_COURSE * energy;
    let step = |limb: usize| steps.get(limb).copied().unwrap_or(0.0);
    let rough = lead(
        limbs,
        |limb| history.roughness(limb),
        contrast(ROUGH, SMOOTH),
    );
    let stepped = lead(limbs, step, contrast(STEPS, NO_STEP));
    let abrupt = if rough.1 > LIMB_OF_PAIR {
        rough
    } else {
        stepped
    };
    let other_is_abrupt =
        |limb: usize| limbs.len() > 1 && abrupt.1 > LIMB_OF_PAIR && abrupt.0 != limb;
    let mut scale = [f64::NEG_INFINITY; LIMBS];
    let mut fell = [None; LIMBS];
    let mut open = false;
    for limb in limbs.indices() {
        let channel = &history.channels[limb];
        // Where the signal is little but noise, the failure's size, which has the same noise in it, goes along with it.
        if channel.square > LOUD * n {
            let gain = channel.with_size * channel.with_size / channel.square;
            scale[limb] = 0.5 * gain - cost;
            best.offer(Kind::ScaleJump, scale[limb]);
        }
        // The other limb of a pair at rest is at its zero, too.
        let resolved = moves || limbs.len() == 1;
        fell[limb] = if !fails {
            None
        } else if history.own(limb) < NOISELESS * n {
            let dead = history.is_at_zero(limb) && resolved;
            Some(if dead { Kind::Dead } else { Kind::Stuck })
        } else if other_is_abrupt(limb) {
            // A contact that fails for moments: what it misses is no load of a partner that happens to rest.
            None
        } else if history.is_at_zero(limb) && resolved {
            Some(Kind::Dead)
        } else if history.is_flat(limb) && moves {
            Some(Kind::Stuck)
        } else {
            open |= history.is_flat(limb);
            None
        };
        // The course is the limb's load: nothing of it is left to explain.
        if let Some(kind) = fell[limb] {
            best.offer(kind, 0.5 * energy);
        }
    }
    let kind = best.kind;
    let (named, partner_ln_odds) = match kind {
        Kind::Dead | Kind::Stuck => {
            let mut fallen = limbs.indices().filter(|&limb| fell[limb].is_some());
            match (fallen.next(), fallen.next()) {
                (Some(limb), None) => (limb, f64::INFINITY),
                _ => (0, 0.0),
            }
        }
        // The load of a flat limb, which may be dead, goes along with the signal of another for a while.
        Kind::ScaleJump if limbs.minus(history.flat()) == limbs => {
            lead(limbs, |limb| scale[limb], |best, next| best - next)
        }
        Kind::NoiseBurst => abrupt,
        Kind::Offset => stepped,
        _ => (0, 0.0),
    };
    let (limbs, partner_ln_odds) = if limbs.len() == 1 {
        (limbs, f64::INFINITY)
    } else if partner_ln_odds > LIMB_OF_PAIR {
        (LimbSet::EMPTY.with(named), partner_ln_odds)
    } else {
        (limbs, 0.0)
    };
    Judgement {
        kind,
        limbs,
        kind_ln_odds: best.score - best.next,
        partner_ln_odds,
        open: open && !matches!(kind, Kind::Dead | Kind::Stuck),
    }
}

/// The limb of which something is largest, and ln of the odds for it by that and by what it is of the next one.
fn lead(
    limbs: LimbSet,
    size: impl Fn(usize) -> f64,
    odds: impl Fn(f64, f64) -> f64,
) -> (usize, f64) {
    let (mut named, mut best, mut next) = (0, f64::NEG_INFINITY, f64::NEG_INFINITY);
    for limb in limbs.indices() {
        let size = size(limb);
        if size > best {
            (named, next, best) = (limb, best, size);
        } else if size > next {
            next = size;
        }
    }
    let odds = odds(best, next);
    (named, if odds.is_nan() { 0.0 } else { odds })
}

/// ln of the odds for a limb by what only one of them may have; 0 where another has it, too, or none.
fn contrast(has: f64, has_not: f64) -> impl Fn(f64, f64) -> f64 {
    move |best, next| {
        if best > has && next < has_not {
            0.5 * (best * best - next * next)
        } else {
            0.0
        }
    }
}

struct Best {
    kind: Kind,
    score: f64,
    next: f64,
}

impl Default for Best {
    fn default() -> Self {
        Self {
            kind: Kind::Unknown,
            score: f64::NEG_INFINITY,
            next: f64::NEG_INFINITY,
        }
    }
}

impl Best {
    fn offer(&mut self, kind: Kind, score: f64) {
        if score > self.score {
            if kind != self.kind {
                self.next = self.score;
            }
            (self.kind, self.score) = (kind, score);
        } else if kind != self.kind && score > self.next {
            self.next = score;
        }
    }
}
