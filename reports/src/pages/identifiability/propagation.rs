//! The closed form of the four steps' errors against campaigns drawn at random.

use super::coverage::place;
use super::published::{MAKE_PROPAGATION, Propagation, Set};
use sixaxis_calibration::page::labels::symbol;
use sixaxis_page::number::{MISSING, count, fixed, percent};
use sixaxis_page::{Axis, Block, Cell, Column, Figure, HeadCell, Mark, Row, Series, Table};

/// Departure of a standard deviation that is allowed.
const BAND: f64 = 0.02;
/// Sets that the figure has: noise alone, and everything.
const DRAWN_SETS: usize = 2;

/// Text, figure, table.
pub fn blocks(published: &Propagation) -> Vec<Block> {
    vec![
        Block::Heading("Standard deviations in closed form".to_owned()),
        Block::Text(format!(
            "The four steps' intervals above come from first-order propagation of noise, gains and wedges through all steps. Held \
             against {} campaigns drawn at random ({MAKE_PROPAGATION}), the 25 standard deviations depart by at most {}; a drawn one \
             is itself known to {}.",
            count(published.draws),
            percent(
                published
                    .sets
                    .iter()
                    .map(|set| set.largest_departure)
                    .fold(0.0, f64::max),
                2
            ),
            percent(published.drawn_to, 1),
        )),
        Block::Figure(figure(published)),
        Block::Table(table(published)),
        Block::Text(format!(
            "First order ends where the attitude is lost: decoupling is open loop. Up to {} rad of the attitude's own standard \
             deviation, those of the accelerations are right to {} (rms) in all sets; with an attitude uncertain by a \
             radian the sine of it is no longer the angle, and the closed form only says that nothing is known.",
            linear_to_rad(published),
            percent(BAND, 1),
        )),
    ]
}

/// Edge up to which all sets' bands are within the allowed departure, rad.
fn linear_to_rad(published: &Propagation) -> f64 {
    let of = |set: &Set| {
        set.by_attitude
            .iter()
            .take_while(|band| band.rms_departure <= BAND)
            .last()
            .map_or(0.0, |band| band.below_rad)
    };
    published.sets.iter().map(of).fold(f64::INFINITY, f64::min)
}

fn figure(published: &Propagation) -> Figure {
    let Some(first) = published.sets.first() else {
        return Figure::default();
    };
    let mut figure = Figure::new(
        "propagation-ratios",
        "Standard deviation, closed form over drawn",
        Axis::linear("ratio", ""),
        Axis::names(
            "parameter",
            first.parameters.iter().map(|p| symbol(p.parameter)),
        ),
    )
    .mark(Mark::vertical(1.0 - BAND, "−2 %"))
    .mark(Mark::vertical(1.0, ""))
    .mark(Mark::vertical(1.0 + BAND, "+2 %"));
    for (set, colour) in published.sets.iter().take(DRAWN_SETS).zip([0, 3]) {
        let points = set.parameters.iter().enumerate();
        figure = figure.series(Series::points(
            set.sources.clone(),
            colour,
            points.map(|(i, p)| (p.ratio, place(i))),
        ));
    }
    figure
}

fn table(published: &Propagation) -> Table {
    let bands = published
        .sets
        .first()
        .map_or(0, |set| set.by_attitude.len());
    let mut from = 0.0;
    let rows = (0..bands).map(|i| {
        let edge = published.sets[0].by_attitude[i].below_rad;
        let header = format!("{from} to {edge}");
        from = edge;
        Row::new(header, published.sets.iter().flat_map(|set| cells(set, i)))
    });
    Table {
        caption: "Decoupled accelerations: departure of the closed form from the drawn standard deviation".to_owned(),
        stub: "attitude (1σ), rad".to_owned(),
        head: vec![
            published
                .sets
                .iter()
                .map(|set| HeadCell::new(set.sources.clone(), 2))
                .collect(),
        ],
        columns: published
            .sets
            .iter()
            .flat_map(|_| [Column::number("rms", "%"), Column::number("largest", "%")])
            .collect(),
        rows: rows.collect(),
        footnote: "Six compound runs, 1 to 5 Hz, with and without gravity turning in the shell; every sample of every axis is a \
                   value. A dash: no sample has so uncertain an attitude."
            .to_owned(),
    }
}

fn cells(set: &Set, band: usize) -> [Cell; 2] {
    let cell = |share: f64, values: u64| {
        let text = if values == 0 {
            MISSING.to_owned()
        } else {
            fixed(100.0 * share, 1)
        };
        Cell::from(text).title(format!("{} values", count(values)))
    };
    set.by_attitude.get(band).map_or_else(
        || [Cell::from(MISSING), Cell::from(MISSING)],
        |b| {
            [
                cell(b.rms_departure, b.values),
                cell(b.largest_departure, b.values),
            ]
        },
    )
}
