//! Rows as blocks.

use std::path::{Path, PathBuf};

use super::dialect::{Decimal, excerpt, number, split};
use super::head::{self, Table, is_blank, is_comment};
use super::lines::Lines;
use crate::channel::{Block, Layout};
use crate::error::{Error, Place, Result};
use crate::source::Source;

/// A file of text, open for reading.
pub struct TextSource {
    path: PathBuf,
    table: Table,
    /// Channels to be read, in this order.
    selected: Vec<usize>,
    state: State,
}

enum State {
    /// Nothing read since the selection.
    Fresh,
    /// Somewhere in the rows.
    Reading(Box<Rows>),
    /// A row could not be read; what follows would be out of step.
    Failed,
}

struct Rows {
    lines: Lines,
    decimal: Decimal,
    cells: Vec<(usize, usize)>,
    /// Which channels are parsed.
    needed: Vec<bool>,
    values: Vec<f64>,
    scratch: String,
}

impl TextSource {
    /// Opens a file and reads its head.
    ///
    /// # Errors
    /// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
    pub fn open(path: &Path) -> Result<Self> {
        let table = head::read(path)?;
        Ok(Self {
            path: path.to_owned(),
            selected: (0..table.layout.channels.len()).collect(),
            table,
            state: State::Fresh,
        })
    }

    fn start(&self) -> Result<Box<Rows>> {
        let channels = self.table.layout.channels.len();
        let mut needed = vec![false; channels];
        for &channel in &self.selected {
            if let Some(needed) = needed.get_mut(channel) {
                *needed = true;
            }
        }
        let mut lines = Lines::open(&self.path)?;
        for _ in 1..self.table.first_line {
            lines.next()?;
        }
        Ok(Box::new(Rows {
            lines,
            decimal: self.table.dialect.decimal,
            cells: Vec::new(),
            needed,
            values: vec![0.0; channels],
            scratch: String::new(),
        }))
    }
}

impl Rows {
    /// Reads the next row into `values`; false at the end.
    fn next(&mut self, path: &Path, table: &Table) -> Result<bool> {
        loop {
            let Some((at, line)) = self.lines.next()? else {
                return Ok(false);
            };
            if is_comment(line) || is_blank(line) || (table.loose && line.trim_ascii().is_empty()) {
                continue;
            }
            split(line, table.dialect.separator, &mut self.cells)
                .map_err(|cause| Error::malformed(path, Place::Line(at), cause))?;
            if !table.cells.contains(&self.cells.len()) {
                let cause = format!(
                    "{} columns, {} were expected",
                    self.cells.len(),
                    table.cells.start()
                );
                return Err(Error::malformed(path, Place::Line(at), cause));
            }
            let cells = self.cells.iter().enumerate().skip(table.first_cell);
            let wanted = self.needed.iter().zip(&mut self.values);
            for ((column, &(begin, end)), (&needed, value)) in cells.zip(wanted) {
                if needed {
                    let cell = line.get(begin..end).unwrap_or_default();
                    *value =
                        number(cell, &mut self.decimal, &mut self.scratch).ok_or_else(|| {
                            let place = Place::Cell(at, column + 1);
                            Error::malformed(path, place, not_a_number(cell, self.decimal))
                        })?;
                }
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

impl Source for TextSource {
    fn layout(&self) -> &Layout {
        &self.table.layout
    }

    fn select(&mut self, channels: &[usize]) -> Result<()> {
        self.table.layout.common_length(&self.path, channels)?;
        self.selected = channels.to_vec();
        self.state = State::Fresh;
        Ok(())
    }

    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize> {
        block.clear(self.selected.len());
        let mut rows = match std::mem::replace(&mut self.state, State::Failed) {
            State::Fresh => self.start()?,
            State::Reading(rows) => rows,
            State::Failed => {
                let cause =
                    "an earlier row could not be read; select the channels again to start anew";
                return Err(Error::malformed(&self.path, Place::Whole, cause));
            }
        };
        let mut count = 0;
        while count < limit && !self.selected.is_empty() && rows.next(&self.path, &self.table)? {
            for (column, &channel) in block.columns.iter_mut().zip(&self.selected) {
                column.push(rows.values.get(channel).copied().unwrap_or(f64::NAN));
            }
            count += 1;
        }
        self.state = State::Reading(rows);
        Ok(count)
    }
}
