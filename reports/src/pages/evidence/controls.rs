//! Negative controls: what was broken on purpose, and by how much its error exceeds the limit of the sound one.

use std::collections::BTreeMap;

use sixaxis_page::{Cell, State, Table};
use sixaxis_props::evidence::Row;

use super::{count, significant_or_power, words};

/// The controls of one quantity.
struct Control<'a> {
    quantity: &'a str,
    cases: usize,
    /// Smallest error over its limit.
    smallest: f64,
    /// Largest factor that is asked for.
    required: f64,
    hold: bool,
}

fn controls<'a>(rows: &[&'a Row]) -> Vec<Control<'a>> {
    let mut found: BTreeMap<&str, Control<'a>> = BTreeMap::new();
    for row in rows {
        let entry = found.entry(&row.quantity).or_insert(Control {
            quantity: &row.quantity,
            cases: 0,
            smallest: f64::INFINITY,
            required: 0.0,
            hold: true,
        });
        let factor = row.error / row.limit;
        entry.cases += 1;
        entry.smallest = if factor.is_nan() || entry.smallest.is_nan() {
            f64::NAN
        } else {
            entry.smallest.min(factor)
        };
        entry.required = entry.required.max(row.control.unwrap_or(0.0));
        entry.hold &= row.holds();
    }
    found.into_values().collect()
}

/// The table of a suite's controls, `rows`; none if there are none.
pub fn table(suite: &str, rows: &[&Row]) -> Option<Table> {
    if rows.is_empty() {
        return None;
    }
    let table = Table::of("broken on purpose", controls(rows), |c| {
        c.quantity.to_owned()
    })
    .col("error over limit, smallest", |c| {
        let state = if c.hold { State::Good } else { State::Bad };
        Cell::of(c.smallest, |v| significant_or_power(v, 2)).state(state)
    })
    .col("at least", |c| significant_or_power(c.required, 1))
    .col("cases", |c| count(c.cases))
    .caption(format!("Negative controls of the suite {}", words(suite)));
    Some(table.into())
}
