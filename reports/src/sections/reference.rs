//! How good MuJoCo is as a truth: static elongations and natural modes against independent solutions.

use anyhow::Result;
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Section, Table, Text};

use crate::study::results::{ModeSet, Results};

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let checked = &r.reference;
    let text = Text::new(include_str!("reference.md"))
        .value("calibration_step_us", checked.campaign_step_s * 1e6)
        .value("compound_step_us", checked.compound_step_s * 1e6)
        .value("elongation_nm", checked.static_elongation_m * 1e9)
        .value("elongation_relative", checked.static_elongation_relative);
    let sets = checked.modes.iter();
    sets.fold(text, |text, set| {
        text.table(&format!("modes-{}", set.sensor), modes(set))
    })
    .section("reference")
}

fn modes(set: &ModeSet) -> Table {
    Table::of("mode", 0..6, |i| (i + 1).to_string())
        .col(("eigenvalue solution", "Hz"), |&i| {
            fixed(set.predicted_hz[i], 3)
        })
        .col(("MuJoCo ring-down", "Hz"), |&i| {
            fixed(set.measured_hz[i], 3)
        })
        .col("relative difference", |&i| {
            scientific(set.measured_hz[i] / set.predicted_hz[i] - 1.0, 2)
        })
        .into()
}
