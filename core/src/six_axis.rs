//! The answer of every decoder.

use glam::{DQuat, DVec3};

/// One decoupled sample. `V` and `Q` are vector and quaternion of the decoder's precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SixAxis<V = DVec3, Q = DQuat> {
    /// Index of the voltage sample that this belongs to, from 0.
    pub sample: u64,
    /// a, linear acceleration of the shell, ground axes, m/s^2.
    pub linear_ground_m_s2: V,
    /// w', angular acceleration of the shell, ground axes, rad/s^2.
    pub angular_ground_rad_s2: V,
    /// w*, angular velocity of the shell, shell axes, rad/s.
    pub rate_shell_rad_s: V,
    /// R, shell axes to ground axes.
    pub attitude: Q,
}

impl SixAxis {
    /// Linear acceleration, m/s^2, then angular acceleration, rad/s^2, both in ground axes.
    #[must_use]
    pub fn accelerations(&self) -> [f64; 6] {
        let (a, alpha) = (self.linear_ground_m_s2, self.angular_ground_rad_s2);
        [a.x, a.y, a.z, alpha.x, alpha.y, alpha.z]
    }
}
