//! How good the other parameters must be for step 4 to determine k/m.

use serde::Serialize;
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::{MISSING, fixed, scientific, significant};
use sixaxis_page::{Axis, Figure, Table, Text};

use super::RECORDS;
use crate::study::results::identifiability::{
    Erring, Identifiability, Records, Tolerance, TolerancePoint,
};

/// Ends of the ordinate: the parabola through three grid points ends a little above the lower one, the grid's upper edge is
/// 1.6 away from the truth.
const ERRORS: (f64, f64) = (1e-6, 3.0);
/// Share of curves below which most are no longer determined.
const HALF: f64 = 0.5;

/// Smallest errors with which most searches no longer determine k/m.
#[derive(Serialize)]
struct LostAt {
    scale: f64,
    drift: f64,
}

/// Values, figures and table.
pub fn fill(text: Text, study: &Identifiability) -> Text {
    let of_either = |erring| {
        let all = RECORDS.into_iter();
        let all = all.filter_map(|(records, ..)| lost_at(study, records, erring));
        all.fold(f64::INFINITY, f64::min)
    };
    let lost_at = LostAt {
        scale: of_either(Erring::Scale),
        drift: of_either(Erring::Drift),
    };
    let draws = study.tolerances.first().map_or(0, |t| t.draws);
    RECORDS
        .into_iter()
        .fold(text, |text, (records, id, _)| {
            text.figure(figure(study, records, &format!("tolerance-{id}")))
        })
        .value("draws", draws)
        .value("lost_at", lost_at)
        .table("tolerance", table(study))
}

/// Smallest error with which most searches no longer determine k/m.
pub fn lost_at(study: &Identifiability, records: Records, erring: Erring) -> Option<f64> {
    let mut points = points(study, records, erring).iter();
    Some(points.find(|point| point.determined < HALF)?.size)
}

/// From small errors to large ones.
fn points(study: &Identifiability, records: Records, erring: Erring) -> &[TolerancePoint] {
    let wanted = |t: &&Tolerance| t.records == records && t.erring == erring;
    let found = study.tolerances.iter().find(wanted);
    found.map_or(&[], |tolerance| &tolerance.points)
}

fn figure(study: &Identifiability, records: Records, id: &str) -> Figure {
    let over_size = |erring, of: fn(&TolerancePoint) -> f64| {
        let points = points(study, records, erring).iter();
        points.map(move |p| (p.size, of(p)))
    };
    let scale = |of| over_size(Erring::Scale, of);
    Figure::new(
        id,
        "",
        Axis::log("relative error put in", ""),
        Axis::log("|ln(k/m found / true)|", "").range(ERRORS.0, ERRORS.1),
    )
    .line_points("scale factors, median", 0, scale(|p| p.median))
    .dashed(
        "scale factors, smallest and largest",
        0,
        scale(|p| p.range.0),
    )
    .dashed("", 0, scale(|p| p.range.1))
    .dashed(
        "the median by first-order theory",
        NEUTRAL,
        scale(|p| p.predicted_median.unwrap_or(f64::NAN)),
    )
    .line_points(
        "zero drifts over full scale, median",
        3,
        over_size(Erring::Drift, |p| p.median),
    )
    .line_points(
        "inertias over the largest, median",
        2,
        over_size(Erring::Inertia, |p| p.median),
    )
    .horizontal(core::f64::consts::LN_2, "lower edge of the grid")
}

fn table(study: &Identifiability) -> Table {
    // Both ways to record step 4 side by side, at whole powers of ten only.
    let rows = |erring| {
        let [whole, even] = RECORDS.map(|(records, ..)| points(study, records, erring));
        whole.iter().zip(even).filter(|(point, _)| {
            let power = point.size.log10();
            (power - power.round()).abs() <= 0.01
        })
    };
    let name = |(whole, _): &(&TolerancePoint, _)| scientific(whole.size, 1);
    type Pick = fn(&(&TolerancePoint, &TolerancePoint)) -> TolerancePoint;
    let sides: [(&str, Pick); 2] = [
        ("whole runs", |(whole, _)| **whole),
        ("turns at full speed", |(_, even)| **even),
    ];
    let table = Table::grouped("error put in")
        .group("Scale factors, relative", rows(Erring::Scale), name)
        .group("Zero drifts, over full scale", rows(Erring::Drift), name);
    let both = sides.into_iter().fold(table, |table, (heading, side)| {
        table
            .under(heading)
            .col("median |ln(k/m found / true)|", |pair| {
                significant_or_power(side(pair).median)
            })
            .col(("at an edge", "% of searches"), |pair| {
                percent_or_none(side(pair).at_edge)
            })
            .col(("determined", "% of searches"), |pair| {
                percent_or_none(side(pair).determined)
            })
    });
    both.into()
}

fn significant_or_power(value: f64) -> String {
    if value < 1e-3 {
        scientific(value, 2)
    } else {
        significant(value, 2)
    }
}

fn percent_or_none(share: f64) -> String {
    match share {
        0.0 => MISSING.to_owned(),
        share => fixed(100.0 * share, 0),
    }
}
