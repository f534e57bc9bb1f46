//! Motion of the mass in the shell from three poses: the left-superscript-1 quantities of the paper.

use glam::DVec3;

use super::pose::Pose;

/// Motion of {2} in {1}, shell axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RelativeMotion {
    /// r and R_r.
    pub pose: Pose,
    /// v, m/s.
    pub velocity_shell_m_s: DVec3,
    /// w_r, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// a_r, m/s^2.
    pub acceleration_shell_m_s2: DVec3,
    /// eps, rad/s^2.
    pub angular_acceleration_shell_rad_s2: DVec3,
}

impl RelativeMotion {
    pub(crate) fn is_finite(&self) -> bool {
        [
            self.pose.position_shell_m,
            self.pose.rotation_rad,
            self.velocity_shell_m_s,
            self.rate_shell_rad_s,
            self.acceleration_shell_m_s2,
            self.angular_acceleration_shell_rad_s2,
        ]
        .iter()
        .all(|v| v.is_finite())
    }

    /// Central differences of three poses one `step_s` apart: second order in the step.
    ///
    /// The rate of a rotation vector is not yet an angular velocity: w_r = phi' + phi x phi'/2 + ... (left Jacobian of
    /// SO(3)), kept to the second power of phi: the dropped terms are phi^3/24, 1e-16 of phi' at the 1e-5 rad of a
    /// real sensor.
    #[must_use]
    pub fn from_poses(before: &Pose, now: &Pose, after: &Pose, step_s: f64) -> Self {
        let half_rate = 0.5 / step_s;
        let rate2 = 1.0 / (step_s * step_s);
        let phi = now.rotation_rad;
        let phi_dot = (after.rotation_rad - before.rotation_rad) * half_rate;
        let phi_ddot = ((after.rotation_rad - phi) - (phi - before.rotation_rad)) * rate2;
        let r = now.position_shell_m;
        Self {
            pose: *now,
            velocity_shell_m_s: (after.position_shell_m - before.position_shell_m) * half_rate,
            rate_shell_rad_s: phi_dot
                + 0.5 * phi.cross(phi_dot)
                + phi.cross(phi.cross(phi_dot)) / 6.0,
            acceleration_shell_m_s2: ((after.position_shell_m - r) - (r - before.position_shell_m))
                * rate2,
            angular_acceleration_shell_rad_s2: phi_ddot
                + 0.5 * phi.cross(phi_ddot)
                + (phi_dot.cross(phi.cross(phi_dot)) + phi.cross(phi.cross(phi_ddot))) / 6.0,
        }
    }
}
