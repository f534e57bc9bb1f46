//! Comparisons that leave a row of evidence behind and never let NaN pass. With `SIXAXIS_RESIDUALS` set they print every
//! residual, passed or not (`cargo test -- --nocapture`).

use std::fmt::Debug;

use crate::evidence::Row;
use crate::tolerance::{NEGATIVE_CONTROL, Tolerance};

/// Asserts that an error is within its limit.
///
/// # Panics
/// If it is not, or is NaN.
pub fn within(what: &str, error: f64, tolerance: Tolerance) {
    Row::new(what, error, tolerance.limit).judge(tolerance);
}

/// Asserts that a deliberately broken variant fails by a wide margin.
///
/// # Panics
/// If it passes, nearly passes, or is NaN.
pub fn fails_clearly(what: &str, error: f64, tolerance: Tolerance) {
    assert!(
        error >= NEGATIVE_CONTROL * tolerance.limit,
        "{what}: broken on purpose, yet its error {error:.3e} is not {NEGATIVE_CONTROL} times the limit {:.3e}",
        tolerance.limit
    );
}

/// Largest of a set of numbers; NaN if any is.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| {
        if b.is_nan() || a.is_nan() {
            f64::NAN
        } else {
            a.max(b.abs())
        }
    })
}

/// True if no number anywhere in `answer` is NaN or infinite. Read from what `Debug` prints, so that no field, private
/// or added later, is left out.
pub fn all_finite(answer: &impl Debug) -> bool {
    let text = format!("{answer:?}");
    !text
        .split(|c: char| !c.is_alphanumeric())
        .any(|word| word == "NaN" || word == "inf")
}
