//! Streaming orthogonal least squares: the pseudo-inverse of (14) and (19) without ever holding a tall matrix.
//!
//! Rows wait in a block of fixed size; N Householder reflectors take a full block into a triangle R and Q^T b, the only
//! other state (derived in `factor`). The singular values of the column-scaled triangle are those of the column-scaled tall
//! matrix; rank, conditioning and covariance are read from them. Never through A^T A, which would square the condition.
//!
//! Memory is constant, 10 KiB for nine unknowns, and nothing is allocated. The result depends on the rows and their
//! order alone: not on how they were split, nor on how wide the machine's vectors are.

pub(in crate::identify) mod factor;
pub(crate) mod gauss_newton;
mod lanes;

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, DimDiff, DimMin, DimSub, SMatrix, SVector, U1};

use self::factor::Factor;
use crate::error::{Error, Result, require_samples};
use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Column-scaled condition number at which a direction counts as lost. With rounding at 1e-16 four digits are left of
/// that direction, with a 60 dB channel none; a healthy campaign stays below 1e3.
pub const CONDITION_LIMIT: f64 = 1e8;

/// Relative off-diagonal size the singular value iteration is asked for.
const SVD_TOLERANCE: f64 = 1e-15;
/// Cap of that iteration; it takes about two sweeps per column.
const SVD_ITERATIONS: usize = 500;

/// Solution of a linear least-squares problem with N unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<const N: usize> {
    /// The unknowns.
    pub values: [f64; N],
    /// Covariance of the unknowns under independent, equal noise on the right side.
    pub covariance: SMatrix<f64, N, N>,
    /// (A^T A)^-1 of the regressor A: the covariance under unit noise on the right side.
    pub inverse_normal: SMatrix<f64, N, N>,
    /// Root mean square residual with the degrees of freedom taken off, in the right side's unit.
    pub residual_rms: f64,
    /// Condition number of the regressor with its columns scaled to unit length.
    pub condition: f64,
    /// Number of rows.
    pub rows: usize,
}

impl<const N: usize> Estimate<N> {
    /// Standard error of each unknown: the root of the covariance's diagonal.
    #[must_use]
    pub fn standard_error(&self) -> [f64; N] {
        core::array::from_fn(|i| sqrt(self.covariance[(i, i)].max(0.0)))
    }
}

/// Accumulates rows of a linear system with N unknowns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Accumulator<const N: usize>(Factor<N, 1>);

impl<const N: usize> Accumulator<N> {
    /// Adds one equation `row . x = right_side`. One that is not finite is not refused here but by [`Self::solve`].
    #[inline]
    pub fn push(&mut self, row: [f64; N], right_side: f64) {
        self.0.push(&row, &[right_side]);
    }

    /// Adds all equations of another system in the same unknowns.
    ///
    /// Works on its triangle, so the cost does not depend on how many they are, and equals pushing them one by one up
    /// to rounding.
    pub fn append(&mut self, other: &Self) {
        self.0.append(&other.0);
    }

    /// Number of equations so far.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.0.rows()
    }

    /// The problem with its N unknowns expressed by M others: `combine` turns a row of N coefficients into one of M.
    ///
    /// Works on the triangle, so its cost does not depend on the number of rows, and equals pushing the combined rows
    /// one by one up to rounding.
    #[must_use]
    pub fn combined<const M: usize>(
        &self,
        combine: impl Fn(&[f64; N]) -> [f64; M],
    ) -> Accumulator<M> {
        self.0.combined(|_, row| combine(row))
    }
}

impl<const N: usize> Accumulator<N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>> + DimSub<U1>,
    DefaultAllocator: Allocator<DimDiff<Const<N>, U1>>,
{
    /// Solves for the N unknowns.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] for fewer rows than unknowns plus one, [`Error::OutOfRange`] if a row held NaN or
    /// infinity or is of a size that leaves no finite solution, [`Error::RankDeficient`] with the lost direction, [`Error::NotConverged`].
    pub fn solve(&self, what: &'static str) -> Result<Estimate<N>> {
        let rows = self.rows();
        require_samples(what, N + 1, rows)?;
        let factor = self.0.settled();
        // nalgebra wants columns.
        let triangle = SMatrix::<f64, N, N>::from(*factor.triangle()).transpose();
        let rotated = SVector::<f64, N>::from(factor.rotated().map(|[b]| b));
        let [residual_squares] = factor.residual_squares();
        let column_norm: [f64; N] = core::array::from_fn(|j| triangle.column(j).norm());
        let finite = column_norm.iter().chain(rotated.iter()).sum::<f64>();
        let out_of_range = |value| {
            Error::out_of_range(
                what,
                value,
                "fed with finite rows whose squares neither overflow nor vanish",
            )
        };
        if !(finite + residual_squares).is_finite() {
            return Err(out_of_range(finite));
        }
        // An unknown that nothing excites keeps its zero column; scaling must not turn it into NaN.
        let scale = SVector::from(column_norm.map(|n| if n > 0.0 { 1.0 / n } else { 1.0 }));
        let scaled = triangle * SMatrix::<f64, N, N>::from_diagonal(&scale);
        let (v_t, singular) = scaled
            .try_svd(false, true, SVD_TOLERANCE, SVD_ITERATIONS)
            .and_then(|svd| Some((svd.v_t?, svd.singular_values)))
            .ok_or(Error::NotConverged {
                what,
                iterations: SVD_ITERATIONS,
            })?;
        let largest = singular[0];
        let smallest = singular[N - 1];
        let condition = if smallest > 0.0 {
            largest / smallest
        } else {
            f64::INFINITY
        };
        if condition.is_nan() || condition >= CONDITION_LIMIT {
            // Back from scaled columns to the unknowns themselves.
            let lost: [f64; N] = core::array::from_fn(|j| scale[j] * v_t[(N - 1, j)]);
            let length = sqrt(lost.iter().map(|x| x * x).sum());
            let mut lost_direction = [0.0; LIMBS];
            for (out, component) in lost_direction.iter_mut().zip(lost) {
                *out = component / length;
            }
            return Err(Error::RankDeficient {
                what,
                unknowns: N,
                rank: singular
                    .iter()
                    .filter(|s| **s * CONDITION_LIMIT > largest)
                    .count(),
                condition,
                lost_direction,
            });
        }
        // Not by singular vectors: where singular values cluster, as they do in a good campaign, iteration leaves
        // 1e-10 of one vector in another.
        let pseudo = SMatrix::<f64, N, N>::from_diagonal(&scale) * inverse_of_triangle(&scaled);
        let x = pseudo * rotated;
        let variance = residual_squares / (rows - N) as f64;
        let inverse_normal = pseudo * pseudo.transpose();
        let covariance = inverse_normal * variance;
        let answer = x.iter().chain(covariance.iter()).sum::<f64>();
        if !answer.is_finite() {
            return Err(out_of_range(answer));
        }
        Ok(Estimate {
            values: core::array::from_fn(|i| x[i]),
            covariance,
            inverse_normal,
            residual_rms: sqrt(variance),
            condition,
            rows,
        })
    }
}

/// Inverse of a regular upper triangle, column by column by back substitution.
fn inverse_of_triangle<const N: usize>(triangle: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let mut inverse = SMatrix::zeros();
    for column in 0..N {
        inverse[(column, column)] = 1.0 / triangle[(column, column)];
        for row in (0..column).rev() {
            let sum: f64 = (row + 1..=column)
                .map(|k| triangle[(row, k)] * inverse[(k, column)])
                .sum();
            inverse[(row, column)] = -sum / triangle[(row, row)];
        }
    }
    inverse
}
