//! How good the other parameters must be.

use crate::study::results::identifiability::{
    Erring, Identifiability, Records, Tolerance, TolerancePoint,
};
use sixaxis_page::number::{MISSING, fixed, percent, scientific, significant};
use sixaxis_page::{Axis, Block, Column, Figure, HeadCell, Mark, Row, Series, Table};

/// Palette index of the neutral grey.
const NEUTRAL: usize = 6;
/// Ends of the ordinate: the parabola through three grid points ends a little above the lower one, the grid's upper edge is
/// 1.6 away from the truth.
const ERRORS: (f64, f64) = (1e-6, 3.0);
/// Share of curves below which most are no longer determined.
const HALF: f64 = 0.5;

/// Smallest size of error at which most searches no longer determine k/m.
pub fn first_undetermined(
    study: &Identifiability,
    records: Records,
    erring: Erring,
) -> Option<f64> {
    let points = &of(study, records, erring)?.points;
    let lost = points.iter().find(|point| point.determined < HALF)?;
    Some(lost.size)
}

fn of(study: &Identifiability, records: Records, erring: Erring) -> Option<&Tolerance> {
    let mut all = study.tolerances.iter();
    all.find(|t| t.records == records && t.erring == erring)
}

/// Figures and table.
pub fn blocks(study: &Identifiability) -> Vec<Block> {
    let draws = study.tolerances.first().map_or(0, |t| t.draws);
    vec![
        Block::Heading("How good the other parameters must be".to_owned()),
        Block::Text(format!(
            "Noise-free MuJoCo records, true parameters, and one kind of parameter put in error: independent normal errors of \
             the size on the abscissa, {draws} draws, the same directions at every size. From rest to rest an error of the scale \
             factors swings with the acceleration and its integral returns to zero, so that it hardly moves the minimum, but it \
             fills it up: the curve goes flat. Cut out of the motion, as a laboratory would record it, the same error leaves a \
             constant rate, which pulls the minimum along. A drift error is a constant torque and pulls in both cases. Errors of \
             the inertia scale torques that are next to nothing."
        )),
        Block::FigureGrid(vec![
            figure(
                study,
                Records::WholeRuns,
                "Whole runs, rest to rest",
                "tolerance-whole-runs",
            ),
            figure(
                study,
                Records::EvenTurns,
                "Turns at full speed only",
                "tolerance-even-turns",
            ),
        ]),
        Block::Table(table(study)),
    ]
}

fn figure(study: &Identifiability, records: Records, title: &str, id: &str) -> Figure {
    let mut figure = Figure::new(
        id,
        title,
        Axis::log("relative error put in", ""),
        Axis::log("|ln(k/m found / true)|", "").range(ERRORS.0, ERRORS.1),
    );
    let get = |erring, get: fn(&TolerancePoint) -> f64| -> Vec<(f64, f64)> {
        of(study, records, erring).map_or(Vec::new(), |t| {
            t.points.iter().map(|p| (p.size, get(p))).collect()
        })
    };
    figure = figure
        .series(Series::line_points(
            "scale factors, median",
            0,
            get(Erring::Scale, |p| p.median),
        ))
        .series(Series::dashed(
            "scale factors, smallest and largest",
            0,
            get(Erring::Scale, |p| p.range.0),
        ))
        .series(Series::dashed("", 0, get(Erring::Scale, |p| p.range.1)))
        .series(Series::dashed(
            "the median by first-order theory",
            NEUTRAL,
            get(Erring::Scale, |p| p.predicted_median.unwrap_or(f64::NAN)),
        ))
        .series(Series::line_points(
            "zero drifts over full scale, median",
            3,
            get(Erring::Drift, |p| p.median),
        ))
        .series(Series::line_points(
            "inertias over the largest, median",
            2,
            get(Erring::Inertia, |p| p.median),
        ));
    figure.mark(Mark::horizontal(
        core::f64::consts::LN_2,
        "lower edge of the grid",
    ))
}

fn table(study: &Identifiability) -> Table {
    let mut rows = Vec::new();
    for (erring, name) in [
        (Erring::Scale, "Scale factors, relative"),
        (Erring::Drift, "Zero drifts, over full scale"),
    ] {
        rows.push(Row::group(name));
        let pair = [Records::WholeRuns, Records::EvenTurns].map(|r| of(study, r, erring));
        let [Some(whole), Some(even)] = pair else {
            continue;
        };
        for (w, e) in whole.points.iter().zip(&even.points) {
            // Whole powers of ten only.
            let power = w.size.log10();
            if (power - power.round()).abs() > 0.01 {
                continue;
            }
            let cells = [w, e].into_iter().flat_map(|p| {
                [
                    significant_or_power(p.median),
                    percent_or_none(p.at_edge),
                    percent_or_none(p.determined),
                ]
            });
            rows.push(Row::new(scientific(w.size, 1), cells.collect::<Vec<_>>()));
        }
    }
    let three = || {
        [
            Column::number("median |ln(k/m found / true)|", ""),
            Column::number("at an edge", "% of searches"),
            Column::number("determined", "% of searches"),
        ]
    };
    Table {
        caption: "What step 4 makes of noise-free records when other parameters are in error"
            .to_owned(),
        stub: "error put in".to_owned(),
        head: vec![vec![
            HeadCell::new("whole runs", 3),
            HeadCell::new("turns at full speed", 3),
        ]],
        columns: three().into_iter().chain(three()).collect(),
        rows,
        footnote: format!(
            "Determined: by the curve's own verdict, its minimum inside the grid and below {} of its largest value.",
            percent(HALF, 1)
        ),
    }
}

fn significant_or_power(value: f64) -> String {
    if value < 1e-3 {
        scientific(value, 2)
    } else {
        significant(value, 2)
    }
}

fn percent_or_none(share: f64) -> String {
    if share == 0.0 {
        MISSING.to_owned()
    } else {
        fixed(100.0 * share, 0)
    }
}
