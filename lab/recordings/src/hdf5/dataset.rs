//! The numbers of a dataset of at most two dimensions, piece by piece.

use std::path::{Path, PathBuf};

use hdf5_reader::{SliceInfo, SliceInfoElem};

use super::number::{Number, plain};
use super::refusal::refused;
use crate::error::{Error, Place, Result};
use crate::variables::Elements;

/// Elements that are read at once.
const PIECE: u64 = 1 << 16;

/// Nothing deflates by more than 1032 to 1, and samples that were never written take no room in a file at all.
const DENSEST: u64 = 1040;

/// A dataset of numbers.
pub(super) struct Dataset {
    path: PathBuf,
    dataset: hdf5_reader::Dataset,
    /// Slow and fast dimension: MATLAB's columns and rows.
    pub(super) columns: u64,
    pub(super) rows: u64,
}

/// The dataset's numbers, or a word for what it is instead; `file` is the length of its file, bytes.
///
/// # Errors
/// [`Error::Malformed`].
pub(super) fn describe(
    path: &Path,
    dataset: hdf5_reader::Dataset,
    file: u64,
) -> Result<std::result::Result<Dataset, &'static str>> {
    let stored = dataset.raw_datatype().map_err(|e| refused(path, e))?;
    if let Err(kind) = plain(dataset.dtype(), &stored) {
        return Ok(Err(kind));
    }
    let count = dataset.num_elements().map_err(|e| refused(path, e))?;
    let bytes = dataset.raw_byte_len().map_err(|e| refused(path, e))?;
    if bytes as u64 / DENSEST > file {
        let cause = format!("{count} numbers are said to be in a file of {file} bytes");
        return Err(Error::malformed(path, Place::Whole, cause));
    }
    let (columns, rows) = match (dataset.shape(), count) {
        (_, 0) => (0, 0),
        ([], _) => (1, 1),
        (&[rows], _) => (1, rows),
        (&[columns, rows], _) => (columns, rows),
        _ => return Ok(Err("of more than two dimensions")),
    };
    Ok(Ok(Dataset {
        path: path.to_owned(),
        dataset,
        columns,
        rows,
    }))
}

fn range(start: u64, count: u64) -> SliceInfoElem {
    let end = start.saturating_add(count);
    SliceInfoElem::Slice {
        start,
        end,
        step: 1,
    }
}

impl Dataset {
    /// The elements of columns and rows from a first on, each a number of them, the rows of one column after the other.
    fn read(&self, column: u64, columns: u64, row: u64, rows: u64) -> Result<Vec<Number>> {
        let selections = match self.dataset.ndim() {
            0 => Vec::new(),
            1 => vec![range(row, rows)],
            _ => vec![range(column, columns), range(row, rows)],
        };
        let values = self
            .dataset
            .read_slice::<Number>(&SliceInfo { selections })
            .map_err(|error| refused(&self.path, error))?
            .into_raw_vec_and_offset()
            .0;
        if values.len() as u64 == columns.saturating_mul(rows) {
            Ok(values)
        } else {
            let cause = "a variable of fewer numbers than its size says";
            Err(Error::malformed(&self.path, Place::Whole, cause))
        }
    }
}

impl Elements for Dataset {
    fn append(&mut self, first: u64, stride: u64, count: usize, out: &mut Vec<f64>) -> Result<()> {
        let rows = self.rows.max(1);
        let (mut column, mut row) = (first / rows, first % rows);
        let mut left = count as u64;
        // A row of a dataset that is not in chunks is read with the others, in one piece: its elements are scattered.
        let whole = self.dataset.chunks().is_none();
        while left > 0 {
            if stride == 1 && rows > 1 {
                let taken = left.min(PIECE);
                out.extend(self.read(column, 1, row, taken)?.iter().map(|n| n.0));
                row += taken;
                left -= taken;
            } else {
                let (from, width) = if whole { (0, rows) } else { (row, 1) };
                let taken = left.min((PIECE / width).max(1));
                let values = self.read(column, taken, from, width)?;
                let step = usize::try_from(width).unwrap_or(usize::MAX);
                let of_row = values.iter().skip((row - from) as usize).step_by(step);
                out.extend(of_row.map(|n| n.0));
                column += taken;
                left -= taken;
            }
        }
        Ok(())
    }
}
