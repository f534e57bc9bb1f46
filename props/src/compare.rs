//! Comparisons that leave a row of evidence behind and never let NaN pass. With `SIXAXIS_RESIDUALS` set they print every
//! residual, passed or not (`cargo test -- --nocapture`).

use std::fmt::Debug;

use crate::evidence::Row;
use crate::tolerance::{NEGATIVE_CONTROL, Tolerance};

/// Asserts that an error is within its limit.
///
/// # Panics
/// If it is not, is NaN or negative.
pub fn within(what: impl Into<String>, error: f64, tolerance: Tolerance) {
    Row::new(what, error, tolerance).judge();
}

/// Asserts that a deliberately broken variant fails by a wide margin, [`NEGATIVE_CONTROL`] limits.
///
/// # Panics
/// If it passes, nearly passes, or is NaN.
pub fn fails_clearly(what: impl Into<String>, error: f64, tolerance: Tolerance) {
    Row::new(what, error, tolerance)
        .control(NEGATIVE_CONTROL)
        .judge();
}

/// The larger of two numbers; NaN if either is.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Largest magnitude of a set of numbers; 0 of none, NaN if any is.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, worse)
}

/// True if no number anywhere in `answer` is NaN or infinite. Read from what `Debug` prints, so that no field, private
/// or added later, is left out.
pub fn all_finite(answer: &impl Debug) -> bool {
    let text = format!("{answer:?}");
    !text
        .split(|c: char| !c.is_alphanumeric())
        .any(|word| word == "NaN" || word == "inf")
}
