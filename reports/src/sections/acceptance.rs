//! Key figures at the top of the page, and the acceptance limits of the study.

use anyhow::Result;
use sixaxis_page::number::{fixed, percent, scientific};
use sixaxis_page::{Cell, Section, State, Table, Text, Tile};
use sixaxis_reference::rig::run::Mode;

use super::{met, stiffness_text};
use crate::study::results::{FOUR_STEPS, MEASURED, REPEATED, Results, worst};

/// The tiles at the top.
pub fn tiles(r: &Results) -> Vec<Tile> {
    let crossing = |mode| {
        let mut design = r.thresholds.iter().filter(|s| s.sensor == "design");
        let sweep = design.find(|s| s.mode == mode);
        fixed(sweep.and_then(|s| s.crossing_hz).unwrap_or(f64::NAN), 2)
    };
    let laboratory = worst(&r.compound_laboratory, MEASURED);
    let four_steps = worst(&r.compound_noise_free, FOUR_STEPS);
    let repeated = worst(&r.compound_noise_free, REPEATED);
    let stiffness = stiffness_text(r.noise_free.found.stiffness_per_mass_per_s2, 1);
    let limits_met = r.acceptance.iter().filter(|limit| limit.met).count();
    vec![
        Tile::new(
            "Error with laboratory errors",
            percent(laboratory, 2),
            "largest of 18 cells, as the paper compares; the paper: 7.479 %, the limit: 1 %",
            met(laboratory <= 0.01),
        ),
        Tile::new(
            "The same without errors",
            scientific(four_steps, 2),
            "four steps as printed, against truth; the limit: 10⁻⁵",
            met(four_steps <= 1e-5),
        ),
        Tile::new(
            "Steps 2 to 4 repeated",
            scientific(repeated, 2),
            "the limbs' compliance kept; the limit: 10⁻⁵",
            met(repeated <= 1e-5),
        ),
        Tile::new(
            "Threshold frequencies",
            format!(
                "{} / {} Hz",
                crossing(Mode::Linear),
                crossing(Mode::Angular)
            ),
            "linear / angular; the paper reads 2.3 and 2.5 Hz off Fig. 7",
            State::Neutral,
        ),
        Tile::new(
            "k/m found by step 4",
            format!("{stiffness} × 10⁸ s⁻²"),
            match r.laboratory.stiffness_verdict.is_determined() {
                true => "without errors; truth 2.0",
                false => "without errors; truth 2.0. With laboratory errors: not determined",
            },
            State::Neutral,
        ),
        Tile::new(
            "Acceptance limits met",
            format!("{limits_met} of {}", r.acceptance.len()),
            "each with its measured value below",
            State::Neutral,
        ),
    ]
}

/// The acceptance limits.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    Text::new(include_str!("acceptance.md"))
        .value("quick", r.quick)
        .table("limits", table(r))
        .section("acceptance")
}

fn table(r: &Results) -> Table {
    let with_unit = |value: f64, unit: &str| match unit {
        "" => scientific(value, 2),
        unit => format!("{} {unit}", scientific(value, 2)),
    };
    Table::of("quantity", &r.acceptance, |limit| limit.name.clone())
        .col("measured", |l| {
            Cell::of(l.value, |v| with_unit(v, &l.unit)).state(met(l.met))
        })
        .col("limit", |l| with_unit(l.limit, &l.unit))
        .text("remark", |l| l.note.clone())
        .into()
}
