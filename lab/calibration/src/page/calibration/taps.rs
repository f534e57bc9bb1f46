//! Taps: k/m from the modes that a blow on the shell rings.

use crate::calibrate::CalibratedSession;
use crate::tap::TapReport;
use sixaxis_core::identify::tap::Tap;
use sixaxis_core::significance::NORMAL_95;

use crate::page::labels::{count, share, unbroken};
use sixaxis_page::number::{MISSING, fixed, scientific};
use sixaxis_page::{Block, Section, Table};

/// The section; empty for a session without taps.
pub fn section(calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "taps",
        "Taps",
        "A blow on the shell, held by the rig, rings the six modes of the mass in it. What nine channels show of their decay \
         determines $k$/$m$.",
    );
    let taps = &calibrated.taps;
    if taps.reports.is_empty() {
        return section;
    }
    let said = match &taps.stiffness {
        Some(found) => format!(
            "{} give $k$/$m$ = {} 1/s² ± {} (95 %): {} from the recordings' noise, {} from errors of inertias and gains, which all \
             taps have in common, and {} from how still the shell is held: if it follows the mass with a hundred times as much, $k$/$m$ \
             comes out so much too large.",
            count(found.taps, "tap", "taps"),
            scientific(found.per_mass_per_s2, 5),
            share(Some(found.half_width_95 / found.per_mass_per_s2)),
            share(Some(found.from_noise / found.per_mass_per_s2)),
            share(Some(found.from_known / found.per_mass_per_s2)),
            share(Some(found.from_holding / found.per_mass_per_s2)),
        ),
        None => "No tap determines $k$/$m$.".to_owned(),
    };
    section
        .block(Block::Note(said))
        .block(Block::Table(table(&taps.reports)))
}

fn table(reports: &[TapReport]) -> Table {
    let of = |report: &TapReport, get: &dyn Fn(&Tap) -> String| {
        report.outcome.as_ref().map_or(MISSING.to_owned(), get)
    };
    let ends = |values: &[f64; 6], write: &dyn Fn(f64) -> String| {
        format!("{} to {}", write(values[0]), write(values[5]))
    };
    Table::of("recording", reports, |report| unbroken(&report.name))
        .col(("$k$/$m$", "10⁸\u{a0}1/s²"), |report| {
            of(report, &|tap| fixed(tap.stiffness_per_mass_per_s2 * 1e-8, 4))
        })
        .col("±\u{a0}95\u{a0}%", |report| {
            of(report, &|tap| share(Some(NORMAL_95 * tap.standard_error_ln)))
        })
        .col(("modes", "Hz"), |report| {
            of(report, &|tap| ends(&tap.mode_frequencies_hz, &|hz| fixed(hz, 0)))
        })
        .col("their damping", |report| {
            of(report, &|tap| ends(&tap.mode_damping_ratios, &|z| share(Some(z))))
        })
        .col("left over", |report| {
            of(report, &|tap| share(Some(tap.residual_over_signal)))
        })
        .text("remark", |report| match &report.outcome {
            Ok(tap) => format!("samples {} to {}", tap.fitted.start, tap.fitted.end),
            Err(cause) => cause.clone(),
        })
        .caption("The taps")
        .footnote(
            "Modes: the lowest and the highest of six. Left over is the residual where the decay is strongest, over the \
             signal: noise, or a shell that was not held still.",
        )
        .into()
}
