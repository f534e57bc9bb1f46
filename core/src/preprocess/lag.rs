//! First-order instruments: what they do to a signal, and how to undo it.
//!
//! A first-order low-pass (a gyroscope of given bandwidth) or high-pass (a charge amplifier) is simulated exactly for
//! an input that is linear between samples (first-order hold), and inverted by the very same recursion, so that
//! compensating a simulated instrument returns its input to rounding.

use alloc::vec::Vec;

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

    /// The input that made the instrument show `output` next: inverse of [`Self::step`].
    pub fn undo_step(&mut self, output: f64) -> f64 {
        let free = self.pole * self.state + self.weight_before * self.before;
        let input = if self.high_pass {
            (output + free) / (1.0 - self.weight_now)
        } else {
            (output - free) / self.weight_now
        };
        self.state = free + self.weight_now * input;
        self.before = input;
        input
    }

    /// A whole record undone, from rest.
    ///
    /// Undoing a low-pass amplifies noise in proportion to frequency: smooth the record before or after. Undoing a
    /// high-pass integrates, so an offset left in the record grows as offset times t/tau.
    #[must_use]
    pub fn undo(mut self, record: &[f64]) -> Vec<f64> {
        record.iter().map(|&y| self.undo_step(y)).collect()
    }
}
