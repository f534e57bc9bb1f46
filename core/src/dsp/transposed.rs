//! The linear stages read backwards: how much each raw sample weighs in a sum over the samples that a stage makes of them.
//!
//! A stage that is linear in its record is a matrix L, whose row k says what output sample k is made of. Whoever forms
//! sum h_k (L x)_k of an output, as least squares does, forms (L^T h) . x of the raw record: L^T h is the *influence* of
//! every raw sample, and white noise of deviation sigma in the record leaves sigma |L^T h| in the sum. These are the
//! transposes, exact to the last sample: ends, extensions and settled states included (tests `inv_..._transposed`:
//! L a . b = a . L^T b).
//!
//! Rejection of wild samples is not linear and has none.

use alloc::vec;
use alloc::vec::Vec;

use super::butterworth::Section;
use super::continued::Continuation;
use super::differentiate::Differentiator;
use super::zero_phase::padding;
use super::{check_answer, check_finite};
use crate::error::{Result, require_positive, require_samples};

/// Transpose of [`super::zero_phase::zero_phase`], in place. Away from the ends it is that filter itself, which has no phase.
///
/// # Errors
/// Those of `zero_phase`.
pub fn zero_phase(sections: &[Section], weights: &mut [f64]) -> Result<()> {
    let pad = padding(sections);
    require_samples("zero-phase filter", pad + 1, weights.len())?;
    check_finite(weights)?;
    let n = weights.len();
    let mut extended = vec![0.0; n + 2 * pad];
    extended[pad..pad + n].copy_from_slice(weights);
    for _ in 0..2 {
        extended.reverse();
        for section in sections.iter().rev() {
            pass(section, &mut extended);
        }
    }
    let (head, rest) = extended.split_at(pad);
    let (middle, tail) = rest.split_at(n);
    weights.copy_from_slice(middle);
    // Odd extension: sample -i is 2 first - x_i, sample n - 1 + i is 2 last - x_(n-1-i).
    for i in 1..=pad {
        weights[0] += 2.0 * head[pad - i];
        weights[i] -= head[pad - i];
        weights[n - 1] += 2.0 * tail[i - 1];
        weights[n - 1 - i] -= tail[i - 1];
    }
    check_answer("zero-phase filter", weights.iter().copied())
}

/// Transpose of [`super::continued::zero_phase`], in place.
///
/// # Errors
/// Those of `continued::zero_phase`.
pub fn continued_zero_phase(sections: &[Section], weights: &mut [f64]) -> Result<()> {
    require_samples("zero-phase filter", padding(sections) + 1, weights.len())?;
    let n = weights.len();
    let continuation = Continuation::of_record(sections, n);
    let extent = continuation.extent;
    let mut extended = vec![0.0; n + 2 * extent];
    extended[extent..extent + n].copy_from_slice(weights);
    zero_phase(sections, &mut extended)?;
    let (head, rest) = extended.split_at(extent);
    let (middle, tail) = rest.split_at(n);
    weights.copy_from_slice(middle);
    // Beyond an end lies twice the fit less the record turned round.
    for (w, h) in weights[1..].iter_mut().zip(head.iter().rev()) {
        *w -= h;
    }
    for (w, t) in weights[..n - 1].iter_mut().rev().zip(tail) {
        *w -= t;
    }
    let (before, after): (f64, f64) = (head.iter().sum(), tail.iter().sum());
    for (i, of_fit) in continuation.weights().enumerate() {
        weights[i] += 2.0 * before * of_fit;
        weights[n - 1 - i] += 2.0 * after * of_fit;
    }
    check_answer("zero-phase filter", weights.iter().copied())
}

/// One section that starts settled at its first sample, transposed: the recursion of its memory run from the last sample to
/// the first, where what the memory began with falls to the first sample.
fn pass(section: &Section, weights: &mut [f64]) {
    let Section { b, a } = section;
    let mut memory = [0.0; 2];
    for w in weights.iter_mut().rev() {
        let output = *w - a[0] * memory[0] - a[1] * memory[1];
        *w = b[0] * output + b[1] * memory[0] + b[2] * memory[1];
        memory = [output, memory[0]];
    }
    let settled = section.settled(1.0);
    if let Some(first) = weights.first_mut() {
        *first += settled[0] * memory[0] + settled[1] * memory[1];
    }
}

/// Transpose of [`Differentiator::derivative`]. Away from the ends it is minus that operation, whose weights are odd.
///
/// # Errors
/// Those of `derivative`.
pub fn derivative(differentiator: &Differentiator, weights: &[f64]) -> Result<Vec<f64>> {
    let half = differentiator.half_width;
    let width = 2 * half + 1;
    require_samples("differentiator", width, weights.len())?;
    check_finite(weights)?;
    let n = weights.len();
    let rate = differentiator.sample_rate_hz;
    let mut influence = vec![0.0; n];
    for (start, w) in weights[half..n - half].iter().enumerate() {
        let window = &mut influence[start..start + width];
        for (x, slope) in window.iter_mut().zip(&differentiator.middle_slope) {
            *x += slope * w * rate;
        }
    }
    // At the ends the first and the last window's polynomial stands for all samples beyond its middle.
    let (first, last) = (0, n - width);
    let head = (0..half).map(|place| (first, place));
    let tail = (half + 1..width).map(|place| (last, place));
    for (start, place) in head.chain(tail) {
        let w = weights[start + place] * rate;
        let window = &mut influence[start..start + width];
        for (x, slope) in window.iter_mut().zip(differentiator.slope_weights(place)) {
            *x += slope * w;
        }
    }
    check_answer("differentiator", influence.iter().copied())?;
    Ok(influence)
}

/// Transpose of [`super::lag::undo_low_pass`].
///
/// # Errors
/// Those of `undo_low_pass`.
pub fn undo_low_pass(
    weights: &[f64],
    corner_hz: f64,
    differentiator: &Differentiator,
) -> Result<Vec<f64>> {
    require_positive("corner_hz", corner_hz)?;
    let time_constant_s = 1.0 / (core::f64::consts::TAU * corner_hz);
    let mut influence = derivative(differentiator, weights)?;
    for (x, w) in influence.iter_mut().zip(weights) {
        *x = w + time_constant_s * *x;
    }
    check_answer("undone low-pass", influence.iter().copied())?;
    Ok(influence)
}

/// Transpose of [`super::lag::undo_high_pass`]: the same recursion from the last sample to the first, as of anything that
/// is from rest and the same at all times.
///
/// # Errors
/// Those of `undo_high_pass`.
pub fn undo_high_pass(weights: &[f64], corner_hz: f64, sample_rate_hz: f64) -> Result<Vec<f64>> {
    let backwards: Vec<f64> = weights.iter().rev().copied().collect();
    let mut influence = super::lag::undo_high_pass(&backwards, corner_hz, sample_rate_hz)?;
    influence.reverse();
    Ok(influence)
}

/// Transpose of [`super::detrend::rest_to_rest_trend`], in place.
///
/// # Errors
/// Those of `rest_to_rest_trend`.
pub fn rest_to_rest_trend(weights: &mut [f64], rest: usize) -> Result<()> {
    require_samples(
        "detrending between rests",
        rest.max(1).saturating_mul(2),
        weights.len(),
    )?;
    check_finite(weights)?;
    let n = weights.len();
    let rest = rest.max(1);
    let sum: f64 = weights.iter().sum();
    let moment: f64 = weights.iter().enumerate().map(|(i, w)| i as f64 * w).sum();
    // The line is (mean before) (1 - slope's lever) + (mean after) (slope's lever), sample by sample.
    let of_slope = moment - sum * (rest - 1) as f64 / 2.0;
    let after = if n > rest {
        of_slope / (n - rest) as f64
    } else {
        0.0
    };
    let before = sum - after;
    for w in &mut weights[..rest] {
        *w -= before / rest as f64;
    }
    for w in &mut weights[n - rest..] {
        *w -= after / rest as f64;
    }
    check_answer("detrending", weights.iter().copied())
}
