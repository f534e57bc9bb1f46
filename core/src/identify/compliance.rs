//! What steps 2 and 3 neglect, kept: the motion of the mass in the shell.
//!
//! The paper's steps take the limbs as rigid, (12) and (15), which costs up to 2e-6 of s/m at 1 to 2 Hz. Once k/m is known
//! roughly, each sample's relative motion follows from its own forces, and the *full* equations (3) and (8) are as
//! linear in the unknowns as the short ones. Repeating steps 2 to 4 with them removes the neglect.

use glam::DVec3;

use super::inertia::InertiaIdentification;
use super::scale::ScaleIdentification;
use crate::error::Result;
use crate::geometry::{LIMBS, LIMBS_PER_NODE};
use crate::model::{Model, Parameters, Sensor, Settings};
use crate::paper::limb_stream::{LimbSample, LimbStream};
use crate::paper::wrench::limb_directions;

/// Turns a recording, sample by sample, into rows of the full equations.
#[derive(Debug, Clone, PartialEq)]
pub struct CompliantRows {
    limbs: LimbStream,
    scale_per_mass_per_kg: [f64; LIMBS],
    gravity_shell_m_s2: DVec3,
}

impl CompliantRows {
    /// Starts on one recording with the parameters found so far.
    ///
    /// # Errors
    /// Those of [`Model::new`] and [`LimbStream::new`].
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        Ok(Self {
            limbs: LimbStream::new(&Model::new(sensor, parameters, settings)?)?,
            scale_per_mass_per_kg: parameters.scale_per_mass_per_kg,
            gravity_shell_m_s2: settings.gravity_shell_m_s2(),
        })
    }

    /// Takes the next voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// Those of [`LimbStream::push`].
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<LimbSample>> {
        self.limbs.push(voltage_v)
    }

    /// Adds the three rows of (3) for pure linear motion: sum (s_i/m) f~_i e_i = a + a_r - g - sum preload_i e_i.
    ///
    /// `acceleration_shell_m_s2` is the reference acceleration at that sample.
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`].
    pub fn push_scale(
        &self,
        step: &mut ScaleIdentification,
        sample: &LimbSample,
        acceleration_shell_m_s2: DVec3,
    ) -> Result<()> {
        let directions = limb_directions(self.limbs.geometry(), &sample.relative.pose);
        let mut right = acceleration_shell_m_s2 + sample.relative.acceleration_shell_m_s2
            - self.gravity_shell_m_s2;
        for (direction, preload) in directions.iter().zip(self.limbs.preload_m_s2()) {
            right -= *direction * *preload;
        }
        let measured_force_n =
            core::array::from_fn(|i| sample.sensed_m_s2[i] / self.scale_per_mass_per_kg[i]);
        step.push_along(&measured_force_n, &directions, right)
    }

    /// Adds the three rows of (8) for pure angular motion, as Euler's equation of the *mass* in its own axes:
    /// (I/m) W' + W x (I/m) W = R_r^T sum (f_i/m) t_i x e_i with W = R_r^T (w* + w_r),
    /// W' = R_r^T (w*' + eps + w* x w_r).
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`], [`crate::Error::Overflow`].
    pub fn push_inertia(
        &self,
        step: &mut InertiaIdentification,
        sample: &LimbSample,
        rate_shell_rad_s: DVec3,
        rate_derivative_shell_rad_s2: DVec3,
    ) -> Result<()> {
        let relative = &sample.relative;
        let back = relative.pose.rotation_matrix().transpose();
        let rate = rate_shell_rad_s + relative.rate_shell_rad_s;
        let derivative = rate_derivative_shell_rad_s2
            + relative.angular_acceleration_shell_rad_s2
            + rate_shell_rad_s.cross(relative.rate_shell_rad_s);
        let directions = limb_directions(self.limbs.geometry(), &relative.pose);
        let mut torque_mass = DVec3::ZERO;
        for (limb, direction) in directions.iter().enumerate() {
            let arm = self.limbs.geometry().node_mass_m(limb / LIMBS_PER_NODE);
            torque_mass += arm.cross(back * *direction) * sample.force_per_mass_m_s2[limb];
        }
        step.push_torque(torque_mass, back * rate, back * derivative)
    }
}
