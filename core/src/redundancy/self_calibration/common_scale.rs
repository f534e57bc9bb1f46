//! The common factor of all nine scale factors, from one known change of acceleration.
//!
//! Between two rests the specific force in the shell changes by a vector of known length, 2 g for a sensor that is turned over.
//! Eq. (12) then reads |sum c_i f_i e_i| = length, with f_i the force per mass by the earlier calibration. The tilt of the limbs at
//! rest, a millionth, is neglected.

use glam::DVec3;
use nalgebra::SVector;

use super::ScaleRatios;
use crate::error::{Result, require, require_not_negative, require_positive};
use crate::float::{exp, ln, sqrt};
use crate::geometry::{DIRECTIONS_SHELL, LIMBS};
use crate::paper::signal::SignalChain;

/// A known change of specific force between two rests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownChange {
    /// Change of each channel's mean from one rest to the other, V.
    pub voltage_change_v: [f64; LIMBS],
    /// Standard deviation of that, V.
    pub voltage_deviation_v: [f64; LIMBS],
    /// Length of the change of specific force, m/s^2: 2 g for a sensor that is turned over.
    pub length_m_s2: f64,
    /// Its standard deviation, m/s^2.
    pub length_deviation_m_s2: f64,
}

/// All nine scale factors over the calibration's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// ln of each scale factor over the calibration's.
    pub ln_scale: [f64; LIMBS],
    /// Standard deviations.
    pub deviation: [f64; LIMBS],
    /// ln of the factor that all have in common beside the ratios'.
    pub ln_common: f64,
    /// Its standard deviation.
    pub common_deviation: f64,
}

impl KnownChange {
    /// The common factor, and with it all nine; `chain` is the calibration's.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for a length that is not positive, deviations that are negative or voltages that did not change.
    pub fn scales(&self, chain: &SignalChain, ratios: &ScaleRatios) -> Result<Scales> {
        require_positive("length_m_s2", self.length_m_s2)?;
        let deviations = self.voltage_deviation_v.iter();
        for &value in deviations.chain([&self.length_deviation_m_s2]) {
            require_not_negative("a standard deviation", value)?;
        }
        let sensitivity = chain.sensitivity_m_s2_per_v();
        let per_v: [DVec3; LIMBS] = core::array::from_fn(|i| {
            DIRECTIONS_SHELL[i] * (exp(ratios.ln_ratio[i]) * sensitivity[i])
        });
        let sum: DVec3 = (0..LIMBS)
            .map(|i| per_v[i] * self.voltage_change_v[i])
            .sum();
        let length = sum.length();
        require(
            length.is_normal() && length > 0.0,
            "voltage_change_v",
            length,
            "a change that forces add up to",
        )?;
        let along = sum / length;
        // d ln(length)/d ln c_i, and what a volt is worth.
        let by_ratio = SVector::<f64, LIMBS>::from_fn(|i, _| {
            per_v[i].dot(along) * self.voltage_change_v[i] / length
        });
        let from_ratios = ratios.covariance * by_ratio;
        let from_voltages: f64 = (0..LIMBS)
            .map(|i| per_v[i].dot(along) * self.voltage_deviation_v[i] / length)
            .map(|x| x * x)
            .sum();
        let known = self.length_deviation_m_s2 / self.length_m_s2;
        let variance = by_ratio.dot(&from_ratios) + from_voltages + known * known;
        let ln_common = ln(self.length_m_s2 / length);
        Ok(Scales {
            ln_scale: ratios.ln_ratio.map(|ratio| ratio + ln_common),
            deviation: core::array::from_fn(|i| {
                let own = ratios.covariance[(i, i)] - 2.0 * from_ratios[i];
                sqrt((own + variance).max(0.0))
            }),
            ln_common,
            common_deviation: sqrt(variance),
        })
    }
}
