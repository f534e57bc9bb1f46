//! Nine columns of voltages: how samples go from a file to the decoder.

use std::ops::Range;

use sixaxis_core::LIMBS;

use super::Row;

/// Voltages of consecutive samples, V, a column a limb, all of one length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Voltages {
    /// The columns.
    pub columns: [Vec<f64>; LIMBS],
}

impl Voltages {
    /// Samples.
    pub fn samples(&self) -> usize {
        self.columns[0].len()
    }

    /// A sample's nine voltages.
    pub fn row(&self, sample: usize) -> Row {
        self.columns.each_ref().map(|column| column[sample])
    }

    /// The samples one by one.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        (0..self.samples()).map(|sample| self.row(sample))
    }

    /// Some of the samples.
    pub fn part(&self, samples: Range<usize>) -> [&[f64]; LIMBS] {
        self.columns
            .each_ref()
            .map(|column| &column[samples.clone()])
    }

    /// All of them.
    pub fn all(&self) -> [&[f64]; LIMBS] {
        self.part(0..self.samples())
    }

    /// Appends a sample.
    pub fn push(&mut self, row: &Row) {
        for (column, voltage_v) in self.columns.iter_mut().zip(row) {
            column.push(*voltage_v);
        }
    }

    /// Moves all samples of `other` behind these: as they lie, where there are none.
    pub fn append(&mut self, other: &mut Self) {
        if self.samples() == 0 {
            std::mem::swap(self, other);
            other.clear();
            return;
        }
        for (column, more) in self.columns.iter_mut().zip(&mut other.columns) {
            column.append(more);
        }
    }

    /// Removes the first samples.
    pub fn remove_first(&mut self, samples: usize) {
        for column in &mut self.columns {
            column.drain(..samples);
        }
    }

    /// Removes all, keeping the memory.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
    }
}

impl<'a> FromIterator<&'a Row> for Voltages {
    fn from_iter<I: IntoIterator<Item = &'a Row>>(rows: I) -> Self {
        let mut voltages = Self::default();
        rows.into_iter().for_each(|row| voltages.push(row));
        voltages
    }
}
