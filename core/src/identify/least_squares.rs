//! Streaming orthogonal least squares: the pseudo-inverse of (14) and (19) without ever holding a tall matrix.
//!
//! Rows are rotated by Givens into a triangle R, Q^T b, the only state. The singular values of the column-scaled
//! triangle are those of the column-scaled tall matrix; rank, conditioning and covariance are read from them.

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, DimDiff, DimMin, DimSub, SMatrix, SVector, U1};

use crate::error::{Error, Result};
use crate::geometry::LIMBS;
use crate::scalar::sqrt;

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
#[derive(Debug, Clone, PartialEq)]
pub struct Accumulator<const N: usize> {
    /// Upper triangle R.
    triangle: SMatrix<f64, N, N>,
    /// Q^T b.
    rotated: SVector<f64, N>,
    /// Sum of squares of what is orthogonal to all columns.
    residual_squares: f64,
    rows: usize,
}

impl<const N: usize> Default for Accumulator<N> {
    fn default() -> Self {
        Self {
            triangle: SMatrix::zeros(),
            rotated: SVector::zeros(),
            residual_squares: 0.0,
            rows: 0,
        }
    }
}

impl<const N: usize> Accumulator<N> {
    /// Adds one equation `row . x = right_side`. One that is not finite is not refused here but by [`Self::solve`].
    pub fn push(&mut self, row: [f64; N], right_side: f64) {
        let mut row = row;
        let mut b = right_side;
        for j in 0..N {
            let x = row[j];
            if x == 0.0 {
                continue;
            }
            let r = self.triangle[(j, j)];
            let norm = hypot(r, x);
            let (c, s) = (r / norm, x / norm);
            for (k, entry) in row.iter_mut().enumerate().skip(j) {
                let upper = self.triangle[(j, k)];
                self.triangle[(j, k)] = c * upper + s * *entry;
                *entry = c * *entry - s * upper;
            }
            let upper = self.rotated[j];
            self.rotated[j] = c * upper + s * b;
            b = c * b - s * upper;
        }
        self.residual_squares += b * b;
        self.rows += 1;
    }

    /// Number of equations so far.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The problem with its N unknowns expressed by M others: `combine` turns a row of N coefficients into one of M.
    ///
    /// Works on the triangle, so its cost does not depend on the number of rows, and equals pushing the combined rows
    /// one by one.
    #[must_use]
    pub fn combined<const M: usize>(
        &self,
        combine: impl Fn(&[f64; N]) -> [f64; M],
    ) -> Accumulator<M> {
        let mut other = Accumulator::default();
        for i in 0..N {
            let row = core::array::from_fn(|j| self.triangle[(i, j)]);
            other.push(combine(&row), self.rotated[i]);
        }
        other.residual_squares += self.residual_squares;
        other.rows = self.rows;
        other
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
        if self.rows <= N {
            return Err(Error::TooFewSamples {
                what,
                needed: N + 1,
                got: self.rows,
            });
        }
        let column_norm: [f64; N] = core::array::from_fn(|j| self.triangle.column(j).norm());
        let finite = column_norm.iter().chain(self.rotated.iter()).sum::<f64>();
        let out_of_range = |value| Error::OutOfRange {
            name: what,
            value,
            requirement: "fed with finite rows whose squares neither overflow nor vanish",
        };
        if !(finite + self.residual_squares).is_finite() {
            return Err(out_of_range(finite));
        }
        // An unknown that nothing excites keeps its zero column; scaling must not turn it into NaN.
        let scale = SVector::from(column_norm.map(|n| if n > 0.0 { 1.0 / n } else { 1.0 }));
        let scaled = self.triangle * SMatrix::<f64, N, N>::from_diagonal(&scale);
        let svd = scaled
            .try_svd(true, true, SVD_TOLERANCE, SVD_ITERATIONS)
            .ok_or(Error::NotConverged {
                what,
                iterations: SVD_ITERATIONS,
            })?;
        let (Some(u), Some(v_t), singular) = (svd.u, svd.v_t, svd.singular_values) else {
            return Err(Error::NotConverged {
                what,
                iterations: SVD_ITERATIONS,
            });
        };
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
        let inverse = SMatrix::<f64, N, N>::from_diagonal(&singular.map(|s| 1.0 / s));
        let pseudo = SMatrix::<f64, N, N>::from_diagonal(&scale) * v_t.transpose() * inverse;
        let x = pseudo * (u.transpose() * self.rotated);
        let variance = self.residual_squares / (self.rows - N) as f64;
        let covariance = pseudo * pseudo.transpose() * variance;
        let answer = x.iter().chain(covariance.iter()).sum::<f64>();
        if !answer.is_finite() {
            return Err(out_of_range(answer));
        }
        Ok(Estimate {
            values: core::array::from_fn(|i| x[i]),
            covariance,
            residual_rms: sqrt(variance),
            condition,
            rows: self.rows,
        })
    }
}

/// Root of a^2 + b^2, also where the squares overflow or vanish.
fn hypot(a: f64, b: f64) -> f64 {
    let squares = a * a + b * b;
    if squares.is_normal() {
        return sqrt(squares);
    }
    let larger = a.abs().max(b.abs());
    let (a, b) = (a / larger, b / larger);
    larger * sqrt(a * a + b * b)
}
