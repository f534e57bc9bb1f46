//! Newton and Euler for the mass, solved for the motion of the shell: eqs. (3), (4) and (8).
//!
//! Mass cancels throughout: forces come per mass, m/s^2, torques per mass, m^2/s^2, inertia per mass, m^2.
//! w* is the shell's angular velocity in shell axes (the paper's auxiliary angular velocity).

use glam::{DMat3, DVec3};

use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE, NODES};
use crate::parameters::InertiaPerMass;
use crate::pose::{Pose, RelativeMotion};

/// Resultant of the nine limb forces on the mass, per mass, shell axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LimbWrench {
    /// sum (f_i/m) e_i, m/s^2.
    pub force_shell_m_s2: DVec3,
    /// sum (f_i/m) t_i x e_i about the mass's centre, m^2/s^2.
    pub torque_shell_m2_s2: DVec3,
}

impl LimbWrench {
    /// Sums the limb forces where the limbs are now: e_i and t_i turn with the relative pose.
    #[must_use]
    pub fn at_pose(geometry: &Geometry, pose: &Pose, force_per_mass_m_s2: &[f64; LIMBS]) -> Self {
        let length = geometry.limb_length_m;
        let mut wrench = Self::default();
        for (node, forces) in force_per_mass_m_s2.chunks_exact(LIMBS_PER_NODE).enumerate() {
            let rest = geometry.node_mass_m(node);
            let displacement = pose.node_displacement_shell_m(geometry, node);
            let mut node_force = DVec3::ZERO;
            for (i, &f) in forces.iter().enumerate() {
                let limb = DIRECTIONS_SHELL[node * LIMBS_PER_NODE + i] * length + displacement;
                node_force += limb * (f / limb.length());
            }
            // t_i = R_r t_i(0): the node seen from the mass's centre.
            let arm = rest + (displacement - pose.position_shell_m);
            wrench.force_shell_m_s2 += node_force;
            wrench.torque_shell_m2_s2 += arm.cross(node_force);
        }
        wrench
    }

    /// Sums the limb forces along the directions at rest: the right sides of (12) and (15).
    #[must_use]
    pub fn at_rest(geometry: &Geometry, force_per_mass_m_s2: &[f64; LIMBS]) -> Self {
        Self::at_pose(geometry, &Pose::default(), force_per_mass_m_s2)
    }
}

/// Directions e_i of the limbs at a relative pose, shell axes.
#[must_use]
pub fn limb_directions(geometry: &Geometry, pose: &Pose) -> [DVec3; LIMBS] {
    let nodes: [DVec3; NODES] =
        core::array::from_fn(|node| pose.node_displacement_shell_m(geometry, node));
    core::array::from_fn(|limb| {
        let limb_m = DIRECTIONS_SHELL[limb] * geometry.limb_length_m + nodes[limb / LIMBS_PER_NODE];
        limb_m / limb_m.length()
    })
}

/// Everything in (3) and (8) at one instant except the shell's own rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Motion of the mass in the shell.
    pub relative: RelativeMotion,
    /// Resultant of the limb forces.
    pub wrench: LimbWrench,
    /// I* = R_r (I/m) R_r^T, shell axes, m^2.
    inertia_shell_m2: DMat3,
    /// Its inverse.
    inertia_shell_inverse: DMat3,
}

impl Instant {
    /// Collects what the limbs say at one instant.
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

    /// I/m in mass axes, m^2.
    #[must_use]
    pub fn tensor_mass_m2(&self) -> DMat3 {
        self.tensor_mass_m2
    }
}
