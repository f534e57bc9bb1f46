//! A share of counted cases with its interval.

use serde::{Deserialize, Serialize};
use statrs::function::beta::inv_beta_reg;

/// Probability beyond either end of the interval.
const TAIL: f64 = 0.025;

/// So many of so many, and between which shares the true one lies at 95 %, after Clopper and Pearson.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Cases.
    pub count: usize,
    /// Of so many.
    pub of: usize,
    /// Lower end of the interval.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
}

impl Share {
    /// Of counts. Of no cases at all everything is possible.
    ///
    /// The ends are quantiles of beta distributions: TAIL of B(k, n - k + 1) below, 1 - TAIL of B(k + 1, n - k) above.
    pub fn new(count: usize, of: usize) -> Self {
        let (k, n) = (count as f64, of as f64);
        Self {
            count,
            of,
            low_95: if count == 0 {
                0.0
            } else {
                inv_beta_reg(k, n - k + 1.0, TAIL)
            },
            high_95: if count >= of {
                1.0
            } else {
                inv_beta_reg(k + 1.0, n - k, 1.0 - TAIL)
            },
        }
    }

    /// Of the items that are so.
    pub fn of<T>(items: &[T], so: impl Fn(&T) -> bool) -> Self {
        Self::new(items.iter().filter(|item| so(item)).count(), items.len())
    }

    /// The share; NaN of nothing.
    pub fn value(&self) -> f64 {
        self.count as f64 / self.of as f64
    }
}
