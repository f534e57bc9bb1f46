//! Samples at uneven times, on an even clock.

use sixaxis_core::dsp::resample::CubicSpline;

/// A series with jittering time stamps, read on the even clock that starts with the first of them.
pub(super) fn evenly(
    stamps_s: &[f64],
    series: &[f64],
    rate_hz: f64,
) -> sixaxis_core::Result<Vec<f64>> {
    let (Some(first), Some(last)) = (stamps_s.first(), stamps_s.last()) else {
        return Ok(Vec::new());
    };
    let spline = CubicSpline::through(stamps_s, series)?;
    (0..series.len())
        .map(|i| spline.at((first + i as f64 / rate_hz).min(*last)))
        .collect()
}
