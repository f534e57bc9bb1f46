//! Flat tops: where a converter cut a channel off, and where it merely rounded it.

use nalgebra::{DMatrix, DVector};

use super::altered::times_held_evenly;
use crate::series::extent;

/// Equal extreme samples in a row that make a flat top: noise does not repeat itself to the last bit, a converter at its end
/// does. Of a channel that is held for several samples, so many times as many, and below as well.
const FLAT_TOP: usize = 4;
/// Equal extreme samples in a row from which they are a flat top even if no other sample of the recording stands there. Noise repeats its
/// extreme reading three times in a row in one of some million runs of a channel; a converter at its end does so at every crest.
const FLAT_TOP_ALONE: usize = 6;
/// Converter steps by which a top that was merely rounded has fallen as far out again as it is wide, with room for noise.
const ROUNDED_TOP: f64 = 12.0;
/// Samples within a step of a rounded top, on both sides of it, for each sample of the top. A parabola has at least 0.4, and the broad top
/// of a crank with a short rod, which bends with the fourth power, 0.19; what is cut off has left the top at once.
const SHOULDERS: f64 = 0.1;
/// Converter steps above a top that a curve through the samples on either side of it passes at least where the top is cut off: a quiet channel's rounded top
/// hides one.
const HIDDEN: f64 = 4.0;
/// Converter steps by which no rounded top has fallen there, whose curve need not be asked: far overdriven, it has flanks and no curve.
const STEEP: f64 = 500.0;
/// Samples that are few for that curve.
const FEW: usize = 32;
/// Powers of time in that curve, one more than its degree.
const POWERS: usize = 5;
/// A flat top is expected of a channel that spans no more than so many converter steps.
const STEPS_SPANNED: f64 = 64.0;

/// The value at which readings of such a step are cut off.
pub(crate) fn flat_top(series: &[f64], step: f64) -> Option<f64> {
    let (low, high) = extent(series.iter().copied());
    if series.is_empty() || high - low <= STEPS_SPANNED * step {
        return None;
    }
    let held = times_held_evenly(series).unwrap_or(1);
    for extreme in [low, high] {
        let there = series.iter().filter(|u| **u == extreme).count();
        let mut start = None;
        for (i, u) in series.iter().enumerate() {
            match (start, *u == extreme) {
                (None, true) => start = Some(i),
                (Some(from), false) => {
                    let is_long = i - from >= FLAT_TOP * held;
                    let is_alone = i - from == there && there < FLAT_TOP_ALONE * held;
                    if is_long && !is_alone && is_cut_off(series, from, i, step) {
                        return Some(extreme);
                    }
                    start = None;
                }
                _ => {}
            }
        }
    }
    None
}

/// Whether a run of equal extreme samples was cut off rather than rounded off. The top of a sine that stays within half a
/// converter step for n samples has fallen by 4.5 steps n samples further out, and its shoulders stay for a while within the next step;
/// one that was cut has fallen by many and has none, and a curve through what is beside it goes on beyond it. A run at either end of the recording is a rest.
fn is_cut_off(series: &[f64], from: usize, to: usize, step: f64) -> bool {
    let n = to - from;
    if from == 0 || to == series.len() {
        return false;
    }
    let before = series[from.saturating_sub(n)];
    let after = series[(to + n - 1).min(series.len() - 1)];
    let fallen = (before - series[from])
        .abs()
        .min((after - series[from]).abs());
    let beside = |u: &&f64| (**u - series[from]).abs() <= 1.5 * step;
    let shoulders = series[..from].iter().rev().take_while(beside).count()
        + series[to..].iter().take_while(beside).count();
    fallen > ROUNDED_TOP * step
        && (shoulders as f64) < SHOULDERS * n as f64
        && (fallen > STEEP * step
            || hidden(series, from, to).is_none_or(|hidden| hidden > HIDDEN * step))
}

/// How far beyond a flat top the curve through as many samples on either side of it, or twice as many of few, goes at its middle; none where
/// there are too few.
fn hidden(series: &[f64], from: usize, to: usize) -> Option<f64> {
    let n = to - from;
    let side = (2 * n).min(n.max(FEW));
    let sides = (from.saturating_sub(side)..from).chain(to..(to + side).min(series.len()));
    let places: Vec<usize> = sides.collect();
    let middle = 0.5 * (from + to - 1) as f64;
    let curve = DMatrix::from_fn(places.len(), POWERS, |row, power| {
        ((places[row] as f64 - middle) / n as f64).powi(power as i32)
    });
    let beside = DVector::from_iterator(places.len(), places.iter().map(|k| series[*k]));
    let at_middle = curve.svd(true, true).solve(&beside, f64::EPSILON).ok()?[0];
    let beyond = (at_middle - series[from]) * (series[from] - beside.mean()).signum();
    (places.len() > POWERS).then_some(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const RATE_HZ: f64 = 1000.0;
    const STEP_V: f64 = 20.0 / 65_536.0;

    /// Acceleration of a crank with a rod of some five cranks, 1.3 times a second, of 6 V, with noise of a quarter of a step, as 16 bits have it.
    fn crank(seed: u64, cut_v: f64) -> Vec<f64> {
        let mut state = seed;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (phase, bent) = (TAU * unit(), 0.13 + 0.04 * unit());
        (0..4000)
            .map(|k| {
                let angle = TAU * 1.3 * f64::from(k) / RATE_HZ + phase;
                let noise = 0.35 * STEP_V * ((0..12).map(|_| unit()).sum::<f64>() - 6.0);
                let volts = 6.0 * (angle.cos() + bent * (2.0 * angle).cos()) + noise;
                (volts.clamp(-cut_v, cut_v) / STEP_V).round() * STEP_V
            })
            .collect()
    }

    #[test]
    fn a_quiet_converters_rounded_tops_are_not_cut_off() {
        let flat = |seed, cut_v| flat_top(&crank(seed, cut_v), STEP_V).is_some();
        let accused = (0..20_000)
            .filter(|seed| flat(*seed, f64::INFINITY))
            .count();
        assert_eq!(accused, 0);
        let named = (0..300).filter(|seed| flat(*seed, 4.5)).count();
        assert_eq!(named, 300);
        // Ten times what the converter takes.
        let named = (0..30).filter(|seed| flat(*seed, 0.6)).count();
        assert_eq!(named, 30);
    }
}
