//! The largest squares of a chunk: whether series and polynomials hold for all of it.

use crate::kernel::simd::{Register, Row};

/// How large the squares of a chunk are, stream by stream.
#[derive(Clone, Copy)]
pub struct Extent<T> {
    largest: T,
    /// NaN if one of them is: the largest of a number and NaN may be the number.
    sum: T,
}

impl<T: Copy> Extent<T> {
    #[inline(always)]
    pub fn of(zero: T) -> Self {
        Self {
            largest: zero,
            sum: zero,
        }
    }
}

impl<R: Register> Extent<R> {
    #[inline(always)]
    pub fn with(self, square: R) -> Self {
        Self {
            largest: square.larger(self.largest),
            sum: self.sum + square,
        }
    }

    #[inline(always)]
    pub fn store(self, rows: &mut Extent<Row>, part: usize) {
        self.largest.store(&mut rows.largest, part);
        self.sum.store(&mut rows.sum, part);
    }
}

impl Extent<Row> {
    /// Whether every square is; NaN is not.
    pub fn is_at_most(&self, limit: f64) -> bool {
        let Row(largest) = self.largest;
        let Row(sum) = self.sum;
        largest.iter().all(|x| *x <= limit) && !sum.iter().any(|x| x.is_nan())
    }
}
