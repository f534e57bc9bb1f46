//! What is known of a sensor without identification.

use serde::{Deserialize, Serialize};

use super::parameters::Parameters;
use crate::error::{Result, require};
use crate::geometry::{Geometry, LIMBS};

/// What is known of the sensor without identification.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Lengths from the drawing.
    pub geometry: Geometry,
    /// c_i of the amplifier setting in use.
    pub gains: Gains,
}

/// Gain c_i of each measuring channel, N/V: eq. (10). A setting of the amplifier, known, never identified.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Gains {
    /// c_i, N/V.
    pub gain_n_per_v: [f64; LIMBS],
}

impl Gains {
    /// The same gain on all nine channels, N/V.
    #[must_use]
    pub const fn uniform(gain_n_per_v: f64) -> Self {
        Self {
            gain_n_per_v: [gain_n_per_v; LIMBS],
        }
    }

    /// Refuses gains that are not finite or zero.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`].
    pub fn validate(&self) -> Result<()> {
        for value in self.gain_n_per_v {
            require(
                value.is_finite() && value != 0.0,
                "gain_n_per_v",
                value,
                "finite and not zero",
            )?;
        }
        Ok(())
    }

    /// Refuses a gain and a scale factor whose product no f64 holds.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`].
    pub fn validate_with(&self, parameters: &Parameters) -> Result<()> {
        let scales = parameters.scale_per_mass_per_kg;
        for (scale, gain) in scales.into_iter().zip(self.gain_n_per_v) {
            let value = scale * gain;
            require(
                value.is_normal(),
                "scale_per_mass_per_kg x gain_n_per_v",
                value,
                "finite and not zero",
            )?;
        }
        Ok(())
    }
}
