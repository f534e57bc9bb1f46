//! Rejection of wild values by the Hampel test: distance from the running median in units of the running median
//! absolute deviation.

use alloc::vec::Vec;

use super::{check_finite, check_length};
use crate::error::{Error, Result};

/// Standard deviation of a normal variable over its median absolute deviation: 1/quantile(3/4).
pub(crate) const SIGMA_PER_MAD: f64 = 1.482_602_218_505_602;

/// Replaces samples further than `sigmas` deviations from the median of the `2 half_width + 1` samples around them by
/// that median, and returns their indices. At the ends the window is cut off.
///
/// Judged on the series as it came in, so that one replacement does not excuse the next. Equals the definition by
/// sorting, sample for sample (test `ref_numpy_hampel`). A straight line is not touched above 1.35 `sigmas`, not even
/// where the window is cut off (test `inv_straight_line_is_untouched`), and up to `half_width` wild samples in one
/// window do not hide each other (test `inv_wild_samples_do_not_hide_each_other`).
///
/// In a window that is constant but for one sample the deviation is zero and any difference is wild; a series that
/// carries no noise at all, or less than a converter step, should not be tested.
///
/// # Errors
/// [`Error::OutOfRange`] for a half width of zero or `sigmas` not positive; [`Error::TooFewSamples`] for a series
/// shorter than one window; [`Error::NotFinite`].
pub fn hampel(series: &mut [f64], half_width: usize, sigmas: f64) -> Result<Vec<usize>> {
    if half_width == 0 {
        return Err(Error::OutOfRange {
            name: "half_width",
            value: 0.0,
            requirement: "at least 1",
        });
    }
    if !(sigmas > 0.0 && sigmas.is_finite()) {
        return Err(Error::OutOfRange {
            name: "sigmas",
            value: sigmas,
            requirement: "positive and finite",
        });
    }
    let width = half_width.saturating_mul(2).saturating_add(1);
    check_length("Hampel test", width, series.len())?;
    check_finite(series)?;
    let original: Vec<f64> = series.to_vec();
    let mut window = Vec::with_capacity(width);
    let mut rejected = Vec::new();
    for (i, sample) in series.iter_mut().enumerate() {
        let from = i.saturating_sub(half_width);
        let to = (i + half_width + 1).min(original.len());
        window.clear();
        window.extend_from_slice(&original[from..to]);
        let median = median(&mut window);
        for x in &mut window {
            *x = (*x - median).abs();
        }
        let deviation = SIGMA_PER_MAD * self::median(&mut window);
        if (*sample - median).abs() > sigmas * deviation {
            *sample = median;
            rejected.push(i);
        }
    }
    Ok(rejected)
}

/// Median; reorders its argument, which must not be empty.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    let (below, &mut upper, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        return upper;
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // In halves: the sum of the two may overflow where their mean does not.
    0.5 * lower + 0.5 * upper
}
