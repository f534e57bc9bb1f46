//! Random six-axis motions on MuJoCo: the errors and the reference's own, each as a whole distribution.

use sixaxis_props::evidence::Row;

use super::quantity::{Quantity, decades};
use super::{count, error, limit, margin};
use sixaxis_page::{Axis, Block, Column, Figure, HeadCell, Mark, Series, Table};

/// Quantities of the random motions, with their short names.
const QUANTITIES: [(&str, &str, &str); 3] = [
    (
        "linear acceleration, random motion",
        "Linear acceleration",
        "evidence-random-linear",
    ),
    (
        "angular acceleration, random motion",
        "Angular acceleration",
        "evidence-random-angular",
    ),
    ("rate, random motion", "Rate", "evidence-random-rate"),
];

/// Palette indices.
const OURS: usize = 0;
const REFERENCE: usize = 1;

/// Whether a row is shown here.
pub fn holds(row: &Row) -> bool {
    QUANTITIES.iter().any(|(name, ..)| row.quantity == *name)
}

/// Figures and table; nothing if there are no such rows.
pub fn blocks(rows: &[Row]) -> Vec<Block> {
    let all = Quantity::all(rows.iter().filter(|row| holds(row)));
    let found: Vec<_> = QUANTITIES
        .iter()
        .filter_map(|(name, title, id)| Some((all.iter().find(|q| q.name == *name)?, *title, *id)))
        .collect();
    if found.is_empty() {
        return Vec::new();
    }
    // One range for all, so that they can be laid side by side.
    let range = decades(found.iter().flat_map(|(q, ..)| {
        let values = |row: &&Row| {
            [
                row.error,
                row.reference_error.unwrap_or(0.0),
                row.limit * 2.0,
            ]
        };
        q.rows.iter().flat_map(values)
    }));
    let figures = found
        .iter()
        .map(|(q, title, id)| figure(q, title, id, range));
    vec![
        Block::Heading("Random six-axis motions on MuJoCo".to_owned()),
        Block::Text(
            "Share of the comparisons whose error is at most the abscissa, and the same of the reference's own error: what \
             halving MuJoCo's step changes. Where the error is not the larger of the two, the core is as exact as MuJoCo can \
             tell."
                .to_owned(),
        ),
        Block::FigureGrid(figures.collect()),
        Block::Table(table(&found)),
    ]
}

fn figure(q: &Quantity<'_>, title: &str, id: &str, range: (f64, f64)) -> Figure {
    let ours = q.rows.iter().map(|row| row.error);
    let reference = q.rows.iter().filter_map(|row| row.reference_error);
    let (smallest, largest) = q.limits;
    let label = if smallest == largest {
        "limit"
    } else {
        "smallest limit"
    };
    let mut figure = Figure::new(
        id,
        title,
        Axis::log("error", "").range(range.0, range.1),
        Axis::linear("share of comparisons", "%").range(0.0, 100.0),
    )
    .mark(Mark::vertical(smallest, label))
    .series(Series::line("error", OURS, cumulated(ours, range)));
    if q.reference.is_some() {
        figure = figure.series(Series::dashed(
            "the reference's own error",
            REFERENCE,
            cumulated(reference, range),
        ));
    }
    let lost = q.rows.iter().filter(|row| !row.error.is_finite()).count();
    let mut remarks = Vec::new();
    if q.zeros > 0 {
        remarks.push(format!("{} errors are exactly zero.", count(q.zeros)));
    }
    if lost > 0 {
        remarks.push(format!(
            "**{} of {} errors are no number**; the curve ends below 100 %.",
            count(lost),
            count(q.rows.len())
        ));
    }
    figure.caption(remarks.join(" "))
}

/// Corners of the empirical distribution in percent. It begins at the height of what is zero, and what is not finite
/// keeps it from reaching the top.
fn cumulated(values: impl IntoIterator<Item = f64>, (from, to): (f64, f64)) -> Vec<(f64, f64)> {
    let mut values: Vec<f64> = values.into_iter().collect();
    let count = values.len().max(1) as f64;
    let percent = |n: usize| 100.0 * n as f64 / count;
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    let zeros = values.partition_point(|v| *v <= 0.0);
    let mut corners = vec![(from, percent(zeros))];
    for (below, value) in values.iter().enumerate().skip(zeros) {
        corners.extend([(*value, percent(below)), (*value, percent(below + 1))]);
    }
    corners.push((to, percent(values.len())));
    corners
}

fn table(found: &[(&Quantity<'_>, &str, &str)]) -> Table {
    let rows = found.iter().map(|(q, title, _)| {
        let mut cells = vec![margin(q.share.max), limit(q.limits.0, q.limits.1)];
        cells.extend(q.error_cells());
        match q.reference {
            Some(r) => cells.extend([r.median, r.q99, r.max].map(|e| error(e, 1))),
            None => cells.extend(["", "", ""].map(Into::into)),
        }
        cells.push(count(q.rows.len()).into());
        sixaxis_page::Row::new(*title, cells)
    });
    let columns = [
        "margin", "limit", "median", "99 %", "max", "median", "99 %", "max", "cases",
    ];
    Table {
        caption: "Errors over random motions".to_owned(),
        stub: "quantity".to_owned(),
        head: vec![vec![
            HeadCell::new("", 2),
            HeadCell::new("error", 3),
            HeadCell::new("the reference's own", 3),
            HeadCell::new("", 1),
        ]],
        columns: columns.map(|label| Column::number(label, "")).to_vec(),
        rows: rows.collect(),
        ..Table::default()
    }
}
