//! Step 1: the nine zero drifts, as the mean voltage at rest.

use crate::error::{Error, Result, require_samples};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Batches over which the standard error of the mean is taken: enough for a variance good to a quarter, long enough
/// each that neighbouring batches are independent when the noise is not white.
const BATCHES: usize = 32;
/// Fewer and longer ones, which say whether the noise goes on growing towards low frequencies.
const LONGER: usize = 8;
/// Variance of the mean by the longer batches over that by the shorter ones, all channels together, from which it does: white noise
/// has 1 and scatters by a fifth.
const GROWS: f64 = 1.8;

/// Zero drift of nine channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZeroDrift {
    /// d_i, V.
    pub drift_v: [f64; LIMBS],
    /// Its standard error, V: that by batch means, which holds for noise that is not white, too, or where chance has made it smaller
    /// that of white noise, which the samples give to a thousandth. 32 batches know theirs to an eighth only, and of an interval
    /// of 1.96 of them five times as many errors as of a normal one's would lie beyond twice its width. Where longer batches have a larger
    /// one, as an amplifier's noise below some tenths of a hertz makes it, it is what it grows to with a batch as long as the record.
    pub standard_error_v: [f64; LIMBS],
    /// Standard deviation of a single sample, V.
    pub noise_v: [f64; LIMBS],
    /// Number of samples.
    pub samples: usize,
}

/// d_i from a static record: the mean of each channel (the paper: ten minutes, preprocessed).
///
/// # Errors
/// [`Error::TooFewSamples`] below 32 samples, [`Error::NotFinite`]; [`Error::Overflow`] (sample 0) for a channel whose
/// values are too large to be squared.
pub fn identify(static_voltage_v: &[[f64; LIMBS]]) -> Result<ZeroDrift> {
    let samples = static_voltage_v.len();
    require_samples("zero drift", BATCHES, samples)?;
    let mut result = ZeroDrift {
        drift_v: [0.0; LIMBS],
        standard_error_v: [0.0; LIMBS],
        noise_v: [0.0; LIMBS],
        samples,
    };
    let mut grown = 0.0;
    for channel in 0..LIMBS {
        for (sample, row) in static_voltage_v.iter().enumerate() {
            if !row[channel].is_finite() {
                return Err(Error::NotFinite {
                    channel: channel + 1,
                    sample,
                    value: row[channel],
                });
            }
        }
        // Counting from the first sample keeps the sum small and its rounding far below the drift.
        let origin = static_voltage_v[0][channel];
        let mean_of = |rows: &[[f64; LIMBS]]| {
            rows.iter().map(|row| row[channel] - origin).sum::<f64>() / rows.len() as f64
        };
        let mean = mean_of(static_voltage_v);
        let squares: f64 = static_voltage_v
            .iter()
            .map(|row| {
                let d = row[channel] - origin - mean;
                d * d
            })
            .sum();
        let squares_of = |batches: usize| -> f64 {
            let all = static_voltage_v.chunks_exact(samples / batches);
            all.take(batches)
                .map(|batch| {
                    let d = mean_of(batch) - mean;
                    d * d
                })
                .sum()
        };
        let batch_squares = squares_of(BATCHES);
        result.drift_v[channel] = origin + mean;
        result.noise_v[channel] = sqrt(squares / (samples - 1) as f64);
        let white_v = result.noise_v[channel] / sqrt(samples as f64);
        let by_batches_v = sqrt(batch_squares / (BATCHES * (BATCHES - 1)) as f64);
        result.standard_error_v[channel] = by_batches_v.max(white_v);
        let by_longer_v = sqrt(squares_of(LONGER) / (LONGER * (LONGER - 1)) as f64);
        let ratio = by_longer_v / by_batches_v;
        grown += if ratio.is_finite() {
            ratio * ratio
        } else {
            1.0
        } / LIMBS as f64;
        if !(result.drift_v[channel] + squares + batch_squares).is_finite() {
            return Err(Error::Overflow {
                what: "zero drift",
                channel: channel + 1,
                sample: 0,
            });
        }
    }
    if grown > GROWS {
        // The variance grows by this from 32 batches to 8, and no faster than a drift's; from 8 to 2 by it once more, and then by its root.
        let longer = grown.min((BATCHES / LONGER).pow(2) as f64);
        for error_v in &mut result.standard_error_v {
            *error_v *= longer * sqrt(sqrt(longer));
        }
    }
    Ok(result)
}
