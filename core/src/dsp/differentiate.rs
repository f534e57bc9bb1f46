//! Smoothing differentiator: slope of a polynomial fitted to each sample's neighbourhood (Savitzky and Golay).
//!
//! The polynomial is held in the polynomials orthonormal on the window (Gram's), whose recurrence is known in closed
//! form: no matrix is solved, and order 6 over hundreds of samples costs no digits where powers cost nine.

use alloc::vec::Vec;

use super::{check_answer, check_finite};
use crate::error::{Result, require, require_samples};
use crate::float::{sin_cos, sqrt};

/// Highest polynomial order offered.
pub const MAX_ORDER: usize = 6;

/// Largest half width offered: minutes of a slow recording, and weights that still fit into memory.
pub const MAX_HALF_WIDTH: usize = 1 << 16;

/// Coefficients of, or values at one place of, the orthonormal polynomials; zero above the order in use.
type Basis = [f64; MAX_ORDER + 1];

/// A differentiator: window of `2 half_width + 1` samples, polynomial of the given order.
#[derive(Debug, Clone, PartialEq)]
pub struct Differentiator {
    pub(super) half_width: usize,
    pub(super) sample_rate_hz: f64,
    /// The basis at each place of the window.
    values: Vec<Basis>,
    /// Its derivative per sample at each place.
    slopes: Vec<Basis>,
    /// Weights of the slope in the middle of the window.
    pub(super) middle_slope: Vec<f64>,
}

impl Differentiator {
    /// Computes the weights. They are within 1e-15 of their largest of those in exact fractions, up to order 6 over
    /// 101 and order 5 over 401 samples (measured; test `ref_exact_slope_weights` allows more).
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for an order outside 1..=6, a window not longer than the order, a half width above
    /// [`MAX_HALF_WIDTH`], or a sample rate that is not positive and finite (or too small for all digits).
    pub fn new(half_width: usize, order: usize, sample_rate_hz: f64) -> Result<Self> {
        require(
            (1..=MAX_ORDER).contains(&order),
            "order",
            order as f64,
            "from 1 to 6",
        )?;
        require(
            half_width <= MAX_HALF_WIDTH && 2 * half_width >= order,
            "half_width",
            half_width as f64,
            "at least half the order and at most 65536",
        )?;
        require(
            sample_rate_hz.is_normal() && sample_rate_hz > 0.0,
            "sample_rate_hz",
            sample_rate_hz,
            "positive and finite",
        )?;
        let (values, slopes): (Vec<_>, Vec<_>) = (0..=2 * half_width)
            .map(|place| basis_at(place, half_width, order))
            .unzip();
        let middle = &slopes[half_width];
        Ok(Self {
            middle_slope: values.iter().map(|v| dot(middle, v)).collect(),
            half_width,
            sample_rate_hz,
            values,
            slopes,
        })
    }

    /// First derivative of a series, per second. Interior samples stand in the middle of their window; the ends take
    /// the slope of the first and last window's polynomial (SciPy's `savgol_filter(deriv=1, mode="interp")`, met to
    /// 2e-13 of the peak, measured; test `ref_scipy_savitzky_golay` allows more).
    ///
    /// Exact for polynomials up to the order, ends included. In the interior no phase and [`Self::relative_gain`]; at
    /// the ends noise weighs several times as much.
    ///
    /// # Errors
    /// [`crate::Error::TooFewSamples`] for a series shorter than the window, [`crate::Error::NotFinite`], [`crate::Error::Overflow`].
    pub fn derivative(&self, series: &[f64]) -> Result<Vec<f64>> {
        let width = 2 * self.half_width + 1;
        require_samples("differentiator", width, series.len())?;
        check_finite(series)?;
        // Towards the ends the polynomial of the first or the last window is evaluated.
        let first = self.fit(&series[..width]);
        let last = self.fit(&series[series.len() - width..]);
        let head = &self.slopes[..self.half_width];
        let tail = &self.slopes[self.half_width + 1..];
        let interior = series.windows(width).map(|window| {
            self.middle_slope
                .iter()
                .zip(window)
                .map(|(w, x)| w * x)
                .sum()
        });
        let derivative: Vec<f64> = head
            .iter()
            .map(|at| dot(at, &first))
            .chain(interior)
            .chain(tail.iter().map(|at| dot(at, &last)))
            .map(|slope: f64| slope * self.sample_rate_hz)
            .collect();
        check_answer("differentiator", derivative.iter().copied())?;
        Ok(derivative)
    }

    /// Weights of a window's samples in the slope of its polynomial at one place, per sample.
    pub(super) fn slope_weights(&self, place: usize) -> impl Iterator<Item = f64> {
        let at = &self.slopes[place];
        self.values.iter().map(move |values| dot(at, values))
    }

    /// Coefficients of the polynomial fitted to one window.
    fn fit(&self, window: &[f64]) -> Basis {
        let mut coefficients = Basis::default();
        for (values, x) in self.values.iter().zip(window) {
            for (c, v) in coefficients.iter_mut().zip(values) {
                *c += v * x;
            }
        }
        coefficients
    }

    /// Gain of [`Self::derivative`] at a frequency over that of an ideal differentiator, in the interior: 1 at zero
    /// frequency, 0 at half the sample rate.
    #[must_use]
    pub fn relative_gain(&self, frequency_hz: f64) -> f64 {
        let phase = core::f64::consts::TAU * (frequency_hz / self.sample_rate_hz);
        if phase == 0.0 {
            return 1.0;
        }
        let sum: f64 = self
            .middle_slope
            .iter()
            .enumerate()
            .map(|(i, w)| w * sin_cos(phase * (i as f64 - self.half_width as f64)).0)
            .sum();
        sum / phase
    }
}

/// Values and slopes per sample, at one place of the window, of the polynomials orthonormal on it.
///
/// x q_k = b_(k+1) q_(k+1) + b_k q_(k-1) with b_k^2 = k^2 (N^2 - k^2) / (4 (4 k^2 - 1)) over N samples, x counted from
/// the middle one.
fn basis_at(place: usize, half_width: usize, order: usize) -> (Basis, Basis) {
    let samples = (2 * half_width + 1) as f64;
    let x = place as f64 - half_width as f64;
    let (mut values, mut slopes) = (Basis::default(), Basis::default());
    values[0] = 1.0 / sqrt(samples);
    let mut b = 0.0;
    for k in 0..order {
        let next = (k + 1) as f64;
        let square = next * next;
        let b_next = sqrt(square * (samples * samples - square) / (4.0 * (4.0 * square - 1.0)));
        let (value_before, slope_before) = match k {
            0 => (0.0, 0.0),
            _ => (values[k - 1], slopes[k - 1]),
        };
        values[k + 1] = (x * values[k] - b * value_before) / b_next;
        slopes[k + 1] = (values[k] + x * slopes[k] - b * slope_before) / b_next;
        b = b_next;
    }
    (values, slopes)
}

fn dot(a: &Basis, b: &Basis) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
