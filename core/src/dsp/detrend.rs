//! Removing offset and trend.
//!
//! Each is a projection: what it leaves, it leaves again. The trend is a line between two rests, because the least-squares line of a
//! motion is not zero and would be taken for drift.

use super::{check_answer, check_finite};
use crate::error::{Result, require_samples};

/// Takes the mean off and returns it. Equals SciPy's `detrend(type="constant")` to 2e-15 of the peak (measured; test
/// `ref_scipy_detrend` allows more).
///
/// # Errors
/// [`crate::Error::TooFewSamples`] for an empty series, [`crate::Error::NotFinite`], [`crate::Error::Overflow`].
pub fn constant(series: &mut [f64]) -> Result<f64> {
    require_samples("detrending", 1, series.len())?;
    check_finite(series)?;
    let mean = mean(series);
    check_answer("detrending", series.iter().map(|x| x - mean))?;
    for x in series.iter_mut() {
        *x -= mean;
    }
    Ok(mean)
}

/// Takes off the line through the means of the first and of the last `rest` samples, which were taken at rest, and
/// returns it as (value at the first sample, change per sample). The motion between the rests has no influence on
/// the line, as it has on a least-squares line. A rest of 0 samples is taken as 1.
///
/// # Errors
/// [`crate::Error::TooFewSamples`] unless two rests fit, [`crate::Error::NotFinite`], [`crate::Error::Overflow`].
pub fn rest_to_rest_trend(series: &mut [f64], rest: usize) -> Result<(f64, f64)> {
    require_samples(
        "detrending between rests",
        rest.max(1).saturating_mul(2),
        series.len(),
    )?;
    check_finite(series)?;
    let n = series.len();
    let rest = rest.max(1);
    let (before, after) = (mean(&series[..rest]), mean(&series[n - rest..]));
    let slope = if n > rest {
        (after - before) / (n - rest) as f64
    } else {
        0.0
    };
    let start = before - slope * (rest - 1) as f64 / 2.0;
    subtract_line(series, start, slope)?;
    Ok((start, slope))
}

fn subtract_line(series: &mut [f64], start: f64, slope: f64) -> Result<()> {
    let less_line = |(i, x): (usize, &f64)| x - (start + slope * i as f64);
    check_answer("detrending", series.iter().enumerate().map(less_line))?;
    for (i, x) in series.iter_mut().enumerate() {
        *x -= start + slope * i as f64;
    }
    Ok(())
}

fn mean(series: &[f64]) -> f64 {
    // Counted from the first sample, so that a large offset costs no digits.
    let origin = series[0];
    origin + series.iter().map(|x| x - origin).sum::<f64>() / series.len() as f64
}
