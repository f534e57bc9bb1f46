//! What nine limbs say more than six: the force coordination equations, and what they are good for.
//!
//! A mass has six coordinates, so of nine elongations three are spoken for. To first order in the strain the elongations of
//! limbs on an undeformed mass obey, whatever the motion, the mass or its inertia,
//!
//! ```text
//! x1 + x2 + x4 + x5 = 0,    x1 + x3 + x7 + x9 = 0,    x5 + x6 + x8 + x9 = 0,
//! ```
//!
//! and the forces do as far as the limbs are equally stiff. The left sides are the three parity rows: zero but for noise while
//! all is well. [`residual`] keeps their second order, which is a millionth of a force at 9 g.
//!
//! A limb that fails shows along its own column of the rows, its [`SIGNATURES`]. Limbs 1, 5 and 9 each have a signature of
//! their own; 2 and 4, 3 and 7, 6 and 8 share one ([`AMBIGUOUS_PAIRS`]), and no force tells such twins apart. Limbs whose signatures are
//! independent can be done without: [`super::reconstruction`] has them from the others.

use crate::geometry::LIMBS;
use crate::kernel::constants::to_kernel_order;
use crate::kernel::parity;

/// Number of coordination equations.
pub const ROWS: usize = 3;

/// Limbs (from 0) whose elongations each equation adds up.
pub const COORDINATION: [[usize; 4]; ROWS] = [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]];

/// Limbs (from 0) that share a signature.
pub const AMBIGUOUS_PAIRS: [[usize; 2]; ROWS] = [[1, 3], [2, 6], [5, 7]];

/// In which rows each limb stands: a failure of limb i shows along `SIGNATURES[i]`.
pub const SIGNATURES: [[i32; ROWS]; LIMBS] = signatures();

const fn signatures() -> [[i32; ROWS]; LIMBS] {
    let mut of = [[0; ROWS]; LIMBS];
    let mut row = 0;
    while row < ROWS {
        let mut place = 0;
        while place < 4 {
            of[COORDINATION[row][place]][row] = 1;
            place += 1;
        }
        row += 1;
    }
    of
}

/// (W^T W)^-1 times [`GRAM_DENOMINATOR`], W the nine signatures: each row adds four limbs, each pair of rows has one in common.
pub const GRAM_INVERSE: [[i32; ROWS]; ROWS] = [[5, -1, -1], [-1, 5, -1], [-1, -1, 5]];
/// See [`GRAM_INVERSE`].
pub const GRAM_DENOMINATOR: i32 = 18;

/// What the three rows leave of nine strains (elongation over length), to second order; `nu` is half edge over limb length.
///
/// Zero, but for terms of third order, for the strains of any pose of the mass.
#[must_use]
pub fn residual(strain: &[f64; LIMBS], nu: f64) -> [f64; ROWS] {
    parity::residual(to_kernel_order(*strain), nu, 1.0 / nu).components()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Geometry;
    use crate::paper::pose::Pose;

    #[test]
    fn gram_inverse_is_one() {
        for i in 0..ROWS {
            let mut product = [0; ROWS];
            for (k, inverse) in GRAM_INVERSE.iter().enumerate() {
                let gram: i32 = SIGNATURES.iter().map(|s| s[i] * s[k]).sum();
                for (sum, entry) in product.iter_mut().zip(inverse) {
                    *sum += gram * entry;
                }
            }
            let mut expected = [0; ROWS];
            expected[i] = GRAM_DENOMINATOR;
            assert_eq!(product, expected);
        }
    }

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
