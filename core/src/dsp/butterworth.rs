//! Butterworth low-passes as second-order sections, by the bilinear transform with prewarped corner.
//!
//! Sections, not one long fraction: at order 8 and a corner of 5e-4 of the sample rate the coefficients of the
//! fraction cancel to nothing, those of a section do not. What cancels in a section moves its corner by about
//! 1e-17 (sample rate/corner)^2, relative (test `inv_rounding_moves_the_corner_by_its_square`): 4e-11 at 5e-4, 1e-5 at
//! 1e-6, the lowest offered.

use alloc::vec::Vec;

use crate::error::{Result, require, require_positive};
use crate::float::{sin_cos, tan};

/// Highest order offered.
pub const MAX_ORDER: usize = 10;

/// Lowest corner offered, of the sample rate: a thousandth of it the sections' static gain would be 0/0.
pub const LOWEST_CORNER: f64 = 1e-6;

/// One section in direct form II transposed: b over a with a0 = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator.
    pub b: [f64; 3],
    /// Denominator a1, a2.
    pub a: [f64; 2],
}

impl Section {
    /// Output of one step; `state` is the section's memory. Equals SciPy's `sosfilt` of one section.
    pub fn step(&self, state: &mut [f64; 2], input: f64) -> f64 {
        let output = self.b[0] * input + state[0];
        state[0] = self.b[1] * input - self.a[0] * output + state[1];
        state[1] = self.b[2] * input - self.a[1] * output;
        output
    }

    /// Gain at zero frequency.
    #[must_use]
    pub fn static_gain(&self) -> f64 {
        (self.b[0] + self.b[1] + self.b[2]) / (1.0 + self.a[0] + self.a[1])
    }

    /// Memory after an endless constant input.
    #[must_use]
    pub fn settled(&self, input: f64) -> [f64; 2] {
        let output = self.static_gain() * input;
        let second = self.b[2] * input - self.a[1] * output;
        [self.b[1] * input - self.a[0] * output + second, second]
    }
}

/// Low-pass of the given order with its -3 dB corner at `corner_hz`: the same filter as SciPy's
/// `butter(order, corner_hz, output="sos", fs=sample_rate_hz)` up to how the gain is shared among sections.
///
/// Gain at zero frequency 1 to rounding, at any corner; from 0.2 to twice the corner within 4e-10 of the formula for corners from
/// 5e-4 to 0.49 of the sample rate (measured 4e-11; test `inv_gain_is_butterworths`). Towards either end of what a corner may be, rounding moves it by
/// 1e-17 over the square of its distance from there, over the sample rate: at 0.4999999 the gain is 3e-4 off. A single pass delays; [`super::zero_phase`] does not.
///
/// # Errors
/// [`crate::Error::OutOfRange`] for an order outside 1..=10, a corner below [`LOWEST_CORNER`] or not below half the
/// sample rate, a sample rate that is not positive and finite.
pub fn low_pass(order: usize, corner_hz: f64, sample_rate_hz: f64) -> Result<Vec<Section>> {
    require(
        (1..=MAX_ORDER).contains(&order),
        "order",
        order as f64,
        "from 1 to 10",
    )?;
    require_positive("sample_rate_hz", sample_rate_hz)?;
    // As a share, because neither times the sample rate nor times pi does a corner of any size stay finite.
    let corner = corner_hz / sample_rate_hz;
    require(
        (LOWEST_CORNER..0.5).contains(&corner),
        "corner_hz",
        corner_hz,
        "from a millionth to below half of the sample rate",
    )?;
    let k = tan(core::f64::consts::PI * corner);
    let mut sections = Vec::with_capacity(order.div_ceil(2));
    for pair in 0..order / 2 {
        // Poles of the prototype at angles (2 pair + 1) pi / (2 order) from the imaginary axis.
        let (sine, _) = sin_cos(core::f64::consts::PI * (2 * pair + 1) as f64 / (2 * order) as f64);
        let damping = 2.0 * sine * k;
        let scale = 1.0 / (1.0 + damping + k * k);
        let a = [2.0 * (k * k - 1.0) * scale, (1.0 - damping + k * k) * scale];
        // From the rounded denominator, not from k: the rounding of a1 and a2 then cannot reach the gain of the
        // pass band, which it otherwise would by 1e-11 for each section at a corner of 5e-4.
        let b0 = (1.0 + a[0] + a[1]) / 4.0;
        let b = [b0, 2.0 * b0, b0];
        sections.push(Section { b, a });
    }
    if order % 2 == 1 {
        let a1 = (k - 1.0) / (k + 1.0);
        let b = [0.5 * (1.0 + a1), 0.5 * (1.0 + a1), 0.0];
        sections.push(Section { b, a: [a1, 0.0] });
    }
    Ok(sections)
}
