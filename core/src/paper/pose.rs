//! Relative pose of the mass from the nine limb lengths, and back: the paper's reference \[10\].
//!
//! # Lengths to pose, in closed form
//! At a node the three limbs are orthonormal, so the node's displacement p from its unloaded place has components
//! p_i = p . e_i with
//!
//! ```text
//! l_i^2 = |L e_i + p|^2   =>   q_i := l_i^2 - L^2 = dl_i (2 L + dl_i) = 2 L p_i + S,   S := |p|^2.
//! ```
//!
//! Squaring p_i = (q_i - S)/(2L) and adding the three gives one quadratic in S,
//! 3 S^2 - (2 sum q + 4 L^2) S + sum q^2 = 0, whose smaller root is the assembled sensor. Displacements are 1e-7 m,
//! so q is formed from the elongation dl and never as a difference of squares.
//!
//! Three displaced nodes make nine numbers for six unknowns. With p_j = r + (R_r - 1) t_j the least-squares rotation
//! of three points -n e_j has the constant normal matrix n^2 (1 + 1 1^T/3), whose inverse is (1 - 1 1^T/6)/n^2; the
//! part of R_r - 1 beyond the cross product is of second order and is removed by fixed-point iteration.

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};
use crate::float::{sin_cos, sqrt};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE, NODES};

/// Rotations below this angle take the series of the sine and cosine quotients, rad: its first dropped term is
/// angle^6/5040, which is below rounding.
const SERIES_ANGLE_RAD: f64 = 5e-3;

/// The rotation fit gains about 1/|phi| per iteration: four reach rounding at 1e-4 rad.
const FIT_ITERATIONS: usize = 24;
/// Relative change of the rotation at which the fit is done.
const FIT_TOLERANCE: f64 = 1e-16;

/// Pose of {2} in {1}.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// r: position of the mass's centre in shell axes, m.
    pub position_shell_m: DVec3,
    /// phi with R_r = exp(\[phi\]x): rotation vector, the same in shell and mass axes, rad.
    pub rotation_rad: DVec3,
}

/// (R - 1) v for the rotation vector phi, without cancellation at small angles.
pub(crate) fn rotate_minus_identity(phi: DVec3, v: DVec3) -> DVec3 {
    let (a, b) = sine_cosine_quotients(phi);
    let once = phi.cross(v);
    a * once + b * phi.cross(once)
}

/// sin(x)/x and (1 - cos x)/x^2 of the length of `phi`.
fn sine_cosine_quotients(phi: DVec3) -> (f64, f64) {
    let x2 = phi.length_squared();
    if x2 < SERIES_ANGLE_RAD * SERIES_ANGLE_RAD {
        (
            1.0 - x2 / 6.0 * (1.0 - x2 / 20.0),
            0.5 - x2 / 24.0 * (1.0 - x2 / 30.0),
        )
    } else {
        let x = sqrt(x2);
        let (sin, _) = sin_cos(x);
        let (half_sin, _) = sin_cos(0.5 * x);
        (sin / x, 2.0 * half_sin * half_sin / x2)
    }
}

impl Pose {
    /// R_r as a matrix: mass axes to shell axes.
    #[must_use]
    pub fn rotation_matrix(&self) -> DMat3 {
        let phi = self.rotation_rad;
        DMat3::from_cols(
            DVec3::X + rotate_minus_identity(phi, DVec3::X),
            DVec3::Y + rotate_minus_identity(phi, DVec3::Y),
            DVec3::Z + rotate_minus_identity(phi, DVec3::Z),
        )
    }

    /// Displacement of a node from its unloaded place, shell axes, m.
    #[must_use]
    pub fn node_displacement_shell_m(&self, geometry: &Geometry, node: usize) -> DVec3 {
        self.position_shell_m + rotate_minus_identity(self.rotation_rad, geometry.node_mass_m(node))
    }

    /// Elongations l_i - L that belong to this pose, m. Exact for any pose; inverse of [`Pose::from_elongations`].
    #[must_use]
    pub fn elongations_m(&self, geometry: &Geometry) -> [f64; LIMBS] {
        let nodes: [DVec3; NODES] =
            core::array::from_fn(|node| self.node_displacement_shell_m(geometry, node));
        let length = geometry.limb_length_m;
        core::array::from_fn(|limb| {
            let p = nodes[limb / LIMBS_PER_NODE];
            let q = 2.0 * length * p.dot(DIRECTIONS_SHELL[limb]) + p.length_squared();
            q / (length + sqrt(length * length + q))
        })
    }

    /// The pose whose nodes come closest, in the least-squares sense, to those that the nine elongations ask for.
    ///
    /// Exact when the nine are consistent (equal stiffness, no noise). Equals Gauss-Newton on the nine lengths to
    /// first order, because the limbs at a node are orthonormal.
    ///
    /// # Errors
    /// [`Error::LimbsDoNotMeet`] when no point has the three distances asked for at a node, or an elongation is not
    /// finite; [`Error::NotConverged`] when the rotation that fits the nodes best is not finite.
    pub fn from_elongations(geometry: &Geometry, elongation_m: &[f64; LIMBS]) -> Result<Self> {
        let mut displacement = [DVec3::ZERO; NODES];
        for (node, p) in displacement.iter_mut().enumerate() {
            *p = node_displacement(geometry, elongation_m, node)?;
        }
        let mean = (displacement[0] + displacement[1] + displacement[2]) / 3.0;
        let nodes: [DVec3; NODES] = core::array::from_fn(|j| geometry.node_mass_m(j));
        let node_mean = (nodes[0] + nodes[1] + nodes[2]) / 3.0;
        let inverse_n2 = 1.0 / (geometry.half_edge_m * geometry.half_edge_m);

        let mut phi = DVec3::ZERO;
        for _ in 0..FIT_ITERATIONS {
            let mut moment = DVec3::ZERO;
            for j in 0..NODES {
                let arm = nodes[j] - node_mean;
                let beyond_linear = rotate_minus_identity(phi, arm) - phi.cross(arm);
                moment += arm.cross(displacement[j] - mean - beyond_linear);
            }
            let next = (moment - DVec3::splat(moment.element_sum() / 6.0)) * inverse_n2;
            let change = (next - phi).length_squared();
            phi = next;
            if change <= FIT_TOLERANCE * FIT_TOLERANCE * phi.length_squared() {
                break;
            }
        }
        let pose = Self {
            position_shell_m: mean - rotate_minus_identity(phi, node_mean),
            rotation_rad: phi,
        };
        if !(pose.position_shell_m.is_finite() && phi.is_finite()) {
            return Err(Error::NotConverged {
                what: "rotation of the mass",
                iterations: FIT_ITERATIONS,
            });
        }
        Ok(pose)
    }
}

/// Displacement of one node from the elongations of its three limbs, shell axes, m.
pub(crate) fn node_displacement(
    geometry: &Geometry,
    elongation_m: &[f64; LIMBS],
    node: usize,
) -> Result<DVec3> {
    let length = geometry.limb_length_m;
    let first = node * LIMBS_PER_NODE;
    let q: [f64; LIMBS_PER_NODE] = core::array::from_fn(|i| {
        let dl = elongation_m[first + i];
        dl * (2.0 * length + dl)
    });
    let sum_q2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    let b = 2.0 * (q[0] + q[1] + q[2]) + 4.0 * length * length;
    let discriminant = b * b - 12.0 * sum_q2;
    if !(discriminant >= 0.0 && b > 0.0 && sum_q2.is_finite()) {
        return Err(Error::LimbsDoNotMeet { node: node + 1 });
    }
    // The smaller root, written without the cancellation of b - sqrt(..).
    let s = 2.0 * sum_q2 / (b + sqrt(discriminant));
    let mut p = DVec3::ZERO;
    for i in 0..LIMBS_PER_NODE {
        p += DIRECTIONS_SHELL[first + i] * ((q[i] - s) / (2.0 * length));
    }
    Ok(p)
}
