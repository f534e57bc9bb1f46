//! Rows as blocks.

use std::path::{Path, PathBuf};

use super::dialect::{Decimal, excerpt, number, split};
use super::head::{self, Table, is_blank, is_comment};
use super::lines::Lines;
use crate::channel::Layout;
use crate::error::{Error, Place, Result};
use crate::source::{Decoder, Source, reading};

/// Opens a file of text, gzip or not.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let (layout, table) = head::read(path)?;
    let text = Text {
        path: path.to_owned(),
        table,
    };
    Ok(reading(path, layout, text))
}

/// A file of text, open for reading.
struct Text {
    path: PathBuf,
    table: Table,
}

/// Somewhere in the rows.
struct Rows {
    lines: Lines,
    decimal: Decimal,
    cells: Vec<(usize, usize)>,
    /// Columns of the block that each channel goes to; none if it is not parsed.
    targets: Vec<Vec<usize>>,
    scratch: String,
}

impl Decoder for Text {
    type Position = Rows;

    fn start(&mut self, layout: &Layout, selected: &[usize], _samples: u64) -> Result<Rows> {
        let mut targets = vec![Vec::new(); layout.channels.len()];
        for (column, &channel) in selected.iter().enumerate() {
            targets[channel].push(column);
        }
        let mut lines = Lines::open(&self.path)?;
        for _ in 1..self.table.first_line {
            lines.next()?;
        }
        Ok(Rows {
            lines,
            decimal: self.table.dialect.decimal,
            cells: Vec::new(),
            targets,
            scratch: String::new(),
        })
    }

    fn next(
        &mut self,
        at: &mut Rows,
        _layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize> {
        let mut rows = 0;
        while rows < limit && self.row(at, columns)? {
            rows += 1;
        }
        Ok(rows)
    }
}

impl Text {
    /// Appends the next row; false at the end.
    fn row(&self, rows: &mut Rows, columns: &mut [Vec<f64>]) -> Result<bool> {
        let table = &self.table;
        loop {
            let Some((at, line)) = rows.lines.next()? else {
                return Ok(false);
            };
            if is_comment(line) || is_blank(line) || (table.loose && line.trim_ascii().is_empty()) {
                continue;
            }
            let malformed = |place, cause: String| Error::malformed(&self.path, place, cause);
            split(line, table.dialect.separator, &mut rows.cells)
                .map_err(|cause| malformed(Place::Line(at), cause.to_owned()))?;
            let (found, expected) = (rows.cells.len(), &table.cells);
            if !expected.contains(&found) {
                let cause = format!("{found} columns, {} were expected", expected.start());
                return Err(malformed(Place::Line(at), cause));
            }
            let cells = rows.cells.iter().enumerate().skip(table.first_cell);
            for ((cell_at, &(begin, end)), targets) in cells.zip(&rows.targets) {
                if targets.is_empty() {
                    continue;
                }
                let cell = line.get(begin..end).unwrap_or_default();
                let Some(value) = number(cell, &mut rows.decimal, &mut rows.scratch) else {
                    let cause = not_a_number(cell, rows.decimal);
                    return Err(malformed(Place::Cell(at, cell_at + 1), cause));
                };
                targets
                    .iter()
                    .for_each(|&target| columns[target].push(value));
            }
            return Ok(true);
        }
    }
}

fn not_a_number(cell: &[u8], decimal: Decimal) -> String {
    if cell.is_empty() {
        return "an empty cell; write missing values as nan".to_owned();
    }
    let sign = match decimal {
        Decimal::Comma => "comma",
        Decimal::Point | Decimal::Open => "point",
    };
    format!(
        "{} is not a number (decimal sign: {sign}, no thousands separators)",
        excerpt(cell)
    )
}
