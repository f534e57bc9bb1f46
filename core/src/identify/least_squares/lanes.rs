//! Eight rows side by side, and the two sweeps over a column that least squares spends its time in.
//!
//! Plain arrays, which the compiler turns into whatever vectors its target has. Every lane is its own sum, added up in
//! one order and never with a fused multiply-add: vectors of two, four or eight numbers give the same bits.

/// Rows in one [`Lanes`].
pub(super) const WIDTH: usize = 8;

/// One column of [`WIDTH`] rows, on a cache line of its own.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes(pub [f64; WIDTH]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; WIDTH]);

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + other.0[i]))
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] * other.0[i]))
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let Self([a, b, c, d, e, f, g, h]) = self;
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    }
}

/// Groups of [`WIDTH`] rows in a block. Twelve columns of 128 rows are 12 KiB: with the triangle they stay in a
/// first-level cache, and the adding up of lanes at the end of a sweep is little beside the sweep.
pub(super) const GROUPS: usize = 16;

/// A column of a block.
pub(super) type Column = [Lanes; GROUPS];

/// Inner products of the first `groups` of column `x` with K others: several at a time, because `x` is then read once.
#[inline(always)]
pub(super) fn dot<const K: usize>(x: &Column, columns: &[Column; K], groups: usize) -> [f64; K] {
    let mut lanes = [Lanes::ZERO; K];
    for at in 0..groups.min(GROUPS) {
        let x = x[at];
        for (sum, column) in lanes.iter_mut().zip(columns) {
            *sum = sum.plus(x.times(column[at]));
        }
    }
    let mut sums = [0.0; K];
    // Out of registers before they are added up: seeing the pairs that `sum` adds, the compiler would split the loop
    // above into pairs too, and lose a third of the speed.
    for (sum, lanes) in sums.iter_mut().zip(core::hint::black_box(lanes)) {
        *sum = lanes.sum();
    }
    sums
}

/// Adds to the first `groups` of K columns their factors times `x`.
#[inline(always)]
pub(super) fn add_scaled<const K: usize>(
    x: &Column,
    factors: [f64; K],
    columns: &mut [Column; K],
    groups: usize,
) {
    for at in 0..groups.min(GROUPS) {
        let x = x[at];
        for (column, factor) in columns.iter_mut().zip(factors) {
            column[at] = column[at].plus(Lanes([factor; WIDTH]).times(x));
        }
    }
}
