//! Tables. [`Table::of`] takes the rows; each column then says its heading, its alignment and its cell in one place:
//!
//! ```
//! # use sixaxis_page::{Cell, Table};
//! # struct Run { name: String, samples: u64, peak_v: f64 }
//! # let runs = [Run { name: "a".into(), samples: 3, peak_v: 0.5 }];
//! let table: Table = Table::of("run", &runs, |r| r.name.clone())
//!     .col("samples", |r| r.samples.to_string())
//!     .col(("peak", "V"), |r| Cell::of(r.peak_v, |v| format!("{v:.3}")))
//!     .into();
//! assert_eq!(table.rows[0].cells[1].title, "0.5");
//! ```

use serde::Serialize;

use super::number::MISSING;
use super::page::State;

/// How a column is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// Numbers: right-aligned, figures of equal width.
    #[default]
    Number,
    /// Words: left-aligned.
    Text,
    /// Short signs: centred.
    Centre,
}

/// One column.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Column {
    /// Heading.
    pub label: String,
    /// Unit, printed small under the heading; empty for none.
    pub unit: String,
    /// Alignment of the cells.
    pub align: Align,
    /// Set small and grey: there for the sake of completeness.
    pub quiet: bool,
}

impl Column {
    /// A column of numbers.
    pub fn number(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            align: Align::Number,
            quiet: false,
        }
    }

    /// A column of words.
    pub fn text(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: String::new(),
            align: Align::Text,
            quiet: false,
        }
    }

    /// The same column, small and grey.
    #[must_use]
    pub fn quiet(mut self) -> Self {
        self.quiet = true;
        self
    }
}

/// One cell of a heading row above the columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeadCell {
    /// Text; may be empty.
    pub text: String,
    /// How many columns it spans.
    pub span: usize,
}

impl HeadCell {
    /// A heading over `span` columns.
    pub fn new(text: impl Into<String>, span: usize) -> Self {
        Self {
            text: text.into(),
            span,
        }
    }
}

/// One cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cell {
    /// Text.
    pub text: String,
    /// Tooltip, usually the same number with all its digits; empty for none.
    pub title: String,
    /// CalibratedSession.
    pub state: State,
}

impl Cell {
    /// A number as `text` prints it, with all its digits as tooltip.
    pub fn of<T: Into<String>>(value: f64, text: impl FnOnce(f64) -> T) -> Self {
        Self::from(text(value)).title(value.to_string())
    }

    /// A cell, or a dash for what there is not.
    pub fn or_dash(cell: Option<impl Into<Self>>) -> Self {
        cell.map_or_else(|| Self::from(MISSING), Into::into)
    }

    /// The same cell with a tooltip.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The same cell with a judgement.
    #[must_use]
    pub fn state(mut self, state: State) -> Self {
        self.state = state;
        self
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }
}

/// One row. A row without cells is a heading for the rows below it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// The first, sticky column.
    pub header: String,
    /// The other columns, one cell each.
    pub cells: Vec<Cell>,
}

impl Row {
    /// A row.
    pub fn new<C: Into<Cell>>(
        header: impl Into<String>,
        cells: impl IntoIterator<Item = C>,
    ) -> Self {
        Self {
            header: header.into(),
            cells: cells.into_iter().map(Into::into).collect(),
        }
    }

    /// A heading for the rows below it.
    pub fn group(header: impl Into<String>) -> Self {
        Self {
            header: header.into(),
            cells: Vec::new(),
        }
    }
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Printed above.
    pub caption: String,
    /// Heading of the first, sticky column.
    pub stub: String,
    /// Heading rows above the columns. Spans of one row add up to the number of columns; the first
    /// column is not counted.
    pub head: Vec<Vec<HeadCell>>,
    /// The columns after the first.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Row>,
    /// Printed below; may be empty.
    pub footnote: String,
}

/// Heading of a column: its label, or label and unit.
#[derive(Clone, Debug)]
pub struct Head {
    label: String,
    unit: String,
}

impl<L: Into<String>, U: Into<String>> From<(L, U)> for Head {
    fn from((label, unit): (L, U)) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
        }
    }
}

impl From<&str> for Head {
    fn from(label: &str) -> Self {
        Self::from((label, ""))
    }
}

impl From<String> for Head {
    fn from(label: String) -> Self {
        Self::from((label, ""))
    }
}

/// A table that is being made from rows of `R`, column by column.
#[derive(Clone, Debug)]
pub struct TableBuilder<R> {
    table: Table,
    /// What each row of the table shows; nothing for a heading.
    of: Vec<Option<R>>,
    /// Headings above the columns so far.
    above: Vec<HeadCell>,
}

impl Table {
    /// A table of `rows` with their names in the first, sticky column, which `stub` heads.
    pub fn of<R>(
        stub: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
        name: impl Fn(&R) -> String,
    ) -> TableBuilder<R> {
        Self::grouped(stub).rows(rows, name)
    }

    /// A table whose rows are to be added, group by group, before its columns.
    pub fn grouped<R>(stub: impl Into<String>) -> TableBuilder<R> {
        TableBuilder {
            table: Self {
                stub: stub.into(),
                ..Self::default()
            },
            of: Vec::new(),
            above: Vec::new(),
        }
    }
}

impl<R> TableBuilder<R> {
    /// Adds rows.
    #[must_use]
    pub fn rows(mut self, rows: impl IntoIterator<Item = R>, name: impl Fn(&R) -> String) -> Self {
        for row in rows {
            self.table.rows.push(Row::group(name(&row)));
            self.of.push(Some(row));
        }
        self
    }

    /// Adds rows under a heading of their own.
    #[must_use]
    pub fn group(
        mut self,
        heading: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
        name: impl Fn(&R) -> String,
    ) -> Self {
        self.table.rows.push(Row::group(heading));
        self.of.push(None);
        self.rows(rows, name)
    }

    /// The columns that follow stand under this heading, until the next one.
    #[must_use]
    pub fn under(mut self, heading: impl Into<String>) -> Self {
        if self.above.is_empty() && !self.table.columns.is_empty() {
            self.above.push(HeadCell::new("", self.table.columns.len()));
        }
        self.above.push(HeadCell::new(heading, 0));
        self
    }

    /// Adds a column of numbers.
    #[must_use]
    pub fn col<C: Into<Cell>>(self, head: impl Into<Head>, cell: impl Fn(&R) -> C) -> Self {
        let Head { label, unit } = head.into();
        self.column(Column::number(label, unit), cell)
    }

    /// Adds a column of words.
    #[must_use]
    pub fn text<C: Into<Cell>>(self, label: impl Into<String>, cell: impl Fn(&R) -> C) -> Self {
        self.column(Column::text(label), cell)
    }

    /// Adds a column of numbers, small and grey.
    #[must_use]
    pub fn quiet<C: Into<Cell>>(self, head: impl Into<Head>, cell: impl Fn(&R) -> C) -> Self {
        let Head { label, unit } = head.into();
        self.column(Column::number(label, unit).quiet(), cell)
    }

    fn column<C: Into<Cell>>(mut self, column: Column, cell: impl Fn(&R) -> C) -> Self {
        self.table.columns.push(column);
        if let Some(above) = self.above.last_mut() {
            above.span += 1;
        }
        for (row, of) in self.table.rows.iter_mut().zip(&self.of) {
            row.cells.extend(of.as_ref().map(|of| cell(of).into()));
        }
        self
    }

    /// Sets the caption.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.table.caption = caption.into();
        self
    }

    /// Sets the footnote.
    #[must_use]
    pub fn footnote(mut self, footnote: impl Into<String>) -> Self {
        self.table.footnote = footnote.into();
        self
    }
}

impl<R> From<TableBuilder<R>> for Table {
    fn from(builder: TableBuilder<R>) -> Self {
        let mut table = builder.table;
        if !builder.above.is_empty() {
            table.head.push(builder.above);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fill_all_rows_but_headings() {
        let table: Table = Table::grouped("n")
            .rows([1, 2], |n| n.to_string())
            .group("more", [3], |n| n.to_string())
            .col("n", |n| n.to_string())
            .under("powers")
            .col(("square", "m²"), |n| (n * n).to_string())
            .quiet("cube", |n| {
                Cell::of(f64::from(n * n * n), |v| v.to_string())
            })
            .into();
        let cells: Vec<usize> = table.rows.iter().map(|row| row.cells.len()).collect();
        assert_eq!(cells, [3, 3, 0, 3]);
        assert_eq!(table.rows[3].cells[2].title, "27");
        assert_eq!(table.columns[1].unit, "m²");
        assert_eq!(
            table.head,
            [[HeadCell::new("", 1), HeadCell::new("powers", 2)]]
        );
    }
}
