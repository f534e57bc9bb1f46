//! Limits that chance exceeds at a stated rate.

use crate::error::{Error, Result};
use crate::scalar::{exp, sqrt};

/// Terms of the series; it has converged long before for the values that limits have.
const TERMS: usize = 1000;
/// Halvings of the interval in which a limit is sought.
const HALVINGS: usize = 100;

/// Probability that a chi-square variable exceeds `value`, by the power series of the incomplete gamma function.
#[must_use]
pub fn exceeded_by_chance(value: f64, degrees_of_freedom: usize) -> f64 {
    if degrees_of_freedom == 0 || value.is_nan() {
        return f64::NAN;
    }
    if value <= 0.0 {
        return 1.0;
    }
    let half = 0.5 * value;
    // half^a exp(-half)/Gamma(a + 1), a half the degrees of freedom, from a = 0 or 1/2 upwards.
    let odd = degrees_of_freedom % 2 == 1;
    let mut a = if odd { 0.5 } else { 0.0 };
    let mut term = exp(-half);
    if odd {
        term *= 2.0 * sqrt(half / core::f64::consts::PI);
    }
    for _ in 0..degrees_of_freedom / 2 {
        a += 1.0;
        term *= half / a;
    }
    let mut below = 0.0;
    for _ in 0..TERMS {
        below += term;
        a += 1.0;
        term *= half / a;
        if term <= f64::EPSILON * below && a > half {
            break;
        }
    }
    (1.0 - below).max(0.0)
}

/// Value that a chi-square variable exceeds with this probability.
///
/// # Errors
/// [`Error::OutOfRange`] for a probability that is not between 1e-12 and 1, or no degree of freedom.
pub fn limit(false_alarm: f64, degrees_of_freedom: usize) -> Result<f64> {
    if !(1e-12..1.0).contains(&false_alarm) {
        return Err(Error::OutOfRange {
            name: "false_alarm",
            value: false_alarm,
            requirement: "a probability between 1e-12 and 1",
        });
    }
    if degrees_of_freedom == 0 {
        return Err(Error::OutOfRange {
            name: "degrees_of_freedom",
            value: 0.0,
            requirement: "at least 1",
        });
    }
    let (mut low, mut high) = (0.0, 200.0 + 4.0 * degrees_of_freedom as f64);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if exceeded_by_chance(middle, degrees_of_freedom) > false_alarm {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(high)
}

/// Half width of the interval that a normal variable stays in with this probability, in standard deviations.
///
/// # Errors
/// As [`limit`].
pub fn normal_half_width(coverage: f64) -> Result<f64> {
    limit(1.0 - coverage, 1).map(sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From printed tables.
    #[test]
    fn limits_are_the_printed_ones() {
        for (rate, degrees, printed) in [
            (0.05, 1, 3.841),
            (0.01, 1, 6.635),
            (0.05, 8, 15.507),
            (0.01, 8, 20.090),
            (0.05, 7, 14.067),
            (0.001, 5, 20.515),
        ] {
            let found = limit(rate, degrees).expect("a probability");
            assert!((found - printed).abs() < 6e-4, "{rate} {degrees}: {found}");
        }
        assert!((normal_half_width(0.95).expect("a probability") - 1.959_964).abs() < 1e-6);
        assert!(limit(0.0, 3).is_err() && limit(0.1, 0).is_err() && limit(f64::NAN, 1).is_err());
    }
}
