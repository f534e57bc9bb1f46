//! All 129 sets of excluded limbs: which leave six axes, and what they do to noise and errors.

use sixaxis_page::number::fixed;
use sixaxis_page::{Axis, Cell, Figure, State, Table, TableBuilder, Text};
use sixaxis_props::results::{ExcludedSet as Set, FailedLimbs};

/// Growth of noise from which a set is marked.
const DEAR: f64 = 2.0;
/// The acceptance limit of the error with laboratory errors, over the healthy decoder's.
const LIMIT: f64 = 2.0;
const LIMBS: usize = 9;
/// Sets by size: name, limbs, colour.
const SIZES: [(&str, usize, usize); 3] = [("one limb", 1, 0), ("two", 2, 1), ("three", 3, 3)];

/// Values, tables and figures.
pub fn fill(text: Text, limbs: &FailedLimbs) -> Text {
    let worst = |of: fn(&Set) -> Option<f64>| {
        let ratios = limbs.sets.iter().filter_map(of);
        ratios.fold(f64::NAN, f64::max)
    };
    let healthy = limbs.healthy_largest_error.iter().map(|e| 100.0 * e);
    let lost = limbs.sets.iter().filter(|set| set.failed.len() == 2);
    let lost = lost.filter_map(|set| Some(format!("{}: {}", name(set), set.lost.as_ref()?)));
    text.value("limbs", limbs)
        .value("sets", limbs.sets.len())
        .value("lost_pairs", lost.collect::<Vec<_>>())
        .value(
            "healthy_percent",
            [healthy.clone().reduce(f64::min), healthy.reduce(f64::max)],
        )
        .value("worst_ratio", worst(|s| s.error_ratio))
        .value(
            "worst_ratio_consistent",
            worst(|s| s.error_ratio_consistent),
        )
        .table("pairs", pairs(limbs))
        .table("triples", triples(limbs))
        .figure(noise(limbs))
        .figure(errors(limbs))
}

/// The growth of that of the six accelerations that suffers most.
fn largest(set: &Set) -> Option<f64> {
    let growth = set.amplification?.into_iter();
    Some(growth.fold(0.0, f64::max))
}

/// "1, 6, 9".
fn name(set: &Set) -> String {
    let numbers: Vec<String> = set.failed.iter().map(usize::to_string).collect();
    numbers.join(", ")
}

fn cell(set: Option<&Set>) -> Cell {
    let Some(set) = set else {
        return Cell::from("");
    };
    let title = format!("{} excluded", name(set));
    match (largest(set), &set.lost) {
        (Some(growth), _) => Cell::from(fixed(growth, 2))
            .title(title)
            .state(if growth > DEAR {
                State::Warn
            } else {
                State::Good
            }),
        (None, Some(load)) => Cell::from("lost")
            .title(format!("{title}: {load}"))
            .state(State::Bad),
        (None, None) => Cell::from(""),
    }
}

/// One column for each last limb from `first` on; `set` is what a row excludes with it.
fn by_last_limb<R>(
    table: TableBuilder<R>,
    limbs: &FailedLimbs,
    first: usize,
    set: impl Fn(&R, usize) -> Vec<usize>,
) -> Table {
    let columns = first..=LIMBS;
    let column = |table: TableBuilder<R>, limb: usize| {
        table.col(limb.to_string(), |row| {
            let excluded = set(row, limb);
            cell(limbs.sets.iter().find(|set| set.failed == excluded))
        })
    };
    columns.fold(table, column).into()
}

fn pairs(limbs: &FailedLimbs) -> Table {
    let table = Table::of("limb", 1..=LIMBS, usize::to_string);
    by_last_limb(table, limbs, 1, |&a, b| match a == b {
        true => vec![a],
        false => vec![a.min(b), a.max(b)],
    })
}

fn triples(limbs: &FailedLimbs) -> Table {
    let rows = (1..=LIMBS).flat_map(|a| (a + 1..LIMBS).map(move |b| (a, b)));
    let table = Table::of("limbs", rows, |(a, b)| format!("{a}, {b}"));
    by_last_limb(table, limbs, 3, |&(a, b), c| vec![a, b, c])
}

fn noise(limbs: &FailedLimbs) -> Figure {
    let figure = Figure::new(
        "failed-limbs-noise",
        "",
        Axis::linear("closed form", ""),
        Axis::linear("measured", ""),
    );
    SIZES
        .into_iter()
        .fold(figure, |figure, (name, size, colour)| {
            let sets = limbs.sets.iter();
            let points = sets
                .filter(|set| set.failed.len() == size && set.lost.is_none())
                .filter_map(|set| Some((set.amplification?, set.amplification_measured?)))
                .flat_map(|(closed, measured)| closed.into_iter().zip(measured));
            figure.points(name, colour, points)
        })
}

fn errors(limbs: &FailedLimbs) -> Figure {
    let points = |of: fn(&Set) -> Option<f64>| {
        let sets = limbs.sets.iter();
        sets.filter_map(move |set| Some((largest(set)?, of(set)?)))
    };
    Figure::new(
        "failed-limbs-errors",
        "",
        Axis::linear("growth of noise", ""),
        Axis::linear("growth of the error", ""),
    )
    .points("as calibrated", 3, points(|s| s.error_ratio))
    .points(
        "consistent scale factors",
        0,
        points(|s| s.error_ratio_consistent),
    )
    .horizontal(LIMIT, "twice")
}
