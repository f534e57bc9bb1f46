//! A square root of a covariance that may be singular.

use nalgebra::SMatrix;

use super::parameters::Covariance;
use crate::error::{Error, Result};
use crate::float::sqrt;
use crate::parameter::INERTIA;

/// Parameters whose errors are carried to samples: all but the compliance.
pub(super) const CARRIED: usize = INERTIA.end;

/// Correlation that rounding may leave of a direction that is not there.
const SINGULAR: f64 = 1e-12;

/// A square root L L^T of the covariance of the parameters that are carried: Cholesky on the correlations, in which
/// directions without variance are left out, so that parameters known exactly or bound together do no harm.
pub(super) fn square_root(covariance: &Covariance) -> Result<SMatrix<f64, CARRIED, CARRIED>> {
    let mut deviation = [0.0; CARRIED];
    for (i, d) in deviation.iter_mut().enumerate() {
        let variance = covariance[(i, i)];
        if !(variance.is_finite() && variance >= 0.0) {
            return Err(out_of_range(
                "variance of a parameter",
                variance,
                "finite and not negative",
            ));
        }
        *d = sqrt(variance);
    }
    let correlation = |i: usize, j: usize| {
        if deviation[i] > 0.0 && deviation[j] > 0.0 {
            covariance[(i, j)] / deviation[i] / deviation[j]
        } else {
            0.0
        }
    };
    let mut root = SMatrix::<f64, CARRIED, CARRIED>::zeros();
    for j in 0..CARRIED {
        for i in j..CARRIED {
            let before: f64 = (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum();
            let left = correlation(i, j) - before;
            root[(i, j)] = if i == j {
                if left < -SINGULAR || !left.is_finite() {
                    return Err(out_of_range(
                        "covariance of the parameters",
                        left,
                        "one whose correlations are possible together",
                    ));
                }
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

pub(super) fn out_of_range(name: &'static str, value: f64, requirement: &'static str) -> Error {
    Error::out_of_range(name, value, requirement)
}
