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

/// One cell of a heading row above the columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeadCell {
    /// Text; may be empty.
    pub text: String,
    /// How many columns it spans.
    pub span: usize,
}

/// One cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cell {
    /// Text.
    pub text: String,
    /// Tooltip, usually the same number with all its digits; empty for none.
    pub title: String,
    /// A judgement, which colours it.
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

    /// The same cell, marked unless it is as it should be.
    #[must_use]
    pub fn warn_unless(self, fine: bool) -> Self {
        match fine {
            true => self,
            false => self.state(State::Warn),
        }
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

/// A table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Printed above.
    pub caption: String,
    /// Heading of the first, sticky column.
    pub stub: String,
    /// Headings above the columns; empty for none. The first column is not counted.
    pub head: Vec<HeadCell>,
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
        }
    }
}

impl<R> TableBuilder<R> {
    /// Adds rows.
    #[must_use]
    pub fn rows(mut self, rows: impl IntoIterator<Item = R>, name: impl Fn(&R) -> String) -> Self {
        for row in rows {
            self.table.rows.push(Row {
                header: name(&row),
                cells: Vec::new(),
            });
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
        self.table.rows.push(Row {
            header: heading.into(),
            cells: Vec::new(),
        });
        self.of.push(None);
        self.rows(rows, name)
    }

    /// The columns that follow stand under this heading, until the next one.
    #[must_use]
    pub fn under(mut self, heading: impl Into<String>) -> Self {
        if self.table.head.is_empty() && !self.table.columns.is_empty() {
            self.table.head.push(HeadCell {
                text: String::new(),
                span: self.table.columns.len(),
            });
        }
        self.table.head.push(HeadCell {
            text: heading.into(),
            span: 0,
        });
        self
    }

    /// Adds a column of numbers.
    #[must_use]
    pub fn col<C: Into<Cell>>(self, head: impl Into<Head>, cell: impl Fn(&R) -> C) -> Self {
        self.column(head.into(), Align::Number, false, cell)
    }

    /// Adds a column of words.
    #[must_use]
    pub fn text<C: Into<Cell>>(self, head: impl Into<Head>, cell: impl Fn(&R) -> C) -> Self {
        self.column(head.into(), Align::Text, false, cell)
    }

    /// Adds a column of numbers, small and grey.
    #[must_use]
    pub fn quiet<C: Into<Cell>>(self, head: impl Into<Head>, cell: impl Fn(&R) -> C) -> Self {
        self.column(head.into(), Align::Number, true, cell)
    }

    fn column<C: Into<Cell>>(
        mut self,
        Head { label, unit }: Head,
        align: Align,
        quiet: bool,
        cell: impl Fn(&R) -> C,
    ) -> Self {
        self.table.columns.push(Column {
            label,
            unit,
            align,
            quiet,
        });
        if let Some(above) = self.table.head.last_mut() {
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
        builder.table
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
        let head: Vec<(&str, usize)> = table.head.iter().map(|h| (&*h.text, h.span)).collect();
        assert_eq!(head, [("", 1), ("powers", 2)]);
    }
}
