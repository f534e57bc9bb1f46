//! First-order instruments: what they do to a signal, and how to undo it.
//!
//! A first-order low-pass (a gyroscope of given bandwidth) or high-pass (a charge amplifier) is simulated exactly for
//! an input that is linear between samples (first-order hold).
//!
//! A signal that is not linear between samples comes out too small by (2 pi f h)^2/12 at frequency f and sample
//! interval h: 8e-5 at 5 Hz and 1 kHz (test `order_hold`).

use alloc::vec::Vec;

use super::check_answer;
use super::differentiate::Differentiator;
use super::stage::{self, Stage};
use crate::error::{Result, require_positive};
use crate::float::exp;

/// A first-order filter, streaming, at rest at first.
///
/// State x follows tau x' = u - x with tau = 1/(2 pi corner); the low-pass shows x, the high-pass u - x. Over a step h
/// with u linear, x1 = x0 + a (u0 - x0) + b (u1 - x0) with r = h/tau, a = (1 - exp(-r))/r - exp(-r),
/// b = 1 - (1 - exp(-r))/r. Equals SciPy's `lsim` to 4e-15 of the peak (measured; test `ref_scipy_first_order` allows more).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder {
    weight_before: f64,
    weight_now: f64,
    high_pass: bool,
    state: f64,
    before: f64,
}

impl FirstOrder {
    fn new(corner_hz: f64, sample_rate_hz: f64, high_pass: bool) -> Result<Self> {
        require_positive("corner_hz", corner_hz)?;
        require_positive("sample_rate_hz", sample_rate_hz)?;
        // h/tau with tau = 1/(2 pi f).
        let ratio = core::f64::consts::TAU * corner_hz / sample_rate_hz;
        let (weight_before, weight_now) = hold_weights(ratio);
        Ok(Self {
            weight_before,
            weight_now,
            high_pass,
            state: 0.0,
            before: 0.0,
        })
    }

    /// Low-pass with its -3 dB corner at `corner_hz`. A constant comes through to 2e-16/r of itself, where
    /// r times the difference no longer moves the state (test `inv_constant_through_a_low_pass`).
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] unless both are positive and finite.
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

    /// What the instrument shows of the next input. The input before the first is taken as zero.
    pub fn step(&mut self, input: f64) -> f64 {
        self.state += self.weight_before * (self.before - self.state)
            + self.weight_now * (input - self.state);
        self.before = input;
        if self.high_pass {
            input - self.state
        } else {
            self.state
        }
    }
}

/// Undoes a first-order high-pass: its input from its output, from rest, by the very recursion of [`FirstOrder::high_pass`]
/// solved for the input, so that a simulated amplifier is undone to rounding, 2e-15 of the peak over 5000 samples (measured; test
/// `inv_undone_high_pass` allows 2e-14).
///
/// x = y + integral of y over tau: an offset left in the record grows as offset times t/tau. Remove drift first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UndoHighPass(FirstOrder);

impl UndoHighPass {
    /// Of the instrument with its -3 dB corner at `corner_hz`.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] unless both frequencies are positive and finite.
    pub fn new(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        FirstOrder::high_pass(corner_hz, sample_rate_hz).map(Self)
    }

    /// The input that makes the instrument show this next.
    pub fn step(&mut self, shown: f64) -> f64 {
        let Self(filter) = self;
        let pulled = filter.weight_before * (filter.before - filter.state);
        let input = filter.state + (shown + pulled) / (1.0 - filter.weight_now);
        filter.step(input);
        input
    }
}

impl Stage for UndoHighPass {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        out.extend(samples.iter().map(|shown| self.step(*shown)));
    }

    fn finish(&mut self, _out: &mut Vec<f64>) -> Result<()> {
        Ok(())
    }
}

/// [`UndoHighPass`] on a whole record.
///
/// # Errors
/// Those of [`UndoHighPass::new`], [`crate::Error::NotFinite`]; [`crate::Error::Overflow`] where the corner lies so far above the sample rate
/// that nothing of the input is left.
pub fn undo_high_pass(record: &[f64], corner_hz: f64, sample_rate_hz: f64) -> Result<Vec<f64>> {
    let mut series = record.to_vec();
    let mut stage = UndoHighPass::new(corner_hz, sample_rate_hz)?;
    stage::whole("undone high-pass", &mut stage, &mut series)?;
    Ok(series)
}

/// Input of a first-order low-pass from its output: u = y + tau y'.
///
/// What is left at frequency f is (1 + i f/corner R) / (1 + i f/corner) with R the differentiator's
/// [`Differentiator::relative_gain`]: nothing where that is 1, the bare instrument where it is 0. A gyroscope of 10 Hz at 1 kHz, window 2 x 10 + 1, order 4, comes back within 2e-5 of the amplitude at 1, 2 and
/// 5 Hz, 1e-4 at the ends, where it had lost 11 % and lagged by 27 degrees (test `inv_undone_gyroscope`; half of that measured); its white
/// noise then weighs 1.8 times as much.
///
/// The recursion of [`FirstOrder::low_pass`] is not solved for its input as the high-pass is: its zero lies at -1 to
/// within a third of h/tau, so the inverse would ring at half the sample rate for as long and raise white noise by
/// 24^(1/2) (tau/h)^(3/2), 300 times for that gyroscope. Noise grows in proportion to frequency all the same, so filter
/// first.
///
/// # Errors
/// [`crate::Error::OutOfRange`] for a corner that is not positive and finite, [`crate::Error::Overflow`] for one of a size that leaves
/// nothing finite; those of [`Differentiator::derivative`].
pub fn undo_low_pass(
    record: &[f64],
    corner_hz: f64,
    differentiator: &Differentiator,
) -> Result<Vec<f64>> {
    require_positive("corner_hz", corner_hz)?;
    let time_constant_s = 1.0 / (core::f64::consts::TAU * corner_hz);
    let slope = differentiator.derivative(record)?;
    let undone: Vec<f64> = record
        .iter()
        .zip(slope)
        .map(|(y, dy)| y + time_constant_s * dy)
        .collect();
    check_answer("undone low-pass", undone.iter().copied())?;
    Ok(undone)
}

/// Weights (a, b) of the input before and the input now, as [`FirstOrder`] defines them.
fn hold_weights(ratio: f64) -> (f64, f64) {
    if ratio > 1.0 {
        let pole = exp(-ratio);
        let mean = (1.0 - pole) / ratio;
        return (mean - pole, 1.0 - mean);
    }
    // The closed form loses eps/r^2, all digits of a slow instrument; the series loses none.
    // b = r/2! - r^2/3! + ..., a = r 1/2! - r^2 2/3! + r^3 3/4! - ...
    // 20 terms: the next is below 1/21!.
    let (mut weight_before, mut weight_now) = (0.0, 0.0);
    let mut term = ratio / 2.0;
    for k in 1..=20 {
        weight_now += term;
        weight_before += f64::from(k) * term;
        term *= -ratio / f64::from(k + 2);
    }
    (weight_before, weight_now)
}
