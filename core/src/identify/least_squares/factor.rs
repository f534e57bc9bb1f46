//! The triangle R and Q^T B of a stream of rows, a block at a time.
//!
//! Orthogonal transformations keep lengths, so that min |A x - b| depends on A and b only through what any orthogonal
//! Q leaves of them. The rows of a block are laid under the triangle of all rows before, and N Householder reflectors
//! H = 1 - tau v v^T make that a triangle again:
//!
//! ```text
//! H_N ... H_1 [ R     Q^T B ]  =  [ R'    Q'^T B' ]
//!             [ block rows  ]     [ 0     rest    ]
//! ```
//!
//! R'^T R' = R^T R + block^T block, so R' is the triangle of all rows, the same but for the signs of its rows as one
//! would get from the tall matrix at once or from rotations row by row; only the squares of `rest` are kept, they are
//! the residual. R is a triangle already, so that reflector j touches of it row j alone: v is 1 there and column j of
//! the block below. With S right sides a row costs N (N + 2 S) multiplications and as many additions, two thirds of
//! what N rotations cost, and that in sweeps down columns without a root or a division, which vectorise.
//!
//! Each column's error is a few roundings of its own length, whatever the others' (Higham, *Accuracy and Stability*,
//! theorem 19.4). Nothing is squared but in lengths, so nothing is lost of a badly conditioned A.

use core::array::from_ref;
use core::fmt;

use super::Accumulator;
use super::lanes::{Column, GROUPS, Lanes, WIDTH, add_scaled, dot};
use crate::float::sqrt;

/// Squared lengths that reflectors are made from directly: squares of column entries that matter do not vanish beside
/// them, and products with a column as long as [`super::Accumulator::solve`] admits do not overflow.
const FAIR_SQUARES: core::ops::Range<f64> = 1e-140..1e140;

/// Triangle of N columns with S right sides.
#[derive(Clone)]
pub(in crate::identify) struct Factor<const N: usize, const S: usize> {
    /// Rows of R; what is left of the diagonal stays zero.
    triangle: [[f64; N]; N],
    /// Rows of Q^T B.
    rotated: [[f64; S]; N],
    /// Sums of squares of what of each right side is orthogonal to all columns.
    residual_squares: [f64; S],
    /// Rows so far, and how many of them wait in the block.
    rows: usize,
    waiting: usize,
    columns: [Column; N],
    right_sides: [Column; S],
}

impl<const N: usize, const S: usize> Default for Factor<N, S> {
    fn default() -> Self {
        Self {
            triangle: [[0.0; N]; N],
            rotated: [[0.0; S]; N],
            residual_squares: [0.0; S],
            rows: 0,
            waiting: 0,
            columns: [[Lanes::ZERO; GROUPS]; N],
            right_sides: [[Lanes::ZERO; GROUPS]; S],
        }
    }
}

impl<const N: usize, const S: usize> Factor<N, S> {
    /// Adds one row with its right sides.
    #[inline]
    pub fn push(&mut self, row: &[f64; N], right_sides: &[f64; S]) {
        self.lay_in(row, right_sides);
        self.rows += 1;
    }

    /// Puts a row into the block and empties it when full. Blocks end where they are full and nowhere else, so that a
    /// stream has one result however it was cut.
    #[inline]
    fn lay_in(&mut self, row: &[f64; N], right_sides: &[f64; S]) {
        let (group, lane) = (self.waiting / WIDTH, self.waiting % WIDTH);
        for (column, x) in self.columns.iter_mut().zip(row) {
            column[group].0[lane] = *x;
        }
        for (column, b) in self.right_sides.iter_mut().zip(right_sides) {
            column[group].0[lane] = *b;
        }
        self.waiting += 1;
        if self.waiting == GROUPS * WIDTH {
            self.reduce(GROUPS);
        }
    }

    /// Adds the rows of another factor by way of its triangle.
    pub fn append(&mut self, other: &Self) {
        let other = other.settled();
        for (row, right_sides) in other.triangle.iter().zip(&other.rotated) {
            self.lay_in(row, right_sides);
        }
        for (sum, squares) in self.residual_squares.iter_mut().zip(other.residual_squares) {
            *sum += squares;
        }
        self.rows += other.rows;
    }

    /// The system of the last M unknowns, the others taking whatever values suit them best: the lower rows of the triangle, in
    /// which they do not occur.
    #[cfg(feature = "alloc")]
    pub fn last<const M: usize>(&self) -> Accumulator<M> {
        let settled = self.settled();
        let first = N - M;
        let mut other = Factor::<M, 1>::default();
        for (row, rotated) in settled.triangle.iter().zip(&settled.rotated).skip(first) {
            other.lay_in(&core::array::from_fn(|k| row[first + k]), &[rotated[0]]);
        }
        other.residual_squares = [settled.residual_squares[0]];
        other.rows = settled.rows - first;
        Accumulator(other)
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn triangle(&self) -> &[[f64; N]; N] {
        &self.triangle
    }

    pub fn rotated(&self) -> &[[f64; S]; N] {
        &self.rotated
    }

    pub fn residual_squares(&self) -> [f64; S] {
        self.residual_squares
    }

    /// The same with no row waiting.
    pub fn settled(&self) -> Self {
        let mut other = self.clone();
        let groups = self.waiting.div_ceil(WIDTH);
        // Rows of zeros change nothing; what is there is left of an earlier block.
        for at in self.waiting..groups * WIDTH {
            let (group, lane) = (at / WIDTH, at % WIDTH);
            for column in other.columns.iter_mut().chain(&mut other.right_sides) {
                column[group].0[lane] = 0.0;
            }
        }
        other.reduce(groups);
        other
    }

    /// One system of M unknowns out of all right sides: `combine` turns a row for right side `s` into M coefficients.
    pub fn combined<const M: usize>(
        &self,
        combine: impl Fn(usize, &[f64; N]) -> [f64; M],
    ) -> Accumulator<M> {
        let settled = self.settled();
        let mut other = Factor::<M, 1>::default();
        for (row, rotated) in settled.triangle.iter().zip(&settled.rotated) {
            for (s, b) in rotated.iter().enumerate() {
                other.lay_in(&combine(s, row), &[*b]);
            }
        }
        other.residual_squares = [settled.residual_squares.iter().sum()];
        other.rows = S * settled.rows;
        Accumulator(other)
    }

    /// Takes the first groups of the block into the triangle, with the widest vectors that pay.
    fn reduce(&mut self, groups: usize) {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        if let Some(avx2) = pulp::x86::V3::try_new() {
            // Not AVX-512: of these loops the compiler makes shuffles then, and they run at half the speed.
            pulp::Simd::vectorize(
                avx2,
                Reduction {
                    factor: self,
                    groups,
                },
            );
            return;
        }
        self.reflect::<false>(groups);
    }

    /// Reflects up to four columns at a time if there are registers for it, else up to two: a matter of speed only.
    #[inline(always)]
    fn reflect<const FOUR: bool>(&mut self, groups: usize) {
        for j in 0..N {
            let (head, columns) = self.columns.split_at_mut(j + 1);
            let (diagonal, row) = self.triangle[j][j..].split_at_mut(1);
            let Some(reflector) = Reflector::new(&mut diagonal[0], &mut head[j], groups) else {
                continue;
            };
            reflector.apply::<FOUR>(row, columns);
            reflector.apply::<FOUR>(&mut self.rotated[j], &mut self.right_sides);
        }
        for (sum, rest) in self.residual_squares.iter_mut().zip(&self.right_sides) {
            let [squares] = dot(rest, from_ref(rest), groups);
            *sum += squares;
        }
        self.waiting = 0;
    }
}

/// The work of [`Factor::reduce`] as what `pulp` compiles for one instruction set.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
struct Reduction<'a, const N: usize, const S: usize> {
    factor: &'a mut Factor<N, S>,
    groups: usize,
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl<const N: usize, const S: usize> pulp::WithSimd for Reduction<'_, N, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: pulp::Simd>(self, _: V) {
        self.factor.reflect::<true>(self.groups);
    }
}

/// H = 1 - tau v v^T with v = (1, x / pivot), which turns (diagonal, x) into (beta, 0).
struct Reflector<'a> {
    /// Column of the block, as it was: to divide it by the pivot first would be one more sweep.
    x: &'a Column,
    groups: usize,
    per_pivot: f64,
    tau: f64,
}

impl<'a> Reflector<'a> {
    /// Makes `diagonal` what the reflector makes of it; none if the column is zero already.
    #[inline(always)]
    fn new(diagonal: &mut f64, x: &'a mut Column, groups: usize) -> Option<Self> {
        let [squares] = dot(x, from_ref(x), groups);
        let squares = squares + *diagonal * *diagonal;
        if !FAIR_SQUARES.contains(&squares) {
            return Self::scaled(diagonal, x, groups);
        }
        // Away from the diagonal, so that the pivot is a sum and never cancels.
        let beta = -sqrt(squares).copysign(*diagonal);
        let pivot = *diagonal - beta;
        let tau = -pivot / beta;
        *diagonal = beta;
        Some(Self {
            x,
            groups,
            per_pivot: 1.0 / pivot,
            tau,
        })
    }

    /// The same where squares overflow or vanish, or are NaN, which nothing here takes away again.
    #[cold]
    #[inline(never)]
    fn scaled(diagonal: &mut f64, x: &'a mut Column, groups: usize) -> Option<Self> {
        let entries = || x[..groups].iter().flat_map(|lanes| lanes.0);
        let largest = entries().fold(diagonal.abs(), |largest, entry| {
            if entry.abs() <= largest || largest.is_nan() {
                largest
            } else {
                entry.abs()
            }
        });
        if largest == 0.0 {
            return None;
        }
        let head = *diagonal / largest;
        let squares: f64 = entries()
            .map(|entry| (entry / largest) * (entry / largest))
            .sum();
        let beta = -largest * sqrt(head * head + squares).copysign(*diagonal);
        let pivot = *diagonal - beta;
        let tau = -pivot / beta;
        *diagonal = beta;
        // No entry of x exceeds the pivot, so that no product with v exceeds what it is multiplied with.
        for entry in x[..groups].iter_mut().flat_map(|lanes| &mut lanes.0) {
            *entry /= pivot;
        }
        Some(Self {
            x,
            groups,
            per_pivot: 1.0,
            tau,
        })
    }

    /// Reflects columns with their entries in the triangle's row.
    #[inline(always)]
    fn apply<const FOUR: bool>(&self, heads: &mut [f64], columns: &mut [Column]) {
        let (mut heads, mut columns) = (heads, columns);
        if FOUR {
            (heads, columns) = self.apply_by::<4>(heads, columns);
        }
        (heads, columns) = self.apply_by::<2>(heads, columns);
        self.apply_by::<1>(heads, columns);
    }

    /// Reflects K columns at a time, and returns those left over.
    #[inline(always)]
    fn apply_by<'b, const K: usize>(
        &self,
        heads: &'b mut [f64],
        columns: &'b mut [Column],
    ) -> (&'b mut [f64], &'b mut [Column]) {
        let (heads, heads_left) = heads.as_chunks_mut::<K>();
        let (columns, columns_left) = columns.as_chunks_mut::<K>();
        for (heads, columns) in heads.iter_mut().zip(columns) {
            self.apply_to(heads, columns);
        }
        (heads_left, columns_left)
    }

    #[inline(always)]
    fn apply_to<const K: usize>(&self, heads: &mut [f64; K], columns: &mut [Column; K]) {
        let products = dot(self.x, columns, self.groups);
        let mut factors = [0.0; K];
        for ((head, product), factor) in heads.iter_mut().zip(products).zip(&mut factors) {
            let along = self.tau * (*head + product * self.per_pivot);
            *head -= along;
            *factor = -along * self.per_pivot;
        }
        add_scaled(self.x, factors, columns, self.groups);
    }
}

impl<const N: usize, const S: usize> Factor<N, S> {
    /// The waiting rows, one by one.
    fn waiting_rows(&self) -> impl Iterator<Item = ([f64; N], [f64; S])> {
        (0..self.waiting).map(|at| {
            let (group, lane) = (at / WIDTH, at % WIDTH);
            (
                self.columns.each_ref().map(|column| column[group].0[lane]),
                self.right_sides
                    .each_ref()
                    .map(|column| column[group].0[lane]),
            )
        })
    }
}

/// Equal after equal histories: what an emptied block still holds does not count.
impl<const N: usize, const S: usize> PartialEq for Factor<N, S> {
    fn eq(&self, other: &Self) -> bool {
        self.triangle == other.triangle
            && self.rotated == other.rotated
            && self.residual_squares == other.residual_squares
            && self.rows == other.rows
            && self.waiting_rows().eq(other.waiting_rows())
    }
}

impl<const N: usize, const S: usize> fmt::Debug for Factor<N, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Factor")
            .field("triangle", &self.triangle)
            .field("rotated", &self.rotated)
            .field("residual_squares", &self.residual_squares)
            .field("rows", &self.rows)
            .field("waiting", &WaitingRows(self))
            .finish()
    }
}

struct WaitingRows<'a, const N: usize, const S: usize>(&'a Factor<N, S>);

impl<const N: usize, const S: usize> fmt::Debug for WaitingRows<'_, N, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.waiting_rows()).finish()
    }
}
