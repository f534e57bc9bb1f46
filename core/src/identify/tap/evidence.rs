//! Tests of a fit's residuals: whether they are noise.

use alloc::vec::Vec;

use super::fit::{Fitted, Window};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Ratio of variances from which the beginning is no free decay yet: five standard errors for 25 samples of nine channels.
const STILL_DRIVEN: f64 = 1.5;
/// Correlation of neighbouring residuals that noise does not reach, not even behind an anti-aliasing filter.
const COLOURED: f64 = 0.5;
/// Residual over signal at the beginning below which its shape does not matter.
const NEGLIGIBLE: f64 = 3e-3;

/// Statistics of the residuals.
pub(super) struct Evidence {
    /// Variance at the beginning over that of the second half.
    pub early_over_late: f64,
    /// Residual over signal at the beginning.
    pub residual_over_signal: f64,
    /// Correlation of neighbours.
    pub correlation: f64,
}

impl Evidence {
    pub fn of(window: &Window, fitted: &Fitted, level_v: &[f64; LIMBS], beginning: usize) -> Self {
        let residuals = window.residuals_v(fitted);
        let weighted: Vec<[f64; LIMBS]> = residuals
            .iter()
            .map(|row| core::array::from_fn(|i| row[i] / window.noise_v[i]))
            .collect();
        let mean = |rows: &[[f64; LIMBS]]| {
            rows.iter().flatten().map(|r| r * r).sum::<f64>() / rows.len().max(1) as f64
        };
        let beginning = beginning.min(weighted.len());
        let products: f64 = weighted
            .windows(2)
            .map(|pair| (0..LIMBS).map(|i| pair[0][i] * pair[1][i]).sum::<f64>())
            .sum();
        let squares: f64 = weighted.iter().flatten().map(|r| r * r).sum();
        let left: f64 = residuals[..beginning].iter().flatten().map(|r| r * r).sum();
        let signal: f64 = window.voltage_v[..beginning]
            .iter()
            .map(|row| {
                (0..LIMBS)
                    .map(|i| (row[i] - level_v[i]) * (row[i] - level_v[i]))
                    .sum::<f64>()
            })
            .sum();
        Self {
            early_over_late: mean(&weighted[..beginning]) / mean(&weighted[weighted.len() / 2..]),
            residual_over_signal: sqrt(left / signal),
            correlation: products / squares,
        }
    }

    fn matters(&self) -> bool {
        self.residual_over_signal > NEGLIGIBLE
    }

    /// The beginning is no free decay yet.
    pub fn still_driven(&self) -> bool {
        self.matters() && self.early_over_late > STILL_DRIVEN
    }

    /// The residuals are not noise.
    pub fn coloured(&self) -> bool {
        self.matters() && self.correlation > COLOURED
    }
}
