//! Steps 2 and 3 as the paper prints them: the tall matrix of (13) or (18) and its pseudo-inverse, (14) or (19), with nalgebra.
//!
//! Timed beside [`sixaxis_core::identify`], which streams rows into a triangle and returns covariance and condition as well. In
//! step 3 that triangle has twelve columns, for the gyroscope's gain to be found from, where (18) has six.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::regressor;
use sixaxis_core::{Geometry, LIMBS};

use sixaxis_props::problem::recorded::{InertiaRows, ScaleRows};

/// Singular values below this share of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-12;

fn pseudo_inverse<const N: usize>(matrix: DMatrix<f64>, right_side: &DVector<f64>) -> [f64; N] {
    let svd = matrix.svd(true, true);
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let x = svd
        .solve(right_side, tolerance)
        .expect("singular vectors were asked for");
    core::array::from_fn(|i| x[i])
}

/// Step 2 by (13) and (14): s_i/m, 1/kg.
///
/// # Panics
/// Never: the singular vectors are computed.
pub fn scale_per_mass(rows: &ScaleRows) -> [f64; LIMBS] {
    let n = rows.0.len();
    let mut matrix = DMatrix::zeros(3 * n, LIMBS);
    let mut right_side = DVector::zeros(3 * n);
    for (k, (force, acceleration)) in rows.0.iter().enumerate() {
        for axis in 0..3 {
            for i in 0..LIMBS {
                matrix[(3 * k + axis, i)] = force[i] * DIRECTIONS_SHELL[i][axis];
            }
            right_side[3 * k + axis] = acceleration[axis];
        }
    }
    pseudo_inverse(matrix, &right_side)
}

/// Step 3 by (18) and (19): I1 to I6 over m, m^2.
///
/// # Panics
/// Never: the singular vectors are computed.
pub fn inertia_per_mass(rows: &InertiaRows) -> [f64; 6] {
    let n = rows.0.len();
    let hinges = Geometry::PAPER.mass_hinges_m();
    let mut matrix = DMatrix::zeros(3 * n, 6);
    let mut right_side = DVector::zeros(3 * n);
    for (k, (force, rate, derivative)) in rows.0.iter().enumerate() {
        let torque: DVec3 = (0..LIMBS)
            .map(|i| force[i] * hinges[i].cross(DIRECTIONS_SHELL[i]))
            .sum();
        for (axis, row) in regressor(*rate, *derivative).iter().enumerate() {
            for (i, entry) in row.iter().enumerate() {
                matrix[(3 * k + axis, i)] = *entry;
            }
            right_side[3 * k + axis] = torque[axis];
        }
    }
    pseudo_inverse(matrix, &right_side)
}
