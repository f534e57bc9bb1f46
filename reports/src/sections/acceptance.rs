//! Key figures at the top of the page, and the acceptance limits of the study.

use anyhow::{Context, Result};
use sixaxis_page::number::{digits_apart, fixed, percent, scientific};
use sixaxis_page::{Cell, Section, State, Table, Text, Tile};
use sixaxis_props::results::{Laboratories, Published};
use sixaxis_reference::rig::run::Mode;

use super::compound::rate_khz;
use super::{met, stiffness_text};
use crate::study::results::{
    AcceptanceLimit, Correction, FOUR_STEPS, LimitKind, ParameterSet, REPEATED, Results, Standard,
    substepped, worst,
};

/// The tiles at the top.
///
/// # Errors
/// If the published laboratories are none.
pub fn tiles(r: &Results) -> Result<Vec<Tile>> {
    let crossing = |mode| {
        let mut design = r.thresholds.iter().filter(|s| s.sensor == "design");
        let sweep = design.find(|s| s.mode == mode);
        fixed(sweep.and_then(|s| s.crossing_hz).unwrap_or(f64::NAN), 2)
    };
    let laboratory = |correction| {
        let way = substepped(ParameterSet::Identified, correction, Standard::Instruments);
        worst(&r.compound_laboratory, way)
    };
    let published = Laboratories::embedded()?;
    let over_seeds = |errors: &[f64]| {
        Laboratories::quantiles(errors).context("errors of laboratories in the published file")
    };
    let open_loop = over_seeds(&published.identified.open_loop.instruments)?;
    let corrected = over_seeds(&published.identified.corrected.instruments)?;
    let four_steps = worst(&r.compound_noise_free, FOUR_STEPS);
    let repeated = worst(&r.compound_noise_free, REPEATED);
    let stiffness = stiffness_text(r.noise_free.found.stiffness_per_mass_per_s2, 1);
    let required = || {
        let mut all = r.acceptance.iter();
        core::iter::from_fn(move || all.find(|limit| limit.kind == LimitKind::Required))
    };
    let limits_met = required().filter(|limit| limit.met).count();
    Ok(vec![
        Tile::new(
            "Error with laboratory errors",
            percent(open_loop.median, 2),
            format!(
                "largest of 18 cells as the paper compares, 60 dB a sample at {} kHz, median of {} laboratories; worst {}, this seed {}; corrected rest to rest {}, {} and {}; the paper: 7.479 %",
                fixed(rate_khz(r), 0),
                open_loop.count,
                percent(open_loop.max, 2),
                percent(laboratory(Correction::OpenLoop), 2),
                percent(corrected.median, 2),
                percent(corrected.max, 2),
                percent(laboratory(Correction::RestToRest), 2),
            ),
            State::Neutral,
        ),
        Tile::new(
            "The same without errors",
            scientific(four_steps, 2),
            "four steps as printed, against truth; aimed at: 10⁻⁵",
            State::Neutral,
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
            "Required limits met",
            format!("{limits_met} of {}", required().count()),
            "each with its measured value below",
            met(limits_met == required().count()),
        ),
    ])
}

/// The acceptance limits.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    Text::new(include_str!("acceptance.md"))
        .value("quick", r.quick)
        .table("limits", table(r, LimitKind::Required))
        .table("aims", table(r, LimitKind::Aim))
        .section("acceptance")
}

fn table(r: &Results, kind: LimitKind) -> Table {
    let with_unit = |value: f64, l: &AcceptanceLimit| {
        let number = scientific(value, digits_apart(l.value, l.limit, 2));
        match l.unit.as_str() {
            "" => number,
            unit => format!("{number} {unit}"),
        }
    };
    let of_kind = r.acceptance.iter().filter(|limit| limit.kind == kind);
    Table::of("quantity", of_kind, |limit| limit.name.clone())
        .col("measured", |l| {
            Cell::of(l.value, |v| with_unit(v, l)).state(match kind {
                LimitKind::Required => met(l.met),
                LimitKind::Aim => State::Neutral,
            })
        })
        .col(
            match kind {
                LimitKind::Required => "limit",
                LimitKind::Aim => "aimed at",
            },
            |l| with_unit(l.limit, l),
        )
        .text("remark", |l| l.note.clone())
        .into()
}
