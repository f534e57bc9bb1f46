//! The budget of 7.479 %: which imperfections of which size make the paper's error.

use anyhow::Result;
use serde::Serialize;
use sixaxis_page::number::{MISSING, fixed, significant};
use sixaxis_page::{Axis, Figure, Section, Table, Text};
use sixaxis_props::results::{
    Budget, Cells, Errors, Imperfect, Ladder, PRINTED, Published, headline, median_of,
};

/// Imperfections of the sensor; the others are of rig and laboratory.
const OF_THE_SENSOR: [&str; 4] = [
    "unequal stiffness",
    "flexures that bend",
    "flexures that damp",
    "limbs with mass",
];

/// Two headings of a column, and which number stands in it.
type Way = (&'static str, &'static str, fn(&Errors) -> Cells);

/// Columns.
const WAYS: [Way; 4] = [
    ("true parameters", "open loop", |e| e.with_truth.open_loop),
    ("true parameters", "corrected", |e| e.with_truth.corrected),
    ("identified", "open loop", |e| e.identified.open_loop),
    ("identified", "corrected", |e| e.identified.corrected),
];

/// Largest errors of a laboratory without imperfections.
#[derive(Serialize)]
struct Nothing {
    open_loop: f64,
    corrected: f64,
}

/// The section.
///
/// # Errors
/// If the published result cannot be read, or the text does not fit it.
pub fn section() -> Result<Section> {
    let budget = Budget::embedded()?;
    let ladders = budget.ladders();
    let nothing = nothing(&budget);
    let draws = ladders.iter().flat_map(|ladder| &ladder.steps);
    Text::new(include_str!("budget.md"))
        .value("make", Budget::MAKE)
        .value("trials", budget.trials_per_step)
        .value("draws", draws.map(|(_, d)| d.len()).max().unwrap_or(0))
        .value(
            "nothing",
            Nothing {
                open_loop: nothing.map_or(f64::NAN, |e| e.identified.open_loop.largest),
                corrected: nothing.map_or(f64::NAN, |e| e.identified.corrected.largest),
            },
        )
        .figure(figure("budget-sensor", &ladders, true))
        .figure(figure("budget-laboratory", &ladders, false))
        .table("budget-alone", alone(&ladders))
        .table("budget", table(&ladders))
        .table("budget-combinations", combinations(&budget))
        .section("budget")
}

/// Errors of the laboratory without imperfections.
pub fn nothing(budget: &Budget) -> Option<Errors> {
    let laboratory = budget.combined(false).into_iter().flatten().next();
    laboratory.and_then(|laboratory| laboratory.errors)
}

fn figure(id: &str, ladders: &[Ladder], of_the_sensor: bool) -> Figure {
    let wanted = ladders
        .iter()
        .filter(|ladder| OF_THE_SENSOR.contains(&ladder.name) == of_the_sensor);
    let figure = Figure::new(
        id,
        "",
        Axis::log("size, in the unit of its line", ""),
        Axis::log("largest error over the peak", "%"),
    );
    wanted
        .enumerate()
        .fold(figure, |figure, (colour, ladder)| {
            let points = ladder.points(headline).into_iter();
            let label = format!("{}, {}", ladder.name, ladder.unit);
            figure.line_points(label, colour, points.map(|(x, y)| (x, 100.0 * y)))
        })
        .horizontal(100.0 * PRINTED, "the paper's 7.479 %")
}

fn alone(ladders: &[Ladder]) -> Table {
    let table = Table::of("imperfection", ladders, |ladder| ladder.name.to_owned())
        .col("unit", |ladder| ladder.unit.to_owned());
    WAYS.into_iter()
        .fold(table, |table, (parameters, correction, of)| {
            table
                .under(parameters)
                .col(correction, move |ladder: &&Ladder| {
                    let sizes = ladder.alone(|errors| of(errors).largest);
                    sizes.map_or_else(
                        || MISSING.to_owned(),
                        |[less, more]| {
                            format!("{} to {}", significant(less, 1), significant(more, 1))
                        },
                    )
                })
        })
        .into()
}

/// Largest and median of the 18 cells of the median laboratory, %.
fn cells(draws: &[&Imperfect], of: fn(&Errors) -> Cells) -> String {
    let number = |pick: fn(Cells) -> f64| {
        let value = median_of(draws, |errors| pick(of(errors)));
        value.map(|share| significant(100.0 * share, 2))
    };
    match (number(|c| c.largest), number(|c| c.median)) {
        (Some(largest), Some(median)) => format!("{largest} ({median})"),
        _ => MISSING.to_owned(),
    }
}

fn table(ladders: &[Ladder]) -> Table {
    let table = ladders
        .iter()
        .fold(Table::grouped("size"), |table, ladder| {
            let heading = format!("{}, {}", ladder.name, ladder.unit);
            table.group(heading, &ladder.steps, |(size, _)| significant(*size, 1))
        });
    WAYS.into_iter()
        .fold(table, |table, (parameters, correction, of)| {
            table
                .under(parameters)
                .col((correction, "%"), move |(_, draws)| cells(draws, of))
        })
        .into()
}

fn combinations(budget: &Budget) -> Table {
    let groups = budget.combined(true);
    let name = |draws: &Vec<&Imperfect>| {
        let parts = draws.first().map_or(&[][..], |first| &first.parts);
        let parts = parts.iter();
        let texts = parts.map(|p| format!("{} {} ({})", p.name, significant(p.size, 2), p.unit));
        texts.collect::<Vec<_>>().join("; ")
    };
    let table = Table::of("together", groups, name)
        .col("laboratories", |draws| fixed(draws.len() as f64, 0));
    WAYS.into_iter()
        .fold(table, |table, (parameters, correction, of)| {
            table
                .under(parameters)
                .col((correction, "%"), move |draws: &Vec<&Imperfect>| {
                    cells(draws, of)
                })
        })
        .into()
}
