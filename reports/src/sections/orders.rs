//! Error of each integration scheme against the sample rate, and the order that its slope shows.

use anyhow::Result;
use sixaxis_page::number::{MISSING, fixed, scientific};
use sixaxis_page::{Axis, Figure, Section, Table, Text};

use crate::study::results::{Order, Results};

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let floor = r.orders.first().map_or(f64::NAN, |o| o.reference_error);
    Text::new(include_str!("orders.md"))
        .value("floor", floor)
        .figure(figure(r, floor))
        .table("orders", table(r))
        .section("orders")
}

fn figure(r: &Results, floor: f64) -> Figure {
    let figure = Figure::new(
        "order-of-schemes",
        "",
        Axis::log("sample rate", "Hz"),
        Axis::log("largest error of w* over its peak", ""),
    )
    .horizontal(floor, "reference");
    let orders = r.orders.iter().enumerate();
    orders.fold(figure, |figure, (colour, order)| {
        let points = order.points.iter().copied();
        figure.line_points(order.scheme.name(), colour, points)
    })
}

fn table(r: &Results) -> Table {
    let at = |o: &Order, rate_hz: f64| {
        let point = o.points.iter().find(|(f, _)| *f == rate_hz);
        scientific(point.map_or(f64::NAN, |(_, error)| *error), 1)
    };
    Table::of("scheme", &r.orders, |o| o.scheme.name().to_owned())
        .col("theory", |o| o.theoretical.to_string())
        .col("measured", |o| {
            o.measured.map_or(MISSING.to_owned(), |m| fixed(m, 3))
        })
        .col("error at 1 kHz", |o| at(o, 1_000.0))
        .col("error at 10 kHz", |o| at(o, 10_000.0))
        .into()
}
