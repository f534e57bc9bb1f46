//! A square root of a covariance that may be singular.

use nalgebra::SMatrix;

use super::error_model::PARAMETRIC;
use super::parameters::Covariance;
use crate::error::{Result, require, require_not_negative};
use crate::float::sqrt;

/// Correlation that rounding may leave of a direction that is not there.
const SINGULAR: f64 = 1e-12;

/// A square root L L^T of the covariance of the parameters whose errors matter: Cholesky on the correlations, in which
/// directions without variance are left out, so that parameters known exactly or bound together do no harm.
pub(super) fn square_root(covariance: &Covariance) -> Result<SMatrix<f64, PARAMETRIC, PARAMETRIC>> {
    let mut deviation = [0.0; PARAMETRIC];
    for (i, d) in deviation.iter_mut().enumerate() {
        let variance = covariance[(i, i)];
        require_not_negative("variance of a parameter", variance)?;
        *d = sqrt(variance);
    }
    let correlation = |i: usize, j: usize| {
        if deviation[i] > 0.0 && deviation[j] > 0.0 {
            covariance[(i, j)] / deviation[i] / deviation[j]
        } else {
            0.0
        }
    };
    let mut root = SMatrix::<f64, PARAMETRIC, PARAMETRIC>::zeros();
    for j in 0..PARAMETRIC {
        for i in j..PARAMETRIC {
            let before: f64 = (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum();
            let left = correlation(i, j) - before;
            root[(i, j)] = if i == j {
                require(
                    left >= -SINGULAR && left.is_finite(),
                    "covariance of the parameters",
                    left,
                    "one whose correlations are possible together",
                )?;
                if left > SINGULAR { sqrt(left) } else { 0.0 }
            } else if root[(j, j)] > 0.0 {
                left / root[(j, j)]
            } else {
                0.0
            };
        }
    }
    for (i, d) in deviation.iter().enumerate() {
        root.row_mut(i).scale_mut(*d);
    }
    Ok(root)
}
