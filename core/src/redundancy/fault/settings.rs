//! Settings of a monitor.

use super::detector::CalibrationErrors;
use super::noise::RowNoise;
use crate::error::{Result, require_not_negative};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Settings of a monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// Expected number of alarms of a healthy sensor.
    pub false_alarms_per_hour: f64,
    /// Standard deviation of the noise of each channel, V.
    pub noise_v: [f64; LIMBS],
    /// Standard deviation of each scale factor after calibration, relative; zeros to take it for exact.
    pub scale_sd: [f64; LIMBS],
    /// Standard deviation of a limb's stiffness about the mean of the nine, relative; zero for limbs that are equal. No calibration
    /// determines it.
    pub stiffness_sd: f64,
    /// The same of each zero drift, V.
    pub zero_drift_sd_v: [f64; LIMBS],
}

impl Watch {
    /// The rows' noise by what strain a volt is.
    pub(super) fn row_noise(&self, strain_per_v: &[f64; LIMBS]) -> Result<RowNoise> {
        RowNoise::from_channels(&core::array::from_fn(|limb| {
            (strain_per_v[limb] * self.noise_v[limb]).abs()
        }))
    }

    /// The errors that are expected, none where all is taken for exact.
    pub(super) fn errors(&self, strain_per_v: &[f64; LIMBS]) -> Result<Option<CalibrationErrors>> {
        require_not_negative("spread of the limbs' stiffnesses", self.stiffness_sd)?;
        let errors = CalibrationErrors {
            scale: self
                .scale_sd
                .map(|sd| sqrt(sd * sd + self.stiffness_sd * self.stiffness_sd)),
            drift: core::array::from_fn(|limb| {
                (strain_per_v[limb] * self.zero_drift_sd_v[limb]).abs()
            }),
        };
        let exact = errors
            .scale
            .iter()
            .chain(&errors.drift)
            .all(|&sd| sd == 0.0);
        Ok((!exact).then_some(errors))
    }
}
