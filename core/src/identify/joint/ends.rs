//! Trials that do not end at the angle at which they began, told by their two ends at rest.
//!
//! A motor stops some degrees of the crank before or after whole turns. The rate is nought at both ends all the same, and one period of a
//! smooth signal; but it has a mean, the angle between the ends over the time, which the gyroscope shows together with its own zero. What it
//! reads at rest is that zero. With gravity turning in the sensor the channels show the angle, too: they do not come back to where they
//! stood, and that step, which no harmonics up to any end hold, must not count as noise.

use alloc::vec::Vec;
use core::ops::Range;

use glam::DVec3;

use super::harmonics::Grid;
use super::record::Record;
use super::trial::Drive;
use super::{Known, TURNS};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Length of the pieces that a rest is made of, s: a period of the mains.
const PIECE_S: f64 = 0.02;
/// Pieces of a rest, at least. The one beside the motion does not count: it may hold its beginning.
const FEWEST: usize = 2;
/// Share of what the rate spans within which a piece may be one of a rest.
const SLOW: f64 = 1e-3;
/// Deviations up to which a piece stands where the outermost one does.
const STILL: f64 = 5.0;
/// Pieces that wander together, where the noise is no higher than a gyroscope's band.
const TOGETHER: f64 = 2.0;
/// Deviations from which a trial is said to end elsewhere.
const TOLD: f64 = 5.0;
/// Angle between the ends that is none, rad: what a lag leaves out at a record's end, and a sum in place of an integral.
const LEAST_RAD: f64 = 1e-6;

/// What the ends say of a trial that ends at another angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Elsewhere {
    /// Mean of the gyroscope's reading over the record, against that at rest, rad/s.
    pub mean_rate_rad_s: Known,
    /// By how much the channels stand higher at the end than at the beginning, V; of the standard, behind them, nothing.
    pub step: [f64; LIMBS + 1],
}

/// None for a trial that ends where it began, as far as it shows, or has no rest at either end. `variance` is that of the samples' noise.
pub(super) fn look(
    record: &Record<'_>,
    grid: &Grid,
    variance: &[f64; LIMBS + 1],
) -> Option<Elsewhere> {
    if record.drive != Drive::Angular {
        return None;
    }
    let rate = record.standard;
    let piece = ((PIECE_S / grid.step_s) as usize).max(1);
    let white = variance[LIMBS] / piece as f64;
    let (low, high) = (rate.iter()).fold((rate[0], rate[0]), |(l, h), r| (l.min(*r), h.max(*r)));
    let slow = SLOW * (high - low);
    let (first, first_scatter) = rest(rate.chunks_exact(piece), white, slow)?;
    let (last, last_scatter) = rest(rate.rchunks_exact(piece), white, slow)?;
    let (first, last) = (0..first * piece, rate.len() - last * piece..rate.len());
    let counts = [first.len(), last.len()].map(|count| count as f64);
    let [before, after] = [&first, &last].map(|range| mean(range, |n| rate[n]));
    let all = mean(&(0..rate.len()), |n| rate[n]);
    let shorter = 1.0 / counts[0] + 1.0 / counts[1];
    // A zero that wanders does so between the ends, too.
    let wander = 0.5 * (after - before);
    let noise = variance[LIMBS] * (1.0 / rate.len() as f64 + 0.25 * shorter);
    let scatter = 0.25 * (first_scatter + last_scatter);
    let mean_rate_rad_s = Known {
        value: all - 0.5 * (before + after),
        deviation: sqrt(noise + scatter + wander * wander),
    };
    let step: [f64; LIMBS + 1] = core::array::from_fn(|channel| {
        let at = |n: usize| record.voltage_v[n].get(channel).copied().unwrap_or(0.0);
        mean(&last, at) - mean(&first, at)
    });
    let duration_s = rate.len() as f64 * grid.step_s;
    let angle = [mean_rate_rad_s.value, mean_rate_rad_s.deviation].map(|r| r.abs() * duration_s);
    let by_rate = angle[0] > (TOLD * angle[1]).max(LEAST_RAD);
    // Upright gravity turns only by what the axis is off the plumb line: zeros that creep are more than that.
    let by_gravity = turns(record.direction_ground, record.gravity_ground_m_s2)
        && (0..LIMBS).any(|limb| step[limb].abs() > TOLD * sqrt(variance[limb] * shorter));
    (by_rate || by_gravity).then_some(Elsewhere {
        mean_rate_rad_s,
        step,
    })
}

/// Whether gravity turns in a sensor that turns about this direction.
pub(super) fn turns(direction: DVec3, gravity: DVec3) -> bool {
    gravity.cross(direction.normalize()).length() > TURNS * gravity.length()
}

/// Pieces from an end on in which the standard stands still, and the variance of their mean by what they scatter. `white` is that of one piece
/// by the samples' own noise: a gyroscope of a narrow band shows more at rest, so that the half that lies farthest from the motion is asked.
fn rest<'a>(
    pieces: impl Iterator<Item = &'a [f64]>,
    white: f64,
    slow: f64,
) -> Option<(usize, f64)> {
    let levels: Vec<f64> = pieces
        .map(|piece| mean(&(0..piece.len()), |n| piece[n]))
        .collect();
    let outermost = *levels.first()?;
    let within = |away: f64| {
        let beside = levels.iter().skip(1);
        beside
            .take_while(|level| (*level - outermost).abs() <= away)
            .count()
    };
    let still = |variance: f64| STILL * sqrt(2.0 * variance);
    let far = &levels[..within(still(white).max(slow)).div_ceil(2)];
    let middle = mean(&(0..far.len()), |n| far[n]);
    let squares: f64 = far
        .iter()
        .map(|level| (level - middle) * (level - middle))
        .sum();
    let scatter = squares / far.len().saturating_sub(1).max(1) as f64;
    // The outermost one is counted in place of the one beside the motion.
    let count = within(still(white.max(scatter)));
    (count >= FEWEST).then_some((count, TOGETHER * scatter / count as f64))
}

fn mean(range: &Range<usize>, at: impl Fn(usize) -> f64) -> f64 {
    range.clone().map(at).sum::<f64>() / range.len() as f64
}
