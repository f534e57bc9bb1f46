//! How a limb has failed, and which of two twins, from the course of the failure and of the channels since the alarm.
//!
//! Each kind says something of the failure's course e_t, of which every sample gives a_t = e_t + noise: constant (another
//! zero), constant and ramp (a zero that moves), in proportion to the channel's own signal (another sensitivity), white
//! (noise), nothing (it has passed). Each is fitted by least squares, its coefficients cost ln(n)/2 each (Schwarz). Dead and
//! stuck say nothing of e_t; they say that the channel is at its zero and has only its noise, and that it has not even that. The
//! noise that a monitor is told of must therefore be at least the converter's own.
//!
//! # Twins
//! Let e_t be any course. "Limb 2 fails by e_t" and "limb 4 fails by e_t" give the same three rows, since the twins' columns are
//! equal, and the two loads that they imply differ by the one that only the twins bear: nine channels are explained exactly
//! by either. So forces never tell twins apart; what does is knowledge of another kind:
//!
//! * the course goes along with one channel's signal and not with the other's (sensitivity);
//! * one channel keeps still (stuck, or dead while the load that the others say moves as no drift does);
//! * one channel is rough where motion is smooth (noise), or steps (zero).
//!
//! A slow drift has none of these. Then the answer is the pair.

use super::class::members;
use super::history::History;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use super::verdict::Kind;
use crate::float::{ln, sqrt};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// ln of the odds at which a kind is said before all samples are in: a hundred to one.
const KIND: f64 = 4.6;
/// ln of the odds at which a twin is named: a thousand to one.
const TWIN: f64 = 6.9;
/// Standard deviations of a sum of squares within which there is but noise, and beyond which there is more.
const STILL: f64 = 4.0;
const MOVES: f64 = 8.0;
/// Share of its noise that a channel has at most if it is stuck: of 32 samples of noise one in 10^9 has so little.
const NOISELESS: f64 = 0.25;
/// Mean square of a signal over its noise's from which a sensitivity can be told.
const LOUD: f64 = 10.0;
/// Correlation of neighbouring sizes from which a course is a motion and not noise.
const SMOOTH_COURSE: f64 = 0.5;
/// Standard deviations of roughness, and of a step, from which a channel has it, and up to which its twin has not.
const ROUGH: f64 = 6.0;
const SMOOTH: f64 = 4.0;
const STEPS: f64 = 6.0;
const NO_STEP: f64 = 4.5;

/// Kind, limb or limbs, and ln of the odds of both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Best kind.
    pub kind: Kind,
    /// The limb, or both twins.
    pub limbs: LimbSet,
    /// Against the next best kind.
    pub kind_ln_odds: f64,
    /// Against the twin.
    pub partner_ln_odds: f64,
    /// A channel keeps still that may yet turn out dead.
    open: bool,
}

impl Judgement {
    /// Whether more samples would hardly change it.
    #[must_use]
    pub fn is_firm(&self) -> bool {
        let resolved =
            self.limbs.len() == 1 || matches!(self.kind, Kind::Offset | Kind::Drift | Kind::Passed);
        self.kind_ln_odds > KIND && resolved && !self.open
    }
}

/// Judges a class by what was gathered since the alarm; `steps` are the channels' largest steps about it, in standard deviations.
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
    best.offer(Kind::NoiseBurst, super::isolation::gain(energy, n) - cost);
    let twins = members(class);
    let spread = sqrt(2.0 * n);
    let fails = energy > n + MOVES * spread;
    // What no zero that jumps or drifts and no noise would look like: the load of a dead limb, in motion.
    let moves = energy - mean * mean - slope * slope > n + MOVES * spread
        && history.lagged.get(class).copied().unwrap_or(0.0) > SMOOTH_COURSE * energy;
    let mut scale = [f64::NEG_INFINITY; 2];
    let mut fell = [None; 2];
    let mut open = false;
    for ((scale, fell), limb) in scale.iter_mut().zip(&mut fell).zip(twins.indices()) {
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
        // A twin at rest is at its zero, too.
        let told = moves || twins.len() == 1;
        *fell = if !fails {
            None
        } else if at_zero && told {
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
    let (limbs, partner_ln_odds) = match twins.len() {
        2 => {
            let mut pair = twins.indices();
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
            if favour.abs() > TWIN {
                let named = limb[usize::from(favour < 0.0)];
                (LimbSet::EMPTY.with(named), favour.abs())
            } else {
                (twins, 0.0)
            }
        }
        _ => (twins, f64::INFINITY),
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
