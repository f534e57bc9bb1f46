//! What nine limb forces come to: the sums in (3), (4) and (8).
//!
//! Mass cancels throughout: forces come per mass, m/s^2, torques per mass, m^2/s^2.

use glam::DVec3;

use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE, NODES};
use crate::paper::pose::Pose;

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
