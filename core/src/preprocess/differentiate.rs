//! Smoothing differentiator: the slope of a polynomial fitted to each sample's neighbourhood (Savitzky and Golay).

use alloc::vec;
use alloc::vec::Vec;

use super::{check_finite, check_length};
use crate::error::{Error, Result};
use crate::scalar::sin_cos;

/// Highest polynomial order offered.
pub const MAX_ORDER: usize = 6;

/// A differentiator: window of `2 half_width + 1` samples, polynomial of the given order.
#[derive(Debug, Clone, PartialEq)]
pub struct Differentiator {
    /// Weights of the first derivative per sample, one row for each place in the window.
    weights: Vec<Vec<f64>>,
    half_width: usize,
    sample_rate_hz: f64,
}

impl Differentiator {
    /// Computes the weights by discrete orthogonal polynomials, which stay well conditioned where a Vandermonde matrix
    /// does not.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an order outside 1..=6, a window not longer than the order, or a sample rate that is
    /// not positive and finite.
    pub fn new(half_width: usize, order: usize, sample_rate_hz: f64) -> Result<Self> {
        if !(1..=MAX_ORDER).contains(&order) {
            return Err(Error::OutOfRange {
                name: "order",
                value: order as f64,
                requirement: "from 1 to 6",
            });
        }
        if 2 * half_width < order {
            return Err(Error::OutOfRange {
                name: "half_width",
                value: half_width as f64,
                requirement: "at least half the order",
            });
        }
        if !(sample_rate_hz.is_finite() && sample_rate_hz > 0.0) {
            return Err(Error::OutOfRange {
                name: "sample_rate_hz",
                value: sample_rate_hz,
                requirement: "positive and finite",
            });
        }
        Ok(Self {
            weights: slope_weights(half_width, order),
            half_width,
            sample_rate_hz,
        })
    }

    /// First derivative of a series, per second. Interior samples stand in the middle of their window; the ends take
    /// the slope of the first and last window's polynomial (SciPy's `mode="interp"`).
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] for a series shorter than the window, [`Error::NotFinite`].
    pub fn derivative(&self, series: &[f64]) -> Result<Vec<f64>> {
        let width = 2 * self.half_width + 1;
        check_length("differentiator", width, series.len())?;
        check_finite(series)?;
        let n = series.len();
        Ok((0..n)
            .map(|i| {
                let start = i.saturating_sub(self.half_width).min(n - width);
                let weights = &self.weights[i - start];
                let slope: f64 = weights
                    .iter()
                    .zip(&series[start..start + width])
                    .map(|(w, x)| w * x)
                    .sum();
                slope * self.sample_rate_hz
            })
            .collect())
    }

    /// Gain at a frequency over that of an ideal differentiator, in the interior: 1 at zero frequency.
    #[must_use]
    pub fn relative_gain(&self, frequency_hz: f64) -> f64 {
        let phase = core::f64::consts::TAU * frequency_hz / self.sample_rate_hz;
        if phase == 0.0 {
            return 1.0;
        }
        let weights = &self.weights[self.half_width];
        let sum: f64 = weights
            .iter()
            .enumerate()
            .map(|(i, w)| w * sin_cos(phase * (i as f64 - self.half_width as f64)).0)
            .sum();
        sum / phase
    }

    /// Lowest frequency at which [`Self::relative_gain`] falls to the root of a half, Hz.
    #[must_use]
    pub fn bandwidth_hz(&self) -> f64 {
        let target = core::f64::consts::FRAC_1_SQRT_2;
        // A scan finds the first crossing, bisection refines it. 4096 points are 32 per lobe of a 257-sample window.
        let step = 0.5 * self.sample_rate_hz / 4096.0;
        let mut high = step;
        while high < 0.5 * self.sample_rate_hz && self.relative_gain(high) > target {
            high += step;
        }
        let mut low = high - step;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.relative_gain(middle) > target {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Weights of the slope, per sample, at each place of the window.
fn slope_weights(half_width: usize, order: usize) -> Vec<Vec<f64>> {
    let width = 2 * half_width + 1;
    let scale = 1.0 / half_width as f64;
    let x: Vec<f64> = (0..width)
        .map(|i| (i as f64 - half_width as f64) * scale)
        .collect();
    let mut weights = vec![vec![0.0; width]; width];
    // Three-term recurrence of polynomials orthogonal on the window and of their derivatives.
    let (mut p0, mut d0) = (vec![0.0; width], vec![0.0; width]);
    let (mut p1, mut d1) = (vec![1.0; width], vec![0.0; width]);
    let mut norm0 = 1.0;
    for degree in 0..=order {
        let norm1: f64 = p1.iter().map(|p| p * p).sum();
        for (place, row) in weights.iter_mut().enumerate() {
            let factor = d1[place] * scale / norm1;
            for (weight, p) in row.iter_mut().zip(&p1) {
                *weight += factor * p;
            }
        }
        let beta = if degree == 0 { 0.0 } else { norm1 / norm0 };
        let p2: Vec<f64> = (0..width).map(|i| x[i] * p1[i] - beta * p0[i]).collect();
        let d2: Vec<f64> = (0..width)
            .map(|i| p1[i] + x[i] * d1[i] - beta * d0[i])
            .collect();
        (p0, d0, p1, d1, norm0) = (p1, d1, p2, d2, norm1);
    }
    weights
}
