//! The dynamics of the sensor: eqs. (3) and (8) in SI units, as the paper prints them.
//!
//! w* = R^T w is the shell's angular velocity in shell axes, the paper's auxiliary angular velocity. Mass cancels: forces come per
//! mass, m/s^2, torques per mass, m^2/s^2, inertia per mass, m^2.

use glam::{DMat3, DVec3};

use super::relative_motion::RelativeMotion;
use super::wrench::LimbWrench;
use crate::model::InertiaPerMass;

/// I/m and its inverse in mass axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassInertia {
    tensor_mass_m2: DMat3,
    inverse_mass: DMat3,
}

impl MassInertia {
    /// Inverts a tensor that [`InertiaPerMass::validate`] has accepted.
    #[must_use]
    pub fn new(inertia_per_mass: &InertiaPerMass) -> Self {
        let tensor_mass_m2 = inertia_per_mass.matrix_mass_m2();
        Self {
            tensor_mass_m2,
            inverse_mass: tensor_mass_m2.inverse(),
        }
    }
}

/// Everything in (3) and (8) at one instant except the shell's own rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// r, R_r, v, w_r, a_r and eps: motion of the mass in the shell.
    pub relative: RelativeMotion,
    /// sum (f_i/m) e_i and sum (f_i/m) t_i x e_i.
    pub wrench: LimbWrench,
    /// I* = R_r (I/m) R_r^T, shell axes, m^2.
    inertia_shell_m2: DMat3,
    /// I*^-1.
    inertia_shell_inverse: DMat3,
}

impl Instant {
    /// Turns the inertia into shell axes.
    #[must_use]
    pub fn new(relative: RelativeMotion, wrench: LimbWrench, inertia: &MassInertia) -> Self {
        let rotation = relative.pose.rotation_matrix();
        let back = rotation.transpose();
        Self {
            relative,
            wrench,
            inertia_shell_m2: rotation * inertia.tensor_mass_m2 * back,
            inertia_shell_inverse: rotation * inertia.inverse_mass * back,
        }
    }

    /// Angular acceleration w*' of the shell in shell axes, rad/s^2: eq. (8).
    ///
    /// ```text
    /// w*' = I*^-1 ( sum (f_i/m) t_i x e_i - (w* + w_r) x I* (w* + w_r) ) - eps - w* x w_r
    /// ```
    #[must_use]
    pub fn angular_acceleration_shell_rad_s2(&self, rate_shell_rad_s: DVec3) -> DVec3 {
        let w_r = self.relative.rate_shell_rad_s;
        let total = rate_shell_rad_s + w_r;
        self.inertia_shell_inverse
            * (self.wrench.torque_shell_m2_s2 - total.cross(self.inertia_shell_m2 * total))
            - self.relative.angular_acceleration_shell_rad_s2
            - rate_shell_rad_s.cross(w_r)
    }

    /// R^T (a - g): acceleration of the shell less gravity, in shell axes, m/s^2: eq. (3) turned into {1}.
    ///
    /// ```text
    /// R^T (a - g) = sum (f_i/m) e_i - a_r - w*' x r - w* x (w* x r) - 2 w* x v
    /// ```
    #[must_use]
    pub fn specific_force_shell_m_s2(
        &self,
        rate_shell_rad_s: DVec3,
        angular_acceleration_shell_rad_s2: DVec3,
    ) -> DVec3 {
        let w = rate_shell_rad_s;
        let r = self.relative.pose.position_shell_m;
        self.wrench.force_shell_m_s2
            - self.relative.acceleration_shell_m_s2
            - angular_acceleration_shell_rad_s2.cross(r)
            - w.cross(w.cross(r))
            - 2.0 * w.cross(self.relative.velocity_shell_m_s)
    }
}
