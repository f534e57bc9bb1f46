//! Evidence: what the test suites compared, how near each comparison comes to its limit, and what is beyond it.
//!
//! The rows are [`sixaxis_props::evidence`]'s. Nothing is left out on the way to the page: an error that is NaN counts as
//! beyond every limit, and one that is exactly zero, for which a logarithmic axis has no place, is drawn at its left end
//! and counted.

mod cells;
mod motions;
mod quantity;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use anyhow::Result;
use serde::Serialize;
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::count;
use sixaxis_page::{Axis, Cell, Figure, Section, State, Table, Text};
use sixaxis_props::evidence::Row;
use sixaxis_props::provenance::revision;
use sixaxis_props::results;

use cells::{error, limit, margin, words};
use quantity::Quantity;

/// More rows beyond their limits than this are counted only.
const LISTED: usize = 12;
/// Limits that are named because they are far from what is seen.
const LOOSEST: usize = 20;
/// Room right of the limit on an axis of shares.
const BEYOND_LIMIT: f64 = 3.0;

/// Palette indices; markers have the shape of their colour.
const MEDIAN: usize = 0;
const OUTSIDE: usize = 1;
const Q99: usize = 2;
const LARGEST: usize = 3;
const NOT_FINITE: usize = 5;

/// A suite as the text has it: name, anchor of its figure, place of its table, how many errors, how many of them zero.
#[derive(Serialize)]
struct Suite {
    name: String,
    figure: String,
    table: String,
    errors: usize,
    zeros: usize,
}

/// The section. Rows that other code left are counted and not shown. `unreadable` says why the suites' rows are not among `rows`:
/// the report is worth having without them.
///
/// # Errors
/// If the text does not fit the rows.
pub fn section(rows: &[Row], unreadable: Option<&dyn Display>) -> Result<Section> {
    let (ours, others): (Vec<&Row>, Vec<&Row>) =
        rows.iter().partition(|row| row.commit == revision());
    let (controls, rows): (Vec<&Row>, Vec<&Row>) =
        ours.into_iter().partition(|row| row.control.is_some());
    let commits: BTreeSet<&str> = others.iter().map(|row| &row.commit[..]).collect();
    let mut by_suite: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in &rows {
        by_suite.entry(&row.suite).or_default().push(row);
    }
    let counted = match (rows.len(), by_suite.len()) {
        (1, _) => "One comparison".to_owned(),
        (n, 1) => format!("{} comparisons of one suite", count(n)),
        (n, s) => format!("{} comparisons of {s} suites", count(n)),
    };
    let harmless = controls.iter().filter(|row| !row.holds()).count();
    let beyond = rows.iter().filter(|row| !row.holds()).count();
    let failed = rows.iter().chain(&controls).copied();
    let mut failed: Vec<&Row> = failed.filter(|row| !row.holds()).collect();
    failed.sort_by(|a, b| quantity::counted(b.share()).total_cmp(&quantity::counted(a.share())));
    let mut text = Text::new(include_str!("evidence.md"))
        .value("comparisons", rows.len())
        .value("counted", counted)
        .value("by_tests", by_suite.len() > 1)
        .value("beyond", beyond)
        .value("failed", failed.len())
        .value("unlisted", failed.len().saturating_sub(LISTED))
        .value("controls", controls.len())
        .value("harmless", harmless)
        .value("unreadable", unreadable.map(ToString::to_string))
        .value("others", others.len())
        .value(
            "commits",
            commits.into_iter().collect::<Vec<_>>().join(", "),
        )
        .value("revision", revision())
        .table("published", published()?);
    if !failed.is_empty() {
        text = text.table("beyond", listed(&failed));
    }
    if !controls.is_empty() {
        text = text.table("controls", broken(&controls));
    }
    text = motions::fill(text, &rows);
    let mut suites = Vec::new();
    let mut loose = Vec::new();
    let mut anchors = BTreeSet::new();
    for (suite, rows) in by_suite {
        let rows = rows.into_iter().filter(|row| !motions::holds(row));
        let quantities = Quantity::all(rows);
        if quantities.is_empty() {
            continue;
        }
        let id = anchor(suite, &mut anchors);
        let suite = Suite {
            name: words(suite),
            table: format!("{id}-errors"),
            figure: id,
            errors: quantities.iter().map(|q| q.share.count).sum(),
            zeros: quantities.iter().map(|q| q.zeros).sum(),
        };
        text = text
            .figure(figure(&suite, &quantities))
            .table(&suite.table, table(&suite, &quantities));
        let judged = quantities
            .iter()
            .filter(|q| q.share.max > 0.0 && !q.is_required());
        loose.extend(judged.map(|q| Loose {
            suite: suite.name.clone(),
            quantity: q.name.to_owned(),
            share: q.share.max,
            limit: q.limits,
            largest: q.error.max,
            reason: q.reason(),
        }));
        suites.push(suite);
    }
    if !loose.is_empty() {
        text = text.table("loosest", loosest(loose));
    }
    text.value("suites", suites)
        .value("loosest", LOOSEST)
        .section("evidence")
}

/// Where the limit is farthest from what is seen.
struct Loose {
    suite: String,
    quantity: String,
    share: f64,
    limit: (f64, f64),
    largest: f64,
    reason: String,
}

fn loosest(mut loose: Vec<Loose>) -> Table {
    loose.sort_by(|a, b| a.share.total_cmp(&b.share));
    loose.truncate(LOOSEST);
    Table::of("quantity", &loose, |l| l.quantity.clone())
        .col("margin", |l| margin(l.share))
        .col("limit", |l| limit(l.limit.0, l.limit.1))
        .col("largest error", |l| error(l.largest, 2))
        .text("suite", |l| l.suite.clone())
        .text("why the limit", |l| l.reason.clone())
        .into()
}

/// Where published results are from.
fn published() -> Result<Table> {
    let files = results::provenances()?;
    Ok(Table::of("file", &files, |(file, _)| (*file).to_owned())
        .text("made on", |(_, from)| {
            from.date_utc.chars().take(10).collect::<String>()
        })
        .text("by the commit", |(_, from)| from.commit.clone())
        .text("code changed since", |(_, from)| match from.changed() {
            Ok(changed) if changed.is_empty() => "none".to_owned(),
            Ok(changed) => changed.join(", "),
            // Not in a checkout.
            Err(_) => "unknown".to_owned(),
        })
        .into())
}

/// The rows that fail, worst first.
fn listed(failed: &[&Row]) -> Table {
    let rows = failed.iter().take(LISTED);
    Table::of("quantity", rows, |row| row.quantity.clone())
        .col("error", |row| error(row.error, 2).state(State::Bad))
        .col("limit", |row| limit(row.limit, row.limit))
        .col("reference's own", |row| {
            row.reference_error.map_or(Cell::from(""), |e| error(e, 1))
        })
        .text("suite", |row| words(&row.suite))
        .text("case", |row| row.case.clone())
        .into()
}

/// Negative controls of each suite and quantity: the one that does not fail, or fails by least, stands for all.
fn broken(controls: &[&Row]) -> Table {
    let mut groups: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in controls {
        let group = groups.entry((&row.suite, &row.quantity));
        group.or_default().push(row);
    }
    let least = groups.into_values().filter_map(|rows| {
        let over = |row: &Row| quantity::counted(row.error / row.limit);
        let harmless_first =
            |a: &&&Row, b: &&&Row| a.holds().cmp(&b.holds()).then(over(a).total_cmp(&over(b)));
        let row = *rows.iter().min_by(harmless_first)?;
        Some((row, rows.len(), rows.iter().all(|row| row.holds())))
    });
    Table::of("what is compared", least, |(row, ..)| row.quantity.clone())
        .text("suite", |(row, ..)| words(&row.suite))
        .col("controls", |(_, controls, _)| count(controls))
        .col("smallest error", |(row, ..)| error(row.error, 2))
        .col("limit", |(row, ..)| limit(row.limit, row.limit))
        .col("error over limit", |(row, _, fail)| {
            let state = if *fail { State::Good } else { State::Bad };
            error(row.error / row.limit, 2).state(state)
        })
        .col("at least", |(row, ..)| {
            row.control
                .map_or(Cell::from(""), |factor| error(factor, 2))
        })
        .into()
}

/// How far below its limits each quantity of a suite stays.
fn figure(suite: &Suite, quantities: &[Quantity<'_>]) -> Figure {
    let shares = || quantities.iter().flat_map(|q| q.shares());
    let (from, to) = quantity::decades(shares());
    let (from, to) = (from.min(0.1), if to <= 1.0 { BEYOND_LIMIT } else { to });
    // What has no place on the axis stands at the end that it lies beyond, apart from what has.
    let from = if suite.zeros > 0 { from / 10.0 } else { from };
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
            m if !m.is_finite() => NOT_FINITE,
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
        &*suite.figure,
        "",
        Axis::log("error over what is allowed", "").range(from, to),
        Axis::names("quantity", quantities.iter().map(|q| q.name)),
    )
    .vertical(1.0, "limit");
    if !spans.is_empty() {
        figure = figure.line("smallest to largest", NEUTRAL, spans);
    }
    for (kind, label) in [
        (MEDIAN, "median"),
        (Q99, "99 %"),
        (LARGEST, "largest"),
        (OUTSIDE, "largest, beyond the limit"),
        (NOT_FINITE, "NaN or infinite, drawn at the right end"),
    ] {
        if let Some(points) = marks.remove(&kind) {
            figure = figure.points(label, kind, points);
        }
    }
    figure
}

fn table(suite: &Suite, quantities: &[Quantity<'_>]) -> Table {
    // The verdict stands next to the name, where a phone shows it.
    let mut table = Table::of("quantity", quantities, |q| q.name.to_owned())
        .col("margin", |q| margin(q.share.max))
        .col("limit", |q| limit(q.limits.0, q.limits.1))
        .col("median", |q| q.error_cells()[0].clone())
        .col("99 %", |q| q.error_cells()[1].clone())
        .col("max", |q| q.error_cells()[2].clone());
    if quantities.iter().any(|q| q.reference.is_some()) {
        table = table.col("reference, median", |q| {
            q.reference.map_or(Cell::from(""), |r| error(r.median, 1))
        });
    }
    table = table.col("cases", |q| count(q.share.count));
    if suite.zeros > 0 {
        table = table.col("exactly zero", |q| count(q.zeros));
    }
    table.text("why the limit", |q| q.reason()).into()
}

/// An anchor for a suite's figure that no other suite has.
fn anchor(suite: &str, taken: &mut BTreeSet<String>) -> String {
    let plain: String = suite
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let mut id = format!("evidence-suite-{plain}");
    while !taken.insert(id.clone()) {
        id.push_str("-2");
    }
    id
}
