//! What any method could know of k/m: the Cramér-Rao bound over the frequency of the excitation.

use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::{fixed, scientific, significant};
use sixaxis_page::{Axis, Figure, Table, Text};

use crate::study::results::identifiability::{BandBound, BoundStudy};

/// The paper's band, Hz.
const PAPER_HZ: (f64, f64) = (4.0, 5.0);
/// Lower end of a band over its upper end.
const BAND: f64 = PAPER_HZ.0 / PAPER_HZ.1;
/// Standard deviation that would be worth having.
const WANTED: f64 = 0.01;
/// Standard deviation of the noise of a sample over the peak of a sine 60 dB above it.
const NOISE_60_DB: f64 = 1e-3 * core::f64::consts::FRAC_1_SQRT_2;
/// Sample rate at which a number of samples is told as a time, Hz.
const RATE_HZ: f64 = 10_000.0;

/// Values, figure and table.
pub fn fill(text: Text, study: &BoundStudy) -> Text {
    let band = |to_hz: f64, of: fn(&BandBound) -> f64| {
        let mut bands = study.bands.iter();
        bands.find(|band| band.to_hz == to_hz).map_or(f64::NAN, of)
    };
    text.value("bound", study)
        .value(
            "paper_band",
            band(PAPER_HZ.1, |b| b.tilted_three_directions),
        )
        .value(
            "paper_linear_motion",
            band(PAPER_HZ.1, |b| b.tilted_linear_motion),
        )
        .value(
            "paper_linear_theory",
            band(PAPER_HZ.1, |b| b.three_directions),
        )
        .value("fast_band", band(500.0, |b| b.tilted_three_directions))
        .value("quiet", NOISE_60_DB / study.noise_over_largest)
        .figure(figure(study))
        .table("bound", table(study))
}

fn figure(study: &BoundStudy) -> Figure {
    let over = |bound: fn(&BandBound) -> f64| study.curve.iter().map(move |b| (b.to_hz, bound(b)));
    Figure::new(
        "bound-over-frequency",
        "",
        Axis::log("upper end of the band", "Hz"),
        Axis::log("standard deviation of ln(k/m)", ""),
    )
    .line("three directions", 0, over(|b| b.tilted_three_directions))
    .line("six directions", 2, over(|b| b.tilted_six_directions))
    .dashed(
        "three directions, linear theory",
        1,
        over(|b| b.three_directions),
    )
    .dashed("the same, scale factors known", 3, over(|b| b.scale_known))
    .dashed(
        "the same, all but k/m known",
        NEUTRAL,
        over(|b| b.all_else_known),
    )
    .vertical(PAPER_HZ.1, "paper: 4–5 Hz")
    .vertical(PAPER_HZ.0, "")
    .horizontal(WANTED, "1 %")
    .slope((20.0, 1.0), -2.0, 0.5, "−2")
}

fn table(study: &BoundStudy) -> Table {
    let small = |sd: f64| match sd {
        0.0..1e-2 => scientific(sd, 2),
        _ => significant(sd, 2),
    };
    Table::of("band", &study.bands, |b| {
        format!("{} to {} Hz", BAND * b.to_hz, b.to_hz)
    })
    .col("three directions", |b| small(b.tilted_three_directions))
    .col("six directions", |b| small(b.tilted_six_directions))
    .col(
        ("three directions", "linear motion alone, I/m known"),
        |b| small(b.tilted_linear_motion),
    )
    .col(("three directions", "linear theory"), |b| {
        small(b.three_directions)
    })
    .col(("scale factors known", "linear theory"), |b| {
        small(b.scale_known)
    })
    .col(("all but k/m known", "linear theory"), |b| {
        small(b.all_else_known)
    })
    .col("three directions at 60 dB", |b| {
        small(b.tilted_three_directions * NOISE_60_DB / study.noise_over_largest)
    })
    .col(("length of a trial for 1 %", "at 10 kHz"), |b| {
        let samples = study.samples as f64 * (b.tilted_three_directions / WANTED).powi(2);
        duration(samples / RATE_HZ)
    })
    .into()
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s >= 86_400.0 => format!("{} days", fixed(s / 86_400.0, 1)),
        s if s >= 0.1 => format!("{} s", significant(s, 2)),
        _ => "< 0.1 s".to_owned(),
    }
}
