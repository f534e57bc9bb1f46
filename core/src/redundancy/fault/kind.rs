//! The kind of a failure, and the limb of an ambiguous pair, from the statistics of the failure and of the channels since the alarm.
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
//! * one channel is rough where the motion is smooth (noise), or steps (zero).
//!
//! A slow drift has none of these; the result is then the pair.

use super::class::members;
use super::history::History;
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
/// Standard deviations of a sum of squares within which there is only noise, and beyond which there is more.
const STILL: f64 = 4.0;
const MOVES: f64 = 8.0;
/// Share of its noise that a channel has at most if it is stuck: of 32 samples of noise one in 10^9 has so little.
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

/// Judges a class by the statistics since the alarm; `steps` are the channels' largest steps about it, in standard deviations.
#[must_use]
pub fn judge(
    noise: &RowNoise,
    class: usize,
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
    let members = members(class);
    let spread = sqrt(2.0 * n);
    let fails = energy > n + MOVES * spread;
    // The load of a dead limb in motion: neither a zero that jumps or drifts nor noise.
    let moves = energy - mean * mean - slope * slope > n + MOVES * spread
        && history.lagged.get(class).copied().unwrap_or(0.0) > SMOOTH_COURSE * energy;
    let mut scale = [f64::NEG_INFINITY; 2];
    let mut fell = [None; 2];
    let mut open = false;
    for ((scale, fell), limb) in scale.iter_mut().zip(&mut fell).zip(members.indices()) {
        let Some(channel) = history.channels.get(limb) else {
            continue;
        };
        // Where the signal is little but noise, the failure's size, which has the same noise in it, goes along with it.
        if channel.square > LOUD * n {
            let gain = channel.with_size * channel.with_size / channel.square;
            *scale = 0.5 * gain - cost;
            best.offer(Kind::ScaleJump, *scale);
        }
        let own = channel.square - channel.sum * channel.sum / n;
        let at_zero = channel.square < n + STILL * spread;
        // The other limb of a pair at rest is at its zero, too.
        let resolved = moves || members.len() == 1;
        *fell = if !fails {
            None
        } else if at_zero && resolved {
            Some(Kind::Dead)
        } else if own < NOISELESS * n {
            Some(Kind::Stuck)
        } else {
            open |= own < n + STILL * spread;
            None
        };
        // The course is the limb's load: nothing of it is left to explain.
        if let Some(kind) = *fell {
            best.offer(kind, 0.5 * energy);
        }
    }
    let kind = best.kind;
    let (limbs, partner_ln_odds) = match members.len() {
        2 => {
            let mut pair = members.indices();
            let limb = [pair.next().unwrap_or(0), pair.next().unwrap_or(0)];
            let favour = match kind {
                Kind::Dead | Kind::Stuck => match fell.map(|f| f == Some(kind)) {
                    [true, false] => f64::INFINITY,
                    [false, true] => f64::NEG_INFINITY,
                    _ => 0.0,
                },
                Kind::ScaleJump => scale[0] - scale[1],
                Kind::NoiseBurst => contrast(limb.map(|l| history.roughness(l)), ROUGH, SMOOTH),
                Kind::Offset => contrast(
                    limb.map(|l| steps.get(l).copied().unwrap_or(0.0)),
                    STEPS,
                    NO_STEP,
                ),
                _ => 0.0,
            };
            if favour.abs() > LIMB_OF_PAIR {
                let named = limb[usize::from(favour < 0.0)];
                (LimbSet::EMPTY.with(named), favour.abs())
            } else {
                (members, 0.0)
            }
        }
        _ => (members, f64::INFINITY),
    };
    Judgement {
        kind,
        limbs,
        kind_ln_odds: best.score - best.next,
        partner_ln_odds,
        open: open && !matches!(kind, Kind::Dead | Kind::Stuck),
    }
}

/// ln of the odds for the first of two by what only one of them may have; 0 where both have it or neither.
fn contrast(size: [f64; 2], has: f64, has_not: f64) -> f64 {
    let odds = 0.5 * (size[0] * size[0] - size[1] * size[1]);
    let (larger, smaller) = (size[0].max(size[1]), size[0].min(size[1]));
    if larger > has && smaller < has_not {
        odds
    } else {
        0.0
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
