//! The channels' noise from the residuals of the parity rows, which are free of any signal.
//!
//! The noise n of the block means leaves residuals r = W^T C n in the rows, whose covariance is
//!
//! ```text
//! Q = | v1+v5+v2+v4     v1            v5        |
//!     |     v1      v1+v9+v3+v7       v9        |,     v_i = c_i^2 var n_i.
//!     |     v5          v9        v5+v9+v6+v8   |
//! ```
//!
//! Six numbers determine v1, v5, v9 and the sum of each ambiguous pair. The sum is divided in proportion to the second differences of
//! the pair's samples, in which motion below a hundredth of the sample rate is a millionth; this assumes noise of like spectrum.

use nalgebra::Matrix3;

use crate::geometry::LIMBS;
use crate::redundancy::parity::{AMBIGUOUS_PAIRS, ROWS, SIGNATURES};

/// Limbs that stand in two rows, and those rows.
const SHARED: [(usize, usize, usize); ROWS] = [(0, 0, 1), (4, 0, 2), (8, 1, 2)];
/// Least share of a row's variance that a channel is taken to have, so that chance makes no variance negative.
const LEAST_SHARE: f64 = 1e-3;

/// v_i from the covariance of the rows' residuals; `size` is c_i^2 times a channel's noise in
/// any unit, squared.
pub(super) fn variances(rows: &Matrix3<f64>, size: &[f64; LIMBS]) -> [f64; LIMBS] {
    let mut v = [0.0; LIMBS];
    let mut left = [rows[(0, 0)], rows[(1, 1)], rows[(2, 2)]];
    for (limb, a, b) in SHARED {
        let least = LEAST_SHARE * rows[(a, a)].min(rows[(b, b)]);
        v[limb] = rows[(a, b)].max(least);
        left[a] -= v[limb];
        left[b] -= v[limb];
    }
    for (row, [i, j]) in AMBIGUOUS_PAIRS.into_iter().enumerate() {
        let both = left[row].max(2.0 * LEAST_SHARE * rows[(row, row)]);
        let share = size[i] / (size[i] + size[j]);
        let share = if share.is_finite() {
            share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE)
        } else {
            0.5
        };
        v[i] = both * share;
        v[j] = both * (1.0 - share);
    }
    v
}

/// Q.
pub(super) fn of_rows(v: &[f64; LIMBS]) -> Matrix3<f64> {
    Matrix3::from_fn(|a, b| {
        v.iter()
            .zip(&SIGNATURES)
            .map(|(v, signature)| v * f64::from(signature[a] * signature[b]))
            .sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_found_from_the_rows() {
        let v = [1.0, 0.3, 0.2, 0.6, 2.0, 0.4, 0.2, 0.7, 0.6];
        let found = variances(&of_rows(&v), &v.map(|v| 7.0 * v));
        for (found, v) in found.iter().zip(v) {
            assert!((found - v).abs() < 8.0 * f64::EPSILON, "{found} {v}");
        }
    }
}
