//! What any method could know.

use crate::study::results::identifiability::{BandBound, BoundStudy};
use sixaxis_page::number::{fixed, percent, scientific, significant};
use sixaxis_page::{Axis, Block, Column, Figure, Mark, Row, Series, Table};

/// Palette index of the neutral grey.
const NEUTRAL: usize = 6;
/// The paper's band, Hz.
const PAPER_HZ: (f64, f64) = (4.0, 5.0);
/// Lower end of a band over its upper end.
const BAND: f64 = PAPER_HZ.0 / PAPER_HZ.1;
/// Standard deviation that would be worth having.
const WANTED: f64 = 0.01;
/// Standard deviation of the noise of a sample over the peak of a sine 60 dB above it.
pub const NOISE_60_DB: f64 = 1e-3 * core::f64::consts::FRAC_1_SQRT_2;
/// Sample rate at which a number of samples is told as a time, Hz.
const RATE_HZ: f64 = 10_000.0;

/// Figure and table.
pub fn blocks(study: &BoundStudy) -> Vec<Block> {
    let get = |get: fn(&BandBound) -> f64| study.curve.iter().map(move |b| (b.to_hz, get(b)));
    let figure = Figure::new(
        "bound-over-frequency",
        "Smallest possible standard deviation of ln(k/m)",
        Axis::log("upper end of the band", "Hz"),
        Axis::log("standard deviation of ln(k/m)", ""),
    )
    .series(Series::line(
        "three directions",
        0,
        get(|b| b.three_directions),
    ))
    .series(Series::line("six directions", 2, get(|b| b.six_directions)))
    .series(Series::dashed(
        "three directions, scale factors known",
        3,
        get(|b| b.scale_known),
    ))
    .series(Series::dashed(
        "three directions, all but k/m known",
        NEUTRAL,
        get(|b| b.all_else_known),
    ))
    .mark(Mark::vertical(PAPER_HZ.1, "paper: 4–5 Hz"))
    .mark(Mark::vertical(PAPER_HZ.0, ""))
    .mark(Mark::horizontal(WANTED, "1 %"))
    .mark(Mark::slope(20.0, 1.0, -2.0, 0.5, "−2"));
    vec![
        Block::Heading("What any method could know".to_owned()),
        Block::Text(format!(
            "Cramér-Rao bound of ln(k/m) from harmonic motion, linear theory of the sensor without damping: {} frequencies from \
             four fifths of a band's upper end to that end, as 4 to 5 Hz, each with linear and angular motion along three or six \
             directions, {} samples a trial, white noise of {} of the largest channel on each. Nine scale factors and six \
             inertias are unknown with k/m, and the shell's motion is known exactly, which no standard grants: reality is worse. \
             Noise goes with the trial's own largest channel, as amplifiers are set, so the rig's limits on amplitude drop out. \
             Linear theory leaves out the tilt of loaded limbs, at 5 Hz an effect a few times as large as this one: there the \
             bound is an order of magnitude, from 50 Hz on it is more.",
            study.frequencies,
            grouped(study.samples),
            percent(study.noise_over_largest, 1),
        )),
        Block::Figure(figure),
        Block::Table(table(study)),
    ]
}

fn grouped(samples: usize) -> String {
    sixaxis_page::number::count(samples as u64)
}

fn table(study: &BoundStudy) -> Table {
    let rows = study.bands.iter().map(|band| {
        let small = |sd: f64| {
            if sd < 1e-2 {
                scientific(sd, 2)
            } else {
                significant(sd, 2)
            }
        };
        let samples = study.samples as f64 * (band.three_directions / WANTED).powi(2);
        Row::new(
            format!("{} to {} Hz", BAND * band.to_hz, band.to_hz),
            [
                small(band.three_directions),
                small(band.six_directions),
                small(band.scale_known),
                small(band.all_else_known),
                small(band.three_directions * NOISE_60_DB / study.noise_over_largest),
                duration(samples / RATE_HZ),
            ],
        )
    });
    Table {
        caption: "Smallest possible standard deviation of ln(k/m)".to_owned(),
        stub: "band".to_owned(),
        columns: vec![
            Column::number("three directions", ""),
            Column::number("six directions", ""),
            Column::number("scale factors known", ""),
            Column::number("all but k/m known", ""),
            Column::number("three directions at 60 dB", ""),
            Column::number("length of a trial for 1 %", "at 10 kHz"),
        ],
        rows: rows.collect(),
        footnote: "The last column is how long each of the trials along three directions would have to be at the noise of the \
                   first."
            .to_owned(),
        ..Table::default()
    }
}

fn duration(seconds: f64) -> String {
    if seconds >= 86_400.0 {
        format!("{} days", fixed(seconds / 86_400.0, 1))
    } else if seconds >= 0.1 {
        format!("{} s", significant(seconds, 2))
    } else {
        "< 0.1 s".to_owned()
    }
}
