//! How a limb has failed, and which of two twins, from the course of the failure and of the channels since the alarm.
//!
//! Each kind says something of the failure's course e_t, of which every sample gives a_t = e_t + noise: constant (another
//! zero), constant and ramp (a zero that moves), in proportion to the channel's own signal (another sensitivity), white
//! (noise), nothing (it has passed). Each is fitted by least squares, its coefficients cost ln(n)/2 each (Schwarz). Dead and
//! stuck say nothing of e_t; they say that the channel keeps still, which no working channel does while its limb's load, known
//! from the others, moves.
//!
//! # Twins
//! Let e_t be any course. "Limb 2 fails by e_t" and "limb 4 fails by e_t" give the same three rows, since the twins' columns are
//! equal, and the two loads that they imply differ by the one that only the twins bear: nine channels are explained exactly
//! by either. So forces never tell twins apart; what does is knowledge of another kind:
//!
//! * the course goes along with one channel's signal and not with the other's (sensitivity);
//! * one channel keeps still (dead, stuck);
//! * one channel is rough where motion is smooth (noise), or steps (zero).
//!
//! A slow drift has none of these. Then the answer is the pair.

use super::class::members;
use super::history::History;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use super::verdict::Kind;
use crate::geometry::LIMBS;
use crate::parity::LimbSet;
use crate::scalar::{ln, sqrt};

/// ln of the odds at which a kind is said before all samples are in: a hundred to one.
const KIND: f64 = 4.6;
/// ln of the odds at which a twin is named: a thousand to one.
const TWIN: f64 = 6.9;
/// Standard deviations of a sum of squares within which a channel keeps still, and beyond which it moves.
const STILL: f64 = 4.0;
const MOVES: f64 = 8.0;
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
    pub twin_ln_odds: f64,
}

impl Judgement {
    /// Whether more samples would hardly change it.
    #[must_use]
    pub fn is_firm(&self) -> bool {
        let twin =
            self.limbs.len() == 1 || !matches!(self.kind, Kind::ScaleJump | Kind::NoiseBurst);
        self.kind_ln_odds > KIND && twin
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
    let course = Course {
        n,
        sum: mean * sqrt(n),
        energy,
    };
    let mut scale = [f64::NEG_INFINITY; 2];
    let mut still = [false; 2];
    for (place, limb) in twins.indices().enumerate().take(2) {
        let (dead, stuck, proportion) = course.of_limb(noise, class, limb, history);
        if let Some(gain) = proportion {
            scale[place] = gain - cost;
            best.offer(Kind::ScaleJump, scale[place]);
        }
        // The course is the limb's load: nothing of it is left to explain.
        if dead || stuck {
            still[place] = true;
            best.offer(if dead { Kind::Dead } else { Kind::Stuck }, 0.5 * energy);
        }
    }
    let kind = best.kind;
    let (limbs, twin_ln_odds) = match twins.len() {
        2 => {
            let mut pair = twins.indices();
            let limb = [pair.next().unwrap_or(0), pair.next().unwrap_or(0)];
            let favour = match kind {
                Kind::Dead | Kind::Stuck => match still {
                    [true, false] => f64::INFINITY,
                    [false, true] => f64::NEG_INFINITY,
                    _ => 0.0,
                },
                Kind::ScaleJump => scale[0] - scale[1],
                Kind::NoiseBurst => contrast(limb.map(|l| history.roughness(l)), ROUGH, SMOOTH),
                Kind::Offset => contrast(limb.map(|l| steps[l]), STEPS, NO_STEP),
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
        twin_ln_odds,
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

/// A failure's course, in standard deviations of the size that one sample gives.
struct Course {
    n: f64,
    sum: f64,
    energy: f64,
}

impl Course {
    /// Whether the limb is dead, whether it is stuck, and the gain of a course in proportion to its signal.
    fn of_limb(
        &self,
        noise: &RowNoise,
        class: usize,
        limb: usize,
        history: &History,
    ) -> (bool, bool, Option<f64>) {
        let n = self.n;
        let channel = &history.channels[limb];
        let spread = sqrt(2.0 * n);
        // The channel's noise stands in the failure's size, too: their covariance for unit variance of both.
        let shared = noise.length(class) * noise.channel_sd()[limb];
        let signal = channel.square - n;
        let product = channel.with_size - n * shared;
        let proportion = (signal > n).then(|| 0.5 * product * product / signal);
        let fails = self.energy > n + MOVES * spread;
        let dead = fails && channel.square < n + STILL * spread;
        // The load that the other limbs say: signal less failure, in units of the channel's noise.
        let per_size = 1.0 / shared;
        let about_mean = |square: f64, a: f64, b: f64| square - a * b / n;
        let own = about_mean(channel.square, channel.sum, channel.sum);
        let with = about_mean(channel.with_size, channel.sum, self.sum);
        let of_size = about_mean(self.energy, self.sum, self.sum);
        let load = own - 2.0 * per_size * with + per_size * per_size * of_size;
        let moves = load > (n + MOVES * spread) * (per_size * per_size - 1.0);
        let stuck = fails && moves && own < n + STILL * spread;
        (dead, stuck, proportion)
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
