//! The closed form of the four steps' errors against campaigns drawn at random.

use sixaxis_calibration::page::labels::symbol;
use sixaxis_page::number::{MISSING, count, fixed};
use sixaxis_page::{Axis, Cell, Figure, Table, Text};
use sixaxis_props::results::{Band, Propagation, PropagationSet as Set};

/// Departure of a standard deviation that is allowed.
const BAND: f64 = 0.02;
/// Sets that the figure has: noise alone, and everything.
const DRAWN_SETS: usize = 2;

/// Values, figure and table.
pub fn fill(text: Text, published: &Propagation) -> Text {
    let departures = published.sets.iter().map(|set| set.largest_departure);
    text.value("propagation", published)
        .value("propagation_band", BAND)
        .value("largest_departure", departures.fold(0.0, f64::max))
        .value("linear_to_rad", linear_to_rad(published))
        .figure(figure(published))
        .table("propagation", table(published))
}

/// Edge up to which all sets' bands are within the allowed departure, rad.
fn linear_to_rad(published: &Propagation) -> f64 {
    let of = |set: &Set| {
        let bands = set.by_attitude.iter();
        bands
            .take_while(|band| band.rms_departure <= BAND)
            .last()
            .map_or(0.0, |band| band.below_rad)
    };
    published.sets.iter().map(of).fold(f64::INFINITY, f64::min)
}

fn figure(published: &Propagation) -> Figure {
    let names = published.sets.first().into_iter();
    let names = names.flat_map(|set| set.parameters.iter().map(|p| symbol(p.parameter)));
    let mut figure = Figure::new(
        "propagation-ratios",
        "",
        Axis::linear("ratio", ""),
        Axis::names("parameter", names),
    )
    .vertical(1.0 - BAND, "−2 %")
    .vertical(1.0, "")
    .vertical(1.0 + BAND, "+2 %");
    for (set, colour) in published.sets.iter().take(DRAWN_SETS).zip([0, 3]) {
        let ratios = set.parameters.iter().enumerate();
        let points = ratios.map(|(i, p)| (p.ratio, i as f64));
        figure = figure.points(set.sources.clone(), colour, points);
    }
    figure
}

fn table(published: &Propagation) -> Table {
    let edges: Vec<f64> = published.sets.first().map_or(Vec::new(), |set| {
        set.by_attitude.iter().map(|band| band.below_rad).collect()
    });
    let lower = |i: usize| if i == 0 { 0.0 } else { edges[i - 1] };
    let departure = |set: &Set, i: usize, of: fn(&Band) -> f64| {
        let Some(band) = set.by_attitude.get(i) else {
            return Cell::from(MISSING);
        };
        Cell::from(match band.values {
            0 => MISSING.to_owned(),
            _ => fixed(100.0 * of(band), 1),
        })
        .title(format!("{} values", count(band.values)))
    };
    let table = Table::of("attitude (1σ), rad", 0..edges.len(), |i| {
        format!("{} to {}", lower(*i), edges[*i])
    });
    let sets = published.sets.iter();
    sets.fold(table, |table, set| {
        table
            .under(set.sources.clone())
            .col(("rms", "%"), |i| departure(set, *i, |b| b.rms_departure))
            .col(("largest", "%"), |i| {
                departure(set, *i, |b| b.largest_departure)
            })
    })
    .into()
}
