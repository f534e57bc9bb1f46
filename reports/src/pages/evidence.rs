//! Evidence: what the test suites compared, how near each comparison comes to its limit, and what is beyond it.
//!
//! The rows are [`sixaxis_props::evidence`]'s. Nothing is left out on the way to the page: an error that is no number
//! counts as beyond every limit, and one that is exactly zero, for which a logarithmic axis has no place, is drawn at
//! its left end and counted.

mod controls;
mod motions;
mod quantity;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use sixaxis_props::evidence::Row;

use self::quantity::Quantity;
use sixaxis_page::number::{self, scientific, significant};
use sixaxis_page::{Axis, Block, Cell, Column, Figure, Mark, Section, Series, State, Table};

const ID: &str = "evidence";
const TITLE: &str = "Evidence: every comparison against its limit";
/// More rows beyond their limits than this are counted only.
const LISTED: usize = 12;
/// Under this margin a limit is held, but barely.
const NARROW: f64 = 1.5;
/// Room right of the limit on an axis of shares.
const BEYOND_LIMIT: f64 = 3.0;

/// Palette indices; markers have the shape of their colour.
const MEDIAN: usize = 0;
const OUTSIDE: usize = 1;
const Q99: usize = 2;
const LARGEST: usize = 3;
const NO_NUMBER: usize = 5;
const NEUTRAL: usize = 6;

/// The section.
#[must_use]
pub fn section(rows: &[Row]) -> Section {
    if rows.is_empty() {
        return Section::new(ID, TITLE, "").block(suites_not_run());
    }
    let mut suites: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        suites.entry(&row.suite).or_default().push(row);
    }
    let mut section = Section::new(ID, TITLE, lead(rows, suites.len()));
    section.blocks.extend(beyond(rows));
    section.blocks.extend(motions::blocks(rows));
    let mut anchors = BTreeSet::new();
    for (suite, rows) in suites {
        let (controls, rows): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|row| row.control.is_some());
        let rows = rows.into_iter().filter(|row| !motions::holds(row));
        let quantities = Quantity::all(rows);
        if !quantities.is_empty() {
            let id = anchor(suite, &mut anchors);
            section
                .blocks
                .push(Block::Figure(figure(id, suite, &quantities)));
            section.blocks.push(Block::Table(table(suite, &quantities)));
        }
        let controls = controls::table(suite, &controls);
        section.blocks.extend(controls.map(Block::Table));
    }
    if rows.iter().all(motions::holds) {
        section = section.block(suites_not_run());
    }
    section
}

fn suites_not_run() -> Block {
    Block::Note(
        "The test suites have not been run here. `cargo test --workspace` fills this section: each comparison leaves a row, \
         and the next report shows them."
            .to_owned(),
    )
}

/// The section if the rows of the suites cannot be read: the report is worth having without them.
#[must_use]
pub fn unreadable(own: &[Row], reason: &dyn std::fmt::Display) -> Section {
    section(own).block(Block::Note(format!(
        "The rows of the test suites cannot be read: {reason}. `cargo test --workspace` writes them anew."
    )))
}

fn lead(rows: &[Row], suites: usize) -> String {
    let (controls, rows): (Vec<&Row>, Vec<&Row>) =
        rows.iter().partition(|row| row.control.is_some());
    let within = rows.iter().filter(|row| row.holds()).count();
    let all = if within == rows.len() {
        "all within their limits".to_owned()
    } else {
        format!(
            "{} within their limits, **{} beyond**",
            count(within),
            count(rows.len() - within)
        )
    };
    let fail = controls.iter().filter(|row| row.holds()).count();
    let controls = match controls.len() {
        0 => String::new(),
        n if n == fail => format!(
            "; {} negative controls, in which something is broken on purpose, all fail as they must",
            count(n)
        ),
        n => format!(
            "; **{} of {} negative controls do not fail**",
            count(n - fail),
            count(n)
        ),
    };
    format!(
        "{}, {all}{controls}, as the tests last wrote them; every row is in `evidence.csv`. An error is in the measure of its limit, \
         mostly over full scale. Allowed is the limit and, where the reference's own error is known, that error as well; \
         the figures show the error over what is allowed. The margin is how often the largest error goes into it.",
        match (rows.len(), suites) {
            (1, _) => "One comparison".to_owned(),
            (n, 1) => format!("{} comparisons of one suite", count(n)),
            (n, s) => format!("{} comparisons of {s} suites", count(n)),
        }
    )
}

/// The rows beyond their limits, worst first, if there are any.
fn beyond(rows: &[Row]) -> Option<Block> {
    let mut found: Vec<&Row> = rows.iter().filter(|row| !row.holds()).collect();
    if found.is_empty() {
        return None;
    }
    found.sort_by(|a, b| quantity::counted(b.share()).total_cmp(&quantity::counted(a.share())));
    let lines = found.iter().take(LISTED).map(|row| {
        let cells = [
            error(row.error, 2).state(State::Bad),
            limit(row.limit, row.limit),
            row.reference_error.map_or(Cell::from(""), |e| error(e, 1)),
            Cell::from(words(&row.suite)),
            Cell::from(row.case.clone()),
        ];
        sixaxis_page::Row::new(row.quantity.clone(), cells)
    });
    Some(Block::Table(Table {
        caption: "Beyond their limits".to_owned(),
        stub: "quantity".to_owned(),
        columns: vec![
            Column::number("error", ""),
            Column::number("limit", ""),
            Column::number("reference's own", ""),
            Column::text("suite"),
            Column::text("case"),
        ],
        rows: lines.collect(),
        footnote: match found.len().saturating_sub(LISTED) {
            0 => String::new(),
            more => format!("And {} more, not as far beyond.", count(more)),
        },
        ..Table::default()
    }))
}

/// How far below its limits each quantity of a suite stays.
fn figure(id: String, suite: &str, quantities: &[Quantity<'_>]) -> Figure {
    let shares = || quantities.iter().flat_map(|q| q.shares());
    let (from, to) = quantity::decades(shares());
    let (from, to) = (from.min(0.1), if to <= 1.0 { BEYOND_LIMIT } else { to });
    let zeros: usize = quantities.iter().map(|q| q.zeros).sum();
    // What has no place on the axis stands at the end that it lies beyond, apart from what has.
    let from = if zeros > 0 { from / 10.0 } else { from };
    let place = |share: f64| match share {
        s if s <= 0.0 => from,
        s if s.is_finite() => s,
        _ => to,
    };
    let mut spans = Vec::new();
    let mut marks: BTreeMap<usize, Vec<(f64, f64)>> = BTreeMap::new();
    for (row, q) in quantities.iter().enumerate() {
        let y = row as f64;
        let share = q.share;
        // A single case has no extent.
        if share.count > 1 {
            spans.extend([(place(q.smallest), y), (place(share.max), y), (f64::NAN, y)]);
        }
        let kind = match share.max {
            m if !m.is_finite() => NO_NUMBER,
            m if m > 1.0 => OUTSIDE,
            _ => LARGEST,
        };
        let mut mark = |kind, x| marks.entry(kind).or_default().push((place(x), y));
        mark(kind, share.max);
        if share.count > 1 {
            mark(MEDIAN, share.median);
        }
        if share.q99 < share.max {
            mark(Q99, share.q99);
        }
    }
    let mut figure = Figure::new(
        id,
        format!("Suite {}", words(suite)),
        Axis::log("error over what is allowed", "").range(from, to),
        Axis::names("quantity", quantities.iter().map(|q| q.name)),
    )
    .mark(Mark::vertical(1.0, "limit"));
    if !spans.is_empty() {
        figure = figure.series(Series::line("smallest to largest", NEUTRAL, spans));
    }
    for (kind, label) in [
        (MEDIAN, "median"),
        (Q99, "99 %"),
        (LARGEST, "largest"),
        (OUTSIDE, "largest, beyond the limit"),
        (NO_NUMBER, "no number, drawn at the right end"),
    ] {
        if let Some(points) = marks.remove(&kind) {
            figure = figure.series(Series::points(label, kind, points));
        }
    }
    if zeros > 0 {
        figure = figure.caption(format!(
            "{} of {} errors are exactly zero; a logarithmic axis has no place for them, they stand at its left end.",
            count(zeros),
            count(quantities.iter().map(|q| q.share.count).sum())
        ));
    }
    figure
}

fn table(suite: &str, quantities: &[Quantity<'_>]) -> Table {
    let (with_zeros, with_reference) = (
        quantities.iter().any(|q| q.zeros > 0),
        quantities.iter().any(|q| q.reference.is_some()),
    );
    // The verdict stands next to the name, where a phone shows it.
    let mut table = Table::of("quantity", quantities, |q| q.name.to_owned())
        .col("margin", |q| margin(q.share.max))
        .col("limit", |q| limit(q.limits.0, q.limits.1))
        .col("median", |q| q.error_cells()[0].clone())
        .col("99 %", |q| q.error_cells()[1].clone())
        .col("max", |q| q.error_cells()[2].clone());
    if with_reference {
        table = table.col("reference, median", |q| {
            q.reference
                .map_or_else(Cell::default, |r| error(r.median, 1))
        });
    }
    table = table.col("cases", |q| count(q.share.count));
    if with_zeros {
        table = table.col("exactly zero", |q| count(q.zeros));
    }
    table
        .text("why the limit", |q| q.reason())
        .caption(format!("Errors of the suite {}", words(suite)))
        .into()
}

/// An error with few digits, all of them on hovering.
fn error(value: f64, digits: usize) -> Cell {
    let text = match value {
        v if v.is_nan() => "no number".to_owned(),
        v => significant_or_power(v, digits),
    };
    Cell::from(text).title(value.to_string())
}

/// A limit, or the range of several.
fn limit(smallest: f64, largest: f64) -> Cell {
    // Most limits are round; one that is not gets a second digit.
    let text = |value: f64| {
        let round = format!("{value:.0e}").parse() == Ok(value);
        significant_or_power(value, if round { 1 } else { 2 })
    };
    if smallest == largest {
        Cell::from(text(smallest)).title(smallest.to_string())
    } else {
        Cell::from(format!("{} to {}", text(smallest), text(largest)))
            .title(format!("{smallest} to {largest}"))
    }
}

/// How often the largest share goes into what is allowed.
fn margin(largest_share: f64) -> Cell {
    let margin = 1.0 / largest_share;
    let state = match margin {
        m if m >= NARROW => State::Good,
        m if m >= 1.0 => State::Warn,
        _ => State::Bad,
    };
    let text = match margin {
        m if m.is_nan() || m == 0.0 => "none".to_owned(),
        m if m < 0.01 => "< 0.01×".to_owned(),
        m if m > 1e6 => "> 10⁶×".to_owned(),
        // Rounded down: a margin just under one is not "1.0".
        m if m < 1.0 => format!("{}×", number::fixed((m * 100.0).floor() / 100.0, 2)),
        m if m < 10.0 => format!("{}×", number::fixed((m * 10.0).floor() / 10.0, 1)),
        m => format!("{}×", significant(m, 2)),
    };
    Cell::from(text).title(margin.to_string()).state(state)
}

/// Plain from a hundredth to a thousand, with a power of ten outside.
fn significant_or_power(value: f64, digits: usize) -> String {
    if value == 0.0 || (0.01..1000.0).contains(&value.abs()) {
        significant(value, digits)
    } else {
        scientific(value, digits)
    }
}

fn count(n: usize) -> String {
    number::count(n as u64)
}

/// A suite's name as words.
fn words(suite: &str) -> String {
    suite.replace('_', " ")
}

/// An anchor for a suite's figure that no other suite has.
fn anchor(suite: &str, taken: &mut BTreeSet<String>) -> String {
    let plain: String = suite
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let mut id = format!("{ID}-suite-{plain}");
    while !taken.insert(id.clone()) {
        id.push_str("-2");
    }
    id
}
