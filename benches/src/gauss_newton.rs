//! The pose from nine limb lengths by Gauss-Newton with nalgebra, as one would first write it down.
//!
//! Timed beside the closed form of [`sixaxis_core::paper::pose`]. Started at the last sample's pose it takes one iteration while
//! little moves, otherwise two. The decoders in C++ and Python under `benches/peers` find their poses in the same way.

use glam::DVec3;
use nalgebra::{Rotation3, SMatrix, SVector, Vector3};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::{Geometry, LIMBS};

type V3 = Vector3<f64>;

/// Gauss-Newton stops at a step of this size, m (rotations times half an edge). One more iteration would gain a factor
/// of 1e-5, the angle by which limbs tilt: 1e-18 m, less than the last digit of a limb's length.
const CONVERGED_M: f64 = 1e-13;
/// Cap on the iterations.
const ITERATIONS: usize = 20;

fn v3(v: DVec3) -> V3 {
    V3::new(v.x, v.y, v.z)
}

fn dvec3(v: V3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// The hinges of the drawing, from which Gauss-Newton finds poses.
#[derive(Debug, Clone)]
pub struct GaussNewton {
    /// t_i, mass axes, m.
    t: [V3; LIMBS],
    /// b_i, shell axes, m.
    b: [V3; LIMBS],
    /// L, m.
    length: f64,
    /// n, m.
    half_edge: f64,
}

impl GaussNewton {
    /// From the drawing.
    pub fn new(geometry: &Geometry) -> Self {
        Self {
            t: geometry.mass_hinges_m().map(v3),
            b: geometry.shell_hinges_m().map(v3),
            length: geometry.limb_length_m,
            half_edge: geometry.half_edge_m,
        }
    }

    /// The pose with the nine lengths L + `elongation_m`: least squares by Gauss-Newton from `start`.
    pub fn pose(&self, elongation_m: &[f64; LIMBS], start: Pose) -> Pose {
        let (mut r, mut phi) = (v3(start.position_shell_m), v3(start.rotation_rad));
        for _ in 0..ITERATIONS {
            let rotation = Rotation3::new(phi);
            let mut jacobian = SMatrix::<f64, LIMBS, 6>::zeros();
            let mut residual = SVector::<f64, LIMBS>::zeros();
            for i in 0..LIMBS {
                let t = rotation * self.t[i];
                let limb = r + t - self.b[i];
                let e = limb.normalize();
                // d l_i = e_i . dr + (t_i x e_i) . dphi
                jacobian.fixed_view_mut::<1, 3>(i, 0).tr_copy_from(&e);
                jacobian
                    .fixed_view_mut::<1, 3>(i, 3)
                    .tr_copy_from(&t.cross(&e));
                residual[i] = self.length + elongation_m[i] - limb.norm();
            }
            let normal = jacobian.transpose() * jacobian;
            let Some(cholesky) = normal.cholesky() else {
                break;
            };
            let step = cholesky.solve(&(jacobian.transpose() * residual));
            let (dr, dphi) = (
                V3::new(step[0], step[1], step[2]),
                V3::new(step[3], step[4], step[5]),
            );
            r += dr;
            phi += dphi;
            if dr.norm() + self.half_edge * dphi.norm() < CONVERGED_M {
                break;
            }
        }
        Pose {
            position_shell_m: dvec3(r),
            rotation_rad: dvec3(phi),
        }
    }
}
