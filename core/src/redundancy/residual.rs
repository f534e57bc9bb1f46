//! The parity relations to second order.

use super::parity::ROWS;
use crate::geometry::LIMBS;
use crate::kernel;
use crate::kernel::order::to_kernel_order;

/// What the three rows leave of nine strains (elongation over length), to second order; `nu` is half edge over limb length.
///
/// Zero, but for terms of third order, for the strains of any pose of the mass.
#[must_use]
pub fn residual(strain: &[f64; LIMBS], nu: f64) -> [f64; ROWS] {
    kernel::parity::residual(to_kernel_order(*strain), nu, 1.0 / nu).components()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Geometry;
    use crate::paper::pose::Pose;
    use crate::redundancy::parity::COORDINATION;

    #[test]
    fn poses_leave_a_residual_of_third_order() {
        let geometry = Geometry::PAPER;
        let nu = geometry.half_edge_m / geometry.limb_length_m;
        let left = |scale: f64| {
            let pose = Pose {
                position_shell_m: DVec3::new(0.3, -0.7, 0.5) * scale * geometry.limb_length_m,
                rotation_rad: DVec3::new(-0.6, 0.2, 0.9) * scale,
            };
            let strain = pose
                .elongations_m(&geometry)
                .map(|e| e / geometry.limb_length_m);
            let first: f64 = COORDINATION[0].iter().map(|&i| strain[i]).sum();
            let second = residual(&strain, nu);
            (
                first.abs(),
                second.iter().fold(0.0, |m: f64, r| m.max(r.abs())),
            )
        };
        let ((first, second), (first_half, second_half)) = (left(1e-4), left(5e-5));
        // Halving the pose: a quarter of what the plain sums leave, an eighth of what the second order does.
        assert!(
            (first / first_half - 4.0).abs() < 0.02,
            "{first} {first_half}"
        );
        assert!(
            (second / second_half - 8.0).abs() < 0.1,
            "{second} {second_half}"
        );
    }
}
