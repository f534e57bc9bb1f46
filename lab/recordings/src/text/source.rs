//! Rows as blocks.

use std::path::{Path, PathBuf};

use super::dialect::{Decimal, excerpt, number, split};
use super::head::{self, Column, Table, is_blank, is_comment};
use super::lines::{Lines, fragment};
use super::stamp::FORMS;
use crate::error::{Error, Place, Result};
use crate::layout::Layout;
use crate::source::{Decoder, Source, reading};

/// Opens a file of text, gzip or not.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let (mut layout, table) = head::read(path)?;
    let mut text = Text {
        path: path.to_owned(),
        table,
    };
    layout.cut = text.cut()?;
    text.table.cut = layout.cut.is_some();
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
    /// Line and first cell of a comment that would be a row: harmless in a footer, a lost sample before another row.
    hidden: Option<(u64, String)>,
}

impl Decoder for Text {
    type Position = Rows;

    fn start(&mut self, layout: &Layout, selected: &[usize], _samples: u64) -> Result<Rows> {
        let mut targets = vec![Vec::new(); layout.channels.len()];
        for (column, &channel) in selected.iter().enumerate() {
            targets[channel].push(column);
        }
        Ok(Rows {
            lines: self.lines()?,
            decimal: self.table.dialect.decimal,
            cells: Vec::new(),
            targets,
            scratch: String::new(),
            hidden: None,
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

    fn line(&self, sample: u64) -> Option<u64> {
        let mut lines = self.lines().ok()?;
        let mut before = 0;
        while let Some((at, line)) = lines.next().ok()? {
            if self.is_row(line) {
                if before == sample {
                    return Some(at);
                }
                before += 1;
            }
        }
        None
    }
}

impl Text {
    /// The lines from the first row on.
    fn lines(&self) -> Result<Lines> {
        let mut lines = Lines::open(&self.path)?;
        for _ in 1..self.table.first_line {
            lines.next()?;
        }
        Ok(lines)
    }

    /// Whether a line is neither a comment nor blank.
    fn is_row(&self, line: &[u8]) -> bool {
        let blank = is_blank(line) || self.table.loose && line.trim_ascii().is_empty();
        !(blank || is_comment(line))
    }

    /// Whether a line has a row's cells, all of them numbers but the first, which makes a comment of it: `#N/A` of a spreadsheet.
    fn looks_like_a_row(&self, line: &[u8], cells: &mut Vec<(usize, usize)>) -> bool {
        split(line, self.table.dialect.separator, cells).is_ok()
            && cells.len() > 1
            && self.table.cells.contains(&cells.len())
            && (1..cells.len()).all(|at| {
                let text = cell(line, cells, at).trim_ascii();
                text.iter().any(u8::is_ascii_digit)
                    && !text
                        .iter()
                        .any(|b| b.is_ascii_alphabetic() && !matches!(b, b'e' | b'E'))
            })
    }

    /// What is to be said of a last line that breaks off. The end of a compressed file is known only when it has been read.
    fn cut(&self) -> Result<Option<String>> {
        let (mut cells, expected) = (Vec::new(), *self.table.cells.start());
        let Some(line) = fragment(&self.path)?.filter(|line| self.is_row(line)) else {
            return Ok(None);
        };
        let whole = split(&line, self.table.dialect.separator, &mut cells).is_ok();
        Ok((!(whole && cells.len() >= expected)).then(|| {
            format!(
                "its last line breaks off after {} of {expected} columns and is left out: {}",
                cells.len(),
                excerpt(&line)
            )
        }))
    }

    /// The error for a line that is no row; it says where the rows end.
    fn refused(&self, rows: &mut Rows, line: u64, place: Place, mut cause: String) -> Error {
        if rows.lines.is_unterminated() {
            cause += "; the file ends within this line: was it cut short?";
        } else if self.no_row_follows(rows) {
            cause += &format!(
                "; no row follows: if line {line} begins a footer, delete it or begin its lines with #"
            );
        }
        Error::malformed(&self.path, place, cause)
    }

    /// Whether none of the lines to come has the cells of a row, the first channel that is read among them.
    fn no_row_follows(&self, rows: &mut Rows) -> bool {
        let read = rows.targets.iter().position(|targets| !targets.is_empty());
        let column = read.and_then(|channel| self.table.columns.get(channel));
        while let Ok(Some((_, line))) = rows.lines.next() {
            if split(line, self.table.dialect.separator, &mut rows.cells).is_ok()
                && self.table.cells.contains(&rows.cells.len())
                && column.is_none_or(|column| {
                    let cells = &rows.cells;
                    value(line, cells, column, &mut rows.decimal, &mut rows.scratch).is_some()
                })
            {
                return false;
            }
        }
        true
    }

    /// Appends the next row; false at the end.
    fn row(&self, rows: &mut Rows, columns: &mut [Vec<f64>]) -> Result<bool> {
        let table = &self.table;
        loop {
            let Some((at, line)) = rows.lines.next()? else {
                return Ok(false);
            };
            if !self.is_row(line) {
                if rows.hidden.is_none() && self.looks_like_a_row(line, &mut rows.cells) {
                    rows.hidden = Some((at, excerpt(cell(line, &rows.cells, 0))));
                }
                continue;
            }
            if let Some((at, cell)) = rows.hidden.take() {
                let cause = format!(
                    "{cell} is not a number, and a line that begins with # or % is none of the rows: delete it, or mend the cell"
                );
                return Err(Error::malformed(&self.path, Place::Cell(at, 1), cause));
            }
            let parted = split(line, table.dialect.separator, &mut rows.cells);
            let (found, expected) = (rows.cells.len(), &table.cells);
            if parted.is_err() || !expected.contains(&found) {
                if table.cut && rows.lines.is_unterminated() {
                    return Ok(false);
                }
                let cause = match parted {
                    Err(cause) => cause.to_owned(),
                    Ok(()) => format!("{found} columns, {} were expected", expected.start()),
                };
                return Err(self.refused(rows, at, Place::Line(at), cause));
            }
            for (column, targets) in table.columns.iter().zip(&rows.targets) {
                if targets.is_empty() {
                    continue;
                }
                let cells = &rows.cells;
                let Some(value) = value(line, cells, column, &mut rows.decimal, &mut rows.scratch)
                else {
                    let place = Place::Cell(at, column.cell + 1);
                    let cell = cell(line, cells, column.cell);
                    let cause = match column.stamps {
                        Some(_) => {
                            format!("{} is no time stamp as in the first row", excerpt(cell))
                        }
                        None if cell.contains(&b':') || cell.contains(&b'/') => {
                            format!("{} is neither a number nor a time; {FORMS}", excerpt(cell))
                        }
                        None => not_a_number(cell, rows.decimal),
                    };
                    // A missing value in the last row makes no footer of it.
                    let text = cell.first().is_some_and(u8::is_ascii_alphabetic);
                    return Err(match text || rows.lines.is_unterminated() {
                        true => self.refused(rows, at, place, cause),
                        false => Error::malformed(&self.path, place, cause),
                    });
                };
                targets
                    .iter()
                    .for_each(|&target| columns[target].push(value));
            }
            return Ok(true);
        }
    }
}

/// A cell of a line.
fn cell<'a>(line: &'a [u8], cells: &[(usize, usize)], at: usize) -> &'a [u8] {
    let place = cells.get(at).and_then(|&(begin, end)| line.get(begin..end));
    place.unwrap_or_default()
}

/// The number in a column's cell, or its time stamp, s since the first.
fn value(
    line: &[u8],
    cells: &[(usize, usize)],
    column: &Column,
    decimal: &mut Decimal,
    scratch: &mut String,
) -> Option<f64> {
    let own = cell(line, cells, column.cell);
    match column.stamps {
        None => number(own, decimal, scratch),
        Some((stamps, first)) => {
            let now = stamps.read(own, |at| cell(line, cells, at))?;
            Some(stamps.seconds_since(first, now))
        }
    }
}

fn not_a_number(cell: &[u8], decimal: Decimal) -> String {
    if cell.is_empty() {
        return "an empty cell; cut the recording there or mend it".to_owned();
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
