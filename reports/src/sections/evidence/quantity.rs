//! The rows of one quantity, and what is told of them.

use std::collections::BTreeMap;

use sixaxis_props::evidence::{Quantiles, Row};

use super::cells::error;
use sixaxis_page::Cell;

/// One quantity.
pub struct Quantity<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its rows; never none.
    pub rows: Vec<&'a Row>,
    /// Distribution of the errors over what is allowed; NaN counts as infinite.
    pub share: Quantiles,
    /// Distribution of the errors.
    pub error: Quantiles,
    /// Distribution of the reference's own errors, of the rows that have one.
    pub reference: Option<Quantiles>,
    /// Smallest share.
    pub smallest: f64,
    /// How many errors are exactly zero.
    pub zeros: usize,
    /// Smallest and largest limit.
    pub limits: (f64, f64),
}

impl<'a> Quantity<'a> {
    /// Groups rows by quantity, the one that comes nearest to its limit first.
    pub fn all(rows: impl IntoIterator<Item = &'a Row>) -> Vec<Self> {
        let mut groups: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
        for row in rows {
            groups.entry(&row.quantity).or_default().push(row);
        }
        let mut all: Vec<Self> = groups
            .into_iter()
            .filter_map(|(name, rows)| Self::of(name, rows))
            .collect();
        // The sort is stable: what is equally near stays in order of name.
        all.sort_by(|a, b| b.share.max.total_cmp(&a.share.max));
        all
    }

    fn of(name: &'a str, rows: Vec<&'a Row>) -> Option<Self> {
        let limits = rows.iter().map(|row| row.limit);
        Some(Self {
            share: Quantiles::of(rows.iter().map(|row| row.share()))?,
            error: Quantiles::of(rows.iter().map(|row| row.error))?,
            reference: Quantiles::of(rows.iter().filter_map(|row| row.reference_error)),
            smallest: rows
                .iter()
                .map(|row| counted(row.share()))
                .fold(f64::INFINITY, f64::min),
            zeros: rows.iter().filter(|row| row.error == 0.0).count(),
            limits: (
                limits.clone().fold(f64::INFINITY, f64::min),
                limits.fold(f64::NEG_INFINITY, f64::max),
            ),
            name,
            rows,
        })
    }

    /// Why the limits are what they are, each reason once.
    pub fn reason(&self) -> String {
        let mut reasons: Vec<&str> = self.rows.iter().map(|row| &*row.reason).collect();
        reasons.sort_unstable();
        reasons.dedup();
        reasons.join("; ")
    }

    /// Whether somebody asks for the limit, however far below it the errors stay.
    pub fn is_required(&self) -> bool {
        self.rows
            .iter()
            .all(|row| row.reason.starts_with("required"))
    }

    /// All shares.
    pub fn shares(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| row.share())
    }

    /// Median, 99 % and largest error. Of a single row only the last says something.
    pub fn error_cells(&self) -> [Cell; 3] {
        let lost = self.rows.iter().filter(|row| row.error.is_nan()).count();
        // A quantile counts NaN as infinite; the reader is told which of the two it was.
        let cell = |value: f64| match value {
            f64::INFINITY if lost > 0 => {
                error(f64::NAN, 2).title(format!("{lost} of {} errors are NaN", self.rows.len()))
            }
            v => error(v, 2),
        };
        if self.rows.len() == 1 {
            [Cell::from(""), Cell::from(""), cell(self.error.max)]
        } else {
            [self.error.median, self.error.q99, self.error.max].map(cell)
        }
    }
}

/// A share as it is judged: NaN is beyond every limit.
pub fn counted(share: f64) -> f64 {
    if share.is_nan() { f64::INFINITY } else { share }
}

/// The decades that positive finite values span, as ends of a logarithmic axis.
pub fn decades(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|v| v.is_finite() && *v > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    if low > high {
        return (0.1, 1.0);
    }
    let (from, to) = (low.log10().floor(), high.log10().ceil());
    // The logarithm of a value next to a power of ten may be rounded past it.
    (
        10f64.powf(from).min(low),
        10f64.powf(to.max(from + 1.0)).max(high),
    )
}
