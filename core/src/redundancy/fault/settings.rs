//! Settings of a monitor.

use super::calibration_errors::{CalibrationErrors, alone};
use super::noise::RowNoise;
use crate::error::{Result, require_not_negative};
use crate::geometry::LIMBS;

/// Settings of a monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// Expected number of alarms of a healthy sensor.
    pub false_alarms_per_hour: f64,
    /// Standard deviation of the noise of each channel, V.
    pub noise_v: [f64; LIMBS],
    /// Standard deviation of each zero drift after calibration, V.
    pub zero_drift_sd_v: [f64; LIMBS],
    /// Covariance of the limbs' relative errors of strain per volt, those of scale factor and stiffness together. An error that all
    /// limbs share leaves the relations as they are.
    pub strain_covariance: [[f64; LIMBS]; LIMBS],
    /// Standard deviation of the share of another limb's strain that a channel shows.
    pub cross_talk_sd: f64,
}

impl Watch {
    /// Of a sensor that is known exactly, its limbs equally stiff and its channels apart.
    #[must_use]
    pub const fn exact(false_alarms_per_hour: f64, noise_v: [f64; LIMBS]) -> Self {
        Self {
            false_alarms_per_hour,
            noise_v,
            zero_drift_sd_v: [0.0; LIMBS],
            strain_covariance: [[0.0; LIMBS]; LIMBS],
            cross_talk_sd: 0.0,
        }
    }

    /// The rows' noise by what strain a volt is.
    pub(super) fn row_noise(&self, strain_per_v: &[f64; LIMBS]) -> Result<RowNoise> {
        RowNoise::from_channels(&core::array::from_fn(|limb| {
            (strain_per_v[limb] * self.noise_v[limb]).abs()
        }))
    }

    /// The errors that are expected, none where all is taken for exact.
    pub(super) fn errors(&self, strain_per_v: &[f64; LIMBS]) -> Result<Option<CalibrationErrors>> {
        require_not_negative("standard deviation of cross-talk", self.cross_talk_sd)?;
        for (limb, row) in self.strain_covariance.iter().enumerate() {
            require_not_negative("variance of a strain per volt", row[limb])?;
        }
        let errors = CalibrationErrors {
            strain: self.strain_covariance,
            alone: alone(&self.strain_covariance),
            cross_talk: self.cross_talk_sd,
            drift: core::array::from_fn(|limb| {
                (strain_per_v[limb] * self.zero_drift_sd_v[limb]).abs()
            }),
            drift_steps: [[0.0; LIMBS]; 2],
        };
        let all = errors.strain.as_flattened().iter().chain(&errors.drift);
        let exact = all.chain([&errors.cross_talk]).all(|&x| x == 0.0);
        Ok((!exact).then_some(errors))
    }
}
