//! The result of self-calibration: ratios of nine scale factors, their covariance, and tests of the model.

use super::PerLimbs;
use crate::error::{Result, require};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::redundancy::parity::ROWS;
use crate::significance::chi_square_tail;

/// When ratios count as observable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest standard deviation of any combination of ln ratios (of unit length). The noise itself counts as excitation of
    /// the fourth root of the number of blocks: at a hundredth it would take 1e8 of them, twelve days, to pass for signal.
    pub largest_deviation: f64,
    /// Least signal along any combination over that along the best told one. Limbs that tilt leave some hundred-thousandths of a force
    /// that the model does not know: where less than a thousandth of one shows a ratio, they would count for a per cent of it. It does not
    /// protect from cross-talk or limbs unequally stiff, a thousandth to a hundredth of a force: what a joint fit has not undone of them
    /// goes into the ratios.
    pub least_excitation: f64,
}

impl Default for Limits {
    /// A per cent and a thousandth.
    fn default() -> Self {
        Self {
            largest_deviation: 1e-2,
            least_excitation: 1e-3,
        }
    }
}

impl Limits {
    /// Information that a combination must have, where the best told one has `most`.
    pub(super) fn least_information(&self, most: f64) -> f64 {
        let excited = most * self.least_excitation * self.least_excitation;
        excited.max(1.0 / (self.largest_deviation * self.largest_deviation))
    }

    pub(super) fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("largest_deviation", self.largest_deviation),
            ("least_excitation", self.least_excitation),
        ] {
            require(
                value > 1e-12 && value < 1e3,
                name,
                value,
                "between 1e-12 and 1e3",
            )?;
        }
        Ok(())
    }
}

/// The one thing that ratios cannot explain away: limbs 1, 5 and 9 stand in two rows each, and going round, ratio by ratio, one
/// comes back to where one began. Crosstalk and a bent frame need not; limbs of unequal stiffness do. It is no sure sign: what
/// does not fit is taken for noise in part. Residuals that follow the motion show in [`ScaleRatios::lag_one_z`], too, and where
/// they are far beyond noise the fit is refused as not converged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopMisfit {
    /// ln of what limb 1 is worth in its first row over the second.
    pub ln_ratio: f64,
    /// Standard deviation of that.
    pub deviation: f64,
}

impl LoopMisfit {
    /// In standard deviations.
    #[must_use]
    pub fn z(&self) -> f64 {
        self.ln_ratio / self.deviation
    }

    /// Probability of as large a misfit by chance.
    #[must_use]
    pub fn chance(&self) -> f64 {
        chi_square_tail(self.z() * self.z(), 1).unwrap_or(0.0)
    }
}

/// Ratios of the scale factors to those of a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleRatios {
    /// ln(c_i over the calibration's c_i); they add up to zero, since their common factor is open.
    pub ln_ratio: [f64; LIMBS],
    /// Their covariance; singular along the common factor.
    pub covariance: PerLimbs,
    /// Blocks that they rest on.
    pub blocks: u64,
    /// Correlation of neighbouring blocks' residuals: zero but for chance, see [`Self::lag_one_z`], while the noise is white
    /// beyond a block. Intervals are too narrow by about 1 + this where it is not.
    pub lag_one_correlation: f64,
    /// Whether the three rows agree on the ratios of limbs 1, 5 and 9.
    pub misfit: LoopMisfit,
    /// Signal along the least told combination over that along the best told.
    pub excitation: f64,
}

impl ScaleRatios {
    /// Standard deviations of [`Self::ln_ratio`].
    #[must_use]
    pub fn deviations(&self) -> [f64; LIMBS] {
        core::array::from_fn(|i| sqrt(self.covariance[(i, i)].max(0.0)))
    }

    /// [`Self::lag_one_correlation`] in standard deviations of white noise.
    #[must_use]
    pub fn lag_one_z(&self) -> f64 {
        self.lag_one_correlation * sqrt(ROWS as f64 * self.blocks as f64)
    }
}
