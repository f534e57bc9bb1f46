//! By how much errors go back over a block of the [smoother](super::smoother): rows of Rauch, Tung and Striebel's gain C = Phi^-1 (1 - Q (P+)^-1), of
//! the errors that have had noise meanwhile.

use nalgebra::{Cholesky, SMatrix, SVector};

use super::filter::{CORRECTED, ErrorCovariance, Wandered, ZEROS};
use super::model::{DYNAMIC, Dynamics, ERRORS, PARAMETRIC, times};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Errors that have noise where zeros wander: the dynamic ones, and those of the zeros.
pub(super) const DRIVEN: usize = DYNAMIC + LIMBS;
/// Added to the correlation of each error with itself: some are known by others, drifts by down at the first sample.
const JITTER: f64 = 1e-12;

type Rows<const N: usize> = SMatrix<f64, N, ERRORS>;

/// Of the errors that have dynamics, by the covariance after the block.
pub(super) fn of_dynamic(
    predicted: &ErrorCovariance,
    by_errors: &Rows<DYNAMIC>,
    noise: &Dynamics,
) -> Rows<DYNAMIC> {
    let lost = weight(predicted).map(|weight| times(noise, &weight));
    lost.and_then(|lost| before(by_errors, &lost))
        .unwrap_or_else(SMatrix::zeros)
}

/// The same and of the zeros, which a transition leaves as they are.
pub(super) fn where_zeros_wander(
    predicted: &ErrorCovariance,
    by_errors: &Rows<DYNAMIC>,
    noise: &SMatrix<f64, DRIVEN, DRIVEN>,
) -> Rows<DRIVEN> {
    let rows = weight(predicted).and_then(|weight| {
        let lost = times(noise, &weight);
        let of_zeros = lost.fixed_rows::<LIMBS>(ZEROS).into_owned();
        let by_zeros = by_errors.fixed_columns::<LIMBS>(ZEROS).into_owned();
        let of_dynamic = lost.fixed_rows::<DYNAMIC>(0) - times(&by_zeros, &of_zeros);
        let mut rows = lost * -1.0;
        rows.fixed_rows_mut::<DYNAMIC>(0)
            .copy_from(&before(by_errors, &of_dynamic)?);
        let mut own = rows.fixed_view_mut::<LIMBS, LIMBS>(ZEROS, ZEROS);
        own += SMatrix::<f64, LIMBS, LIMBS>::identity();
        Some(rows)
    });
    rows.unwrap_or_else(SMatrix::zeros)
}

/// Q where zeros wander.
pub(super) fn noise_where_zeros_wander(
    noise: &Dynamics,
    wandered: &Wandered,
) -> SMatrix<f64, DRIVEN, DRIVEN> {
    let Wandered {
        variance_v2,
        shared,
    } = wandered;
    let mut all = SMatrix::<f64, DRIVEN, DRIVEN>::zeros();
    all.fixed_view_mut::<DYNAMIC, DYNAMIC>(0, 0)
        .copy_from(noise);
    all.fixed_view_mut::<DYNAMIC, LIMBS>(0, ZEROS)
        .copy_from(shared);
    all.fixed_view_mut::<LIMBS, DYNAMIC>(ZEROS, 0)
        .copy_from(&shared.transpose());
    all.fixed_view_mut::<LIMBS, LIMBS>(ZEROS, ZEROS)
        .set_diagonal(&SVector::from(*variance_v2));
    all
}

/// Dynamic errors before a block, what noise has done to them taken off; nothing where no transition leads back.
fn before(by_errors: &Rows<DYNAMIC>, lost: &Rows<DYNAMIC>) -> Option<Rows<DYNAMIC>> {
    let by_dynamic = by_errors.fixed_columns::<DYNAMIC>(0).into_owned();
    let mut left = lost * -1.0;
    let mut own = left.fixed_columns_mut::<DYNAMIC>(0);
    own += Dynamics::identity();
    let mut parametric = left.fixed_columns_mut::<PARAMETRIC>(DYNAMIC);
    parametric -= by_errors.fixed_columns::<PARAMETRIC>(DYNAMIC);
    Some(times(&by_dynamic.try_inverse()?, &left))
}

/// Rows of the inverse of a covariance of the errors that are corrected: of the first of them.
fn weight<const ROWS: usize>(covariance: &ErrorCovariance) -> Option<Rows<ROWS>> {
    let over_deviation = SVector::<f64, CORRECTED>::from_fn(|i, _| {
        let variance = covariance[(i, i)];
        if variance > 0.0 {
            1.0 / sqrt(variance)
        } else {
            0.0
        }
    });
    let correlation = SMatrix::<f64, CORRECTED, CORRECTED>::from_fn(|i, j| {
        if i == j {
            1.0 + JITTER
        } else {
            covariance[(i, j)] * over_deviation[i] * over_deviation[j]
        }
    });
    let mut solved =
        SMatrix::<f64, CORRECTED, ROWS>::from_fn(
            |i, j| {
                if i == j { over_deviation[i] } else { 0.0 }
            },
        );
    Cholesky::new(correlation)?.solve_mut(&mut solved);
    let mut weight = SMatrix::<f64, ROWS, ERRORS>::zeros();
    weight
        .fixed_columns_mut::<CORRECTED>(0)
        .copy_from(&SMatrix::<f64, ROWS, CORRECTED>::from_fn(|i, j| {
            solved[(j, i)] * over_deviation[j]
        }));
    Some(weight)
}
