//! A share of counted cases, and how well so many cases know it.

use serde::{Deserialize, Serialize};
use sixaxis_core::significance::NORMAL_95;

/// A share of cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// The share.
    pub value: f64,
    /// Its binomial standard error, root of p (1 - p)/n; 0 where all cases or none are in it, which [`Self::wilson_95`] is not.
    pub standard_error: f64,
    /// Wilson's 95 % interval.
    pub wilson_95: (f64, f64),
}

impl Share {
    /// Of so many cases so many inside; none of no case.
    pub fn of(inside: u64, cases: u64) -> Option<Self> {
        (cases > 0).then(|| {
            let n = cases as f64;
            let value = inside as f64 / n;
            Self {
                value,
                standard_error: (value * (1.0 - value) / n).sqrt(),
                wilson_95: wilson_95(value, n),
            }
        })
    }
}

/// The shares from which `value` of `n` cases is at most 1.96 standard errors away, each share with its own standard error.
fn wilson_95(value: f64, n: f64) -> (f64, f64) {
    let z2 = NORMAL_95 * NORMAL_95;
    let centre = (value + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = NORMAL_95 / (1.0 + z2 / n) * (value * (1.0 - value) / n + z2 / (4.0 * n * n)).sqrt();
    // Rounding must not leave the share itself outside.
    (
        (centre - half).clamp(0.0, value),
        (centre + half).clamp(value, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::Share;

    #[test]
    fn law_wilson_s_interval_is_the_textbook_s() {
        let interval = |inside, cases| Share::of(inside, cases).expect("cases").wilson_95;
        // Brown, Cai and DasGupta's formula for 1 of 10 by hand: 0.0179, 0.4042.
        let (low, high) = interval(1, 10);
        assert!((low - 0.0179).abs() < 5e-5 && (high - 0.4042).abs() < 5e-5);
        // All of n: n/(n + z^2) to 1; a standard error of 0 says nothing of the 27 in 1000 that may still be outside.
        let (low, high) = interval(100, 100);
        assert!((low - 0.963).abs() < 5e-5 && high == 1.0, "{low} {high}");
        let (low, high) = interval(0, 100);
        assert!(low == 0.0 && (high - 0.037).abs() < 5e-5, "{low} {high}");
        assert_eq!(Share::of(0, 0), None);
    }
}
