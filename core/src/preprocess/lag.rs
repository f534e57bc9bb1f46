//! First-order instruments: what they do to a signal, and how to undo it.
//!
//! A first-order low-pass (a gyroscope of given bandwidth) or high-pass (a charge amplifier) is simulated exactly for
//! an input that is linear between samples (first-order hold).

use alloc::vec::Vec;

use super::check_finite;
use super::differentiate::Differentiator;
use crate::error::{Error, Result};
use crate::scalar::exp;

/// A first-order filter, streaming, at rest at first.
///
/// State x follows tau x' = u - x; the low-pass shows x, the high-pass u - x. Over a step h with u linear,
/// x1 = p x0 + a u0 + b u1 with p = exp(-h/tau), a = (1 - p) tau/h - p, b = 1 - (1 - p) tau/h.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder {
    pole: f64,
    weight_before: f64,
    weight_now: f64,
    high_pass: bool,
    state: f64,
    before: f64,
}

impl FirstOrder {
    fn new(corner_hz: f64, sample_rate_hz: f64, high_pass: bool) -> Result<Self> {
        for (name, value) in [("corner_hz", corner_hz), ("sample_rate_hz", sample_rate_hz)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::OutOfRange {
                    name,
                    value,
                    requirement: "positive and finite",
                });
            }
        }
        // h/tau with tau = 1/(2 pi f).
        let ratio = core::f64::consts::TAU * corner_hz / sample_rate_hz;
        let pole = exp(-ratio);
        let mean = (1.0 - pole) / ratio;
        Ok(Self {
            pole,
            weight_before: mean - pole,
            weight_now: 1.0 - mean,
            high_pass,
            state: 0.0,
            before: 0.0,
        })
    }

    /// Low-pass with its -3 dB corner at `corner_hz`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless both are positive and finite.
    pub fn low_pass(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        Self::new(corner_hz, sample_rate_hz, false)
    }

    /// High-pass with its -3 dB corner at `corner_hz`.
    ///
    /// # Errors
    /// As [`Self::low_pass`].
    pub fn high_pass(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        Self::new(corner_hz, sample_rate_hz, true)
    }

    /// What the instrument shows of the next input.
    pub fn step(&mut self, input: f64) -> f64 {
        self.state =
            self.pole * self.state + self.weight_before * self.before + self.weight_now * input;
        self.before = input;
        if self.high_pass {
            input - self.state
        } else {
            self.state
        }
    }
}

/// Input of a first-order high-pass from its output, from rest: the very recursion of [`FirstOrder::high_pass`] solved
/// for the input, so that a simulated amplifier is undone to rounding.
///
/// It integrates: an offset left in the record grows as offset times t/tau. Remove drift first.
///
/// # Errors
/// [`Error::OutOfRange`] unless both frequencies are positive and finite, [`Error::NotFinite`].
pub fn undo_high_pass(record: &[f64], corner_hz: f64, sample_rate_hz: f64) -> Result<Vec<f64>> {
    check_finite(record)?;
    let mut filter = FirstOrder::high_pass(corner_hz, sample_rate_hz)?;
    Ok(record
        .iter()
        .map(|&shown| {
            let free = filter.pole * filter.state + filter.weight_before * filter.before;
            let input = (shown + free) / (1.0 - filter.weight_now);
            filter.step(input);
            input
        })
        .collect())
}

/// Input of a first-order low-pass from its output: u = y + tau y'.
///
/// The recursion of [`FirstOrder::low_pass`] is not solved for its input as the high-pass is: its zero lies at -1 to
/// within a third of h/tau, so the inverse would ring at half the sample rate for as long. The slope comes from a
/// smoothing differentiator instead; noise grows in proportion to frequency all the same, so filter first.
///
/// # Errors
/// [`Error::OutOfRange`] for a corner that is not positive and finite; those of [`Differentiator::derivative`].
pub fn undo_low_pass(
    record: &[f64],
    corner_hz: f64,
    differentiator: &Differentiator,
) -> Result<Vec<f64>> {
    if !(corner_hz.is_finite() && corner_hz > 0.0) {
        return Err(Error::OutOfRange {
            name: "corner_hz",
            value: corner_hz,
            requirement: "positive and finite",
        });
    }
    let time_constant_s = 1.0 / (core::f64::consts::TAU * corner_hz);
    let slope = differentiator.derivative(record)?;
    Ok(record
        .iter()
        .zip(slope)
        .map(|(y, dy)| y + time_constant_s * dy)
        .collect())
}
