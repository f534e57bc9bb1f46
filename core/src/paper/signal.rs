//! From voltages to limb forces: eqs. (1), (10) and (11).

use crate::geometry::LIMBS;
use crate::model::{Gains, Parameters};

impl Gains {
    /// Measured force f~_i = c_i (u_i - d_i), N: eq. (10).
    #[must_use]
    pub fn measured_force_n(
        &self,
        voltage_v: &[f64; LIMBS],
        zero_drift_v: &[f64; LIMBS],
    ) -> [f64; LIMBS] {
        core::array::from_fn(|i| self.gain_n_per_v[i] * (voltage_v[i] - zero_drift_v[i]))
    }
}

/// The signal chain with its constants multiplied out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalChain {
    zero_drift_v: [f64; LIMBS],
    /// (s_i/m) c_i, m/(s^2 V).
    sensitivity: [f64; LIMBS],
}

impl SignalChain {
    /// Multiplies gains and scale factors out.
    #[must_use]
    pub fn new(gains: &Gains, parameters: &Parameters) -> Self {
        Self {
            zero_drift_v: parameters.zero_drift_v,
            sensitivity: core::array::from_fn(|i| {
                parameters.scale_per_mass_per_kg[i] * gains.gain_n_per_v[i]
            }),
        }
    }

    /// (s_i/m) c_i: change of the limb force per mass with the voltage, m/(s^2 V).
    #[must_use]
    pub fn sensitivity_m_s2_per_v(&self) -> &[f64; LIMBS] {
        &self.sensitivity
    }

    /// Limb force per mass f_i/m = (s_i/m) c_i (u_i - d_i), m/s^2, positive in compression: eq. (11).
    #[must_use]
    pub fn force_per_mass_m_s2(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| self.sensitivity[i] * (voltage_v[i] - self.zero_drift_v[i]))
    }

    /// Change of the voltages that belongs to a change of the limb forces per mass.
    #[must_use]
    pub fn voltage_change_v(&self, force_per_mass_m_s2: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| force_per_mass_m_s2[i] / self.sensitivity[i])
    }

    /// The voltages that a sensor with these parameters shows under the given limb forces: (11) solved for u.
    #[must_use]
    pub fn voltage_v(&self, force_per_mass_m_s2: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| {
            force_per_mass_m_s2[i] / self.sensitivity[i] + self.zero_drift_v[i]
        })
    }
}
