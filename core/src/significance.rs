//! How far chance goes: tails of the normal and of the chi-square distribution, and the limits that they set.
//!
//! A limit is given by the probability of what lies beyond it, not of what lies below: a false alarm once in a month is a tail of
//! 1e-11, which one minus itself would round to some hundred thousandths of its size.

use statrs::function::gamma::checked_gamma_ur;

use crate::error::{Result, require};

/// Two-sided 95 % of a normal distribution, in standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Halvings that bring any bracket of f64 to neighbours.
const HALVINGS: usize = 1100;

/// Probability that a chi-square variable exceeds `value`.
///
/// # Errors
/// [`crate::Error::OutOfRange`] without a degree of freedom or for a value that is not a number.
pub fn chi_square_tail(value: f64, degrees_of_freedom: usize) -> Result<f64> {
    require(
        degrees_of_freedom > 0,
        "degrees_of_freedom",
        0.0,
        "at least one",
    )?;
    require(!value.is_nan(), "chi square", value, "a number")?;
    if value <= 0.0 {
        return Ok(1.0);
    }
    Ok(checked_gamma_ur(0.5 * degrees_of_freedom as f64, 0.5 * value).unwrap_or(0.0))
}

/// Limit that a chi-square variable exceeds with probability `tail`.
///
/// # Errors
/// [`crate::Error::OutOfRange`] unless `tail` is between 0 and 1, and without a degree of freedom.
pub fn chi_square_limit(tail: f64, degrees_of_freedom: usize) -> Result<f64> {
    check(tail)?;
    let n = degrees_of_freedom as f64;
    let mut low = 0.0;
    let mut high = n + 1.0;
    while chi_square_tail(high, degrees_of_freedom)? > tail && high < f64::MAX / 4.0 {
        low = high;
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if chi_square_tail(middle, degrees_of_freedom)? > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(high)
}

fn check(tail: f64) -> Result<()> {
    require(
        tail > 0.0 && tail < 1.0,
        "probability",
        tail,
        "between 0 and 1",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_scipy() {
        let near = |found: Result<f64>, expected: f64, digits: f64| {
            let found = found.expect("a limit");
            assert!(
                (found / expected - 1.0).abs() < digits,
                "{found} {expected}"
            );
        };
        near(chi_square_limit(0.05, 1), NORMAL_95 * NORMAL_95, 1e-13);
        near(chi_square_limit(0.05, 3), 7.814_727_903_251_178, 1e-13);
        near(chi_square_limit(0.01, 8), 20.090_235_029_663_233, 1e-13);
        near(chi_square_limit(0.001, 100), 149.449_252_779_038_9, 1e-13);
        // Two degrees of freedom: exp(-x/2).
        for tail in [0.9, 0.5, 1e-3, 1e-11, 1e-200] {
            near(chi_square_limit(tail, 2), -2.0 * tail.ln(), 1e-12);
        }
    }

    #[test]
    fn what_is_no_probability_is_refused() {
        for tail in [0.0, 1.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(chi_square_limit(tail, 3).is_err());
        }
        assert!(chi_square_limit(0.5, 0).is_err());
        assert!(chi_square_tail(f64::NAN, 3).is_err());
        assert_eq!(chi_square_tail(f64::INFINITY, 3), Ok(0.0));
    }
}
