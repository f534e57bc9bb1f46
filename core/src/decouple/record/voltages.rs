//! Voltages as rows or as columns: what a block takes its samples from.

use super::series::BLOCK;
use crate::geometry::LIMBS;

/// Nine voltages of consecutive samples.
pub trait Voltages {
    /// Samples.
    fn len(&self) -> usize;

    /// Nine voltages of a sample.
    fn row(&self, sample: usize) -> [f64; LIMBS];

    /// Nine columns of the [`BLOCK`] samples from this one on; what has to be moved for them is moved to `room`.
    fn block<'a>(&'a self, first: usize, room: &'a mut Room) -> [&'a [f64]; LIMBS];
}

/// Room for the columns of a block.
pub type Room = [[f64; BLOCK]; LIMBS];

impl Voltages for &[[f64; LIMBS]] {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn row(&self, sample: usize) -> [f64; LIMBS] {
        self[sample]
    }

    fn block<'a>(&'a self, first: usize, room: &'a mut Room) -> [&'a [f64]; LIMBS] {
        let rows = &self[first..first + BLOCK];
        for (sample, row) in rows.iter().enumerate() {
            for (column, value) in room.iter_mut().zip(row) {
                column[sample] = *value;
            }
        }
        room.each_ref().map(|column| &column[..])
    }
}

/// Columns of one length.
pub struct Columns<'v>(pub [&'v [f64]; LIMBS]);

impl Voltages for Columns<'_> {
    fn len(&self) -> usize {
        self.0[0].len()
    }

    fn row(&self, sample: usize) -> [f64; LIMBS] {
        self.0.map(|column| column[sample])
    }

    fn block<'a>(&'a self, first: usize, _: &'a mut Room) -> [&'a [f64]; LIMBS] {
        self.0.map(|column| &column[first..first + BLOCK])
    }
}
