//! The six accelerations of the 5 Hz compound run over time, and their errors.

use anyhow::Result;
use sixaxis_page::figure::{NEUTRAL, paired};
use sixaxis_page::{Axis, Figure, Section, Text};

use crate::study::results::{History, Results};

const IDS: [&str; 6] = [
    "history-a-x",
    "history-a-y",
    "history-a-z",
    "history-angular-x",
    "history-angular-y",
    "history-angular-z",
];

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let text =
        Text::new(include_str!("histories.md")).value("frequency_hz", r.history.frequency_hz);
    let all = IDS.iter().enumerate();
    all.fold(text, |text, (axis, id)| {
        text.figure(figure(&r.history, axis, id))
    })
    .section("histories")
}

fn figure(h: &History, axis: usize, id: &str) -> Figure {
    let unit = if axis < 3 { "m/s²" } else { "rad/s²" };
    let peak = h.truth[axis].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let relative = |error: &[f64]| -> Vec<f64> {
        let shares = error.iter().map(|e| (e / peak).abs());
        // A logarithmic axis has no place for an error of zero.
        shares.map(|share| share.max(1e-9)).collect()
    };
    Figure::new(
        id,
        "",
        Axis::linear("time", "s"),
        Axis::linear("acceleration", unit),
    )
    .line("truth", NEUTRAL, paired(&h.time_s, &h.truth[axis]))
    .dashed(
        "decoupled, laboratory errors",
        3,
        paired(&h.time_s, &h.laboratory[axis]),
    )
    .below(Axis::log("|error| / peak", "").range(1e-9, 1e-1))
    .line(
        "",
        3,
        paired(&h.time_s, &relative(&h.error_laboratory[axis])),
    )
    .line(
        "error, noise-free",
        0,
        paired(&h.time_s, &relative(&h.error_noise_free[axis])),
    )
}
