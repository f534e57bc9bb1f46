//! Random six-axis motions on MuJoCo: the errors and the reference's own, each as a whole distribution.

use serde::Serialize;
use sixaxis_page::number::count;
use sixaxis_page::{Axis, Cell, Figure, Table, Text};
use sixaxis_props::evidence::{Quantiles, Row};

use super::cells::{error, limit, margin};
use super::quantity::{Quantity, decades};

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

/// A quantity as the text has it: anchor and title of its figure, and what is to be said of it.
#[derive(Serialize)]
struct Motion {
    id: &'static str,
    title: &'static str,
    remark: String,
}

/// Values, figures and table; nothing to show if there are no such rows.
pub fn fill(mut text: Text, rows: &[&Row]) -> Text {
    let all = Quantity::all(rows.iter().copied().filter(|row| holds(row)));
    let found: Vec<_> = QUANTITIES
        .iter()
        .filter_map(|(name, title, id)| Some((all.iter().find(|q| q.name == *name)?, *title, *id)))
        .collect();
    // One range for all, so that they can be laid side by side.
    let range = decades(found.iter().flat_map(|(q, ..)| {
        let values = |row: &&Row| {
            let reference = row.reference_error.unwrap_or(0.0);
            [row.error, reference, row.limit * 2.0]
        };
        q.rows.iter().flat_map(values)
    }));
    for (q, _, id) in &found {
        text = text.figure(figure(q, id, range));
    }
    if !found.is_empty() {
        text = text.table("motions", table(&found));
    }
    let motions = found.iter().map(|&(q, title, id)| Motion {
        id,
        title,
        remark: remark(q),
    });
    text.value("motions", motions.collect::<Vec<_>>())
}

fn figure(q: &Quantity<'_>, id: &str, range: (f64, f64)) -> Figure {
    let ours = q.rows.iter().map(|row| row.error);
    let reference = q.rows.iter().filter_map(|row| row.reference_error);
    let (smallest, largest) = q.limits;
    let label = if smallest == largest {
        "limit"
    } else {
        "smallest limit"
    };
    let figure = Figure::new(
        id,
        "",
        Axis::log("error", "").range(range.0, range.1),
        Axis::linear("share of comparisons", "%").range(0.0, 100.0),
    )
    .vertical(smallest, label)
    .line("error", OURS, cumulated(ours, range));
    match q.reference {
        None => figure,
        Some(_) => figure.dashed(
            "the reference's own error",
            REFERENCE,
            cumulated(reference, range),
        ),
    }
}

fn remark(q: &Quantity<'_>) -> String {
    let lost = q.rows.iter().filter(|row| !row.error.is_finite()).count();
    let mut remarks = Vec::new();
    if q.zeros > 0 {
        remarks.push(format!("{} errors are exactly zero.", count(q.zeros)));
    }
    if lost > 0 {
        remarks.push(format!(
            "**{} of {} errors are NaN or infinite**; the curve ends below 100 %.",
            count(lost),
            count(q.rows.len())
        ));
    }
    remarks.join(" ")
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
    let reference = |q: &Quantity<'_>, of: fn(Quantiles) -> f64| {
        q.reference.map_or(Cell::from(""), |r| error(of(r), 1))
    };
    Table::of("quantity", found, |(_, title, _)| (*title).to_owned())
        .col("margin", |(q, ..)| margin(q.share.max))
        .col("limit", |(q, ..)| limit(q.limits.0, q.limits.1))
        .under("error")
        .col("median", |(q, ..)| q.error_cells()[0].clone())
        .col("99 %", |(q, ..)| q.error_cells()[1].clone())
        .col("max", |(q, ..)| q.error_cells()[2].clone())
        .under("the reference's own")
        .col("median", |(q, ..)| reference(q, |r| r.median))
        .col("99 %", |(q, ..)| reference(q, |r| r.q99))
        .col("max", |(q, ..)| reference(q, |r| r.max))
        .under("")
        .col("cases", |(q, ..)| count(q.rows.len()))
        .into()
}
