//! Fig. 7: how far the mass moves in the shell, and the frequencies at which that crosses the thresholds.

use anyhow::Result;
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Axis, Figure, Section, Table, Text};
use sixaxis_reference::paper::THRESHOLD_FREQUENCY_HZ;
use sixaxis_reference::rig::run::Mode;

use super::{DEG_PER_RAD, MM_PER_M};
use crate::study::results::{Results, Sweep};

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    Text::new(include_str!("thresholds.md"))
        .figure(figure(r, Mode::Linear, "fig7-linear"))
        .figure(figure(r, Mode::Angular, "fig7-angular"))
        .table("thresholds", table(r))
        .section("thresholds")
}

/// Unit of the paper's thresholds, and how many make an SI unit.
fn unit(mode: Mode) -> (&'static str, f64) {
    match mode {
        Mode::Angular => ("°/s²", DEG_PER_RAD),
        _ => ("mm/s²", MM_PER_M),
    }
}

fn figure(r: &Results, mode: Mode, id: &str) -> Figure {
    let (unit, factor) = unit(mode);
    let printed = match mode {
        Mode::Angular => THRESHOLD_FREQUENCY_HZ.1,
        _ => THRESHOLD_FREQUENCY_HZ.0,
    };
    let mut figure = Figure::new(
        id,
        "",
        Axis::log("drive frequency", "Hz"),
        Axis::log("relative acceleration", unit),
    )
    .horizontal(0.01, "threshold")
    .vertical(printed, format!("paper {printed} Hz"))
    .slope((1.6, 3e-5), 4.0, 0.25, "4");
    for (colour, sweep) in r.thresholds.iter().filter(|s| s.mode == mode).enumerate() {
        let frequency = || sweep.points.iter().map(|p| p.frequency_hz);
        let measured = sweep
            .points
            .iter()
            .map(|p| p.relative_acceleration * factor);
        let theory = sweep.theory.iter().map(|t| t * factor);
        figure = figure
            .points(
                format!("{} sensor, MuJoCo", sweep.sensor),
                colour,
                frequency().zip(measured),
            )
            .dashed(
                format!("{} sensor, linear theory", sweep.sensor),
                colour,
                frequency().zip(theory),
            );
    }
    figure
}

fn table(r: &Results) -> Table {
    let name = |s: &&Sweep| match s.mode {
        Mode::Angular => format!("{}, angular", s.sensor),
        _ => format!("{}, linear", s.sensor),
    };
    let at = |s: &Sweep, i: usize| s.at_2_and_4_hz[i] * unit(s.mode).1;
    let departure = |s: &Sweep| {
        let both = s.points.iter().zip(&s.theory);
        both.map(|(p, t)| (p.relative_acceleration / t - 1.0).abs())
            .fold(0.0, f64::max)
    };
    Table::of("sensor and motion", &r.thresholds, name)
        .col(("crossed at", "Hz"), |s| {
            s.crossing_hz.map_or("none".to_owned(), |f| fixed(f, 3))
        })
        .col("slope on log axes", |s| fixed(s.slope, 4))
        .col(("at 2 Hz", "mm/s² or °/s²"), |s| fixed(at(s, 0), 4))
        .col(("at 4 Hz", "mm/s² or °/s²"), |s| fixed(at(s, 1), 3))
        .col("largest departure from linear theory", |s| {
            scientific(departure(s), 1)
        })
        .into()
}
