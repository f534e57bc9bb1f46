//! Whether limbs are equally stiff.
//!
//! The balance of forces, step 2, finds c_i whatever the limbs' stiffness; the parity rows find c_i/k_i. Their quotient is k_i but
//! for a common factor, and equal stiffness a hypothesis of eight degrees of freedom.

use nalgebra::SVector;

use super::{PerLimbs, RATIOS, ScaleRatios, information_without_common};
use crate::error::{Error, Result, require_finite};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::significance::{chi_square_limit, chi_square_tail};

/// Result of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessTest {
    /// ln k_i over their geometric mean.
    pub ln_stiffness: [f64; LIMBS],
    /// Their covariance, singular along a common factor.
    pub covariance: PerLimbs,
    /// Sum of their squares over that covariance, with eight degrees of freedom.
    pub chi_square: f64,
    /// Value that equally stiff limbs exceed at the asked rate.
    pub limit: f64,
}

impl StiffnessTest {
    /// From ln c_i over the same calibration's by step 2 and their covariance, a common error of which drops out, and the ratios
    /// by the rows.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a rate of false alarms that is none, values or a covariance that are none.
    pub fn new(
        ln_scale: &[f64; LIMBS],
        covariance: &PerLimbs,
        ratios: &ScaleRatios,
        false_alarm: f64,
    ) -> Result<Self> {
        let limit = chi_square_limit(false_alarm, RATIOS)?;
        for &value in ln_scale {
            require_finite("ln_scale", value)?;
        }
        let both = covariance + ratios.covariance;
        let information = information_without_common(&both).ok_or(Error::out_of_range(
            "covariance of the scale factors",
            covariance.amax(),
            "positive and finite",
        ))?;
        let difference: [f64; LIMBS] = core::array::from_fn(|i| ln_scale[i] - ratios.ln_ratio[i]);
        let mean = difference.iter().sum::<f64>() / LIMBS as f64;
        let k = SVector::from(difference.map(|d| d - mean));
        let without_mean =
            PerLimbs::from_fn(|i, j| f64::from(i8::from(i == j)) - 1.0 / LIMBS as f64);
        Ok(Self {
            ln_stiffness: k.into(),
            covariance: without_mean * both * without_mean,
            chi_square: k.dot(&(information * k)),
            limit,
        })
    }

    /// Whether equal stiffness stands.
    #[must_use]
    pub fn equal(&self) -> bool {
        self.chi_square <= self.limit
    }

    /// Probability of as large a sum of squares for equally stiff limbs; 0 for NaN.
    #[must_use]
    pub fn chance(&self) -> f64 {
        chi_square_tail(self.chi_square, RATIOS).unwrap_or(0.0)
    }

    /// Standard deviations of [`Self::ln_stiffness`].
    #[must_use]
    pub fn deviations(&self) -> [f64; LIMBS] {
        core::array::from_fn(|i| sqrt(self.covariance[(i, i)].max(0.0)))
    }
}
