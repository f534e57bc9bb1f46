//! Taps: k/m from the modes that a blow on the shell rings.

use crate::calibrate::CalibratedSession;
use crate::tap::TapReport;
use sixaxis_core::significance::NORMAL_95;

use crate::page::labels::{count, share, unbroken};
use sixaxis_page::number::{MISSING, fixed, scientific};
use sixaxis_page::{Block, Cell, Column, Row, Section, Table};

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
            "{} give $k$/$m$ = {} 1/s² ± {} (95 %): {} from the recordings' noise, and {} from errors of inertias and gains, which all \
             taps have in common.",
            count(found.taps, "tap", "taps"),
            scientific(found.per_mass_per_s2, 5),
            share(Some(found.half_width_95 / found.per_mass_per_s2)),
            share(Some(found.from_noise / found.per_mass_per_s2)),
            share(Some(found.from_known / found.per_mass_per_s2)),
        ),
        None => "No tap determines $k$/$m$.".to_owned(),
    };
    section
        .block(Block::Note(said))
        .block(Block::Table(Table {
            caption: "The taps".to_owned(),
            stub: "recording".to_owned(),
            columns: vec![
                Column::number("$k$/$m$", "10⁸\u{a0}1/s²"),
                Column::number("±\u{a0}95\u{a0}%", ""),
                Column::number("modes", "Hz"),
                Column::number("their damping", ""),
                Column::number("left over", ""),
                Column::text("remark"),
            ],
            rows: taps.reports.iter().map(row).collect(),
            footnote: "Modes: the lowest and the highest of six. Left over is the residual where the decay is strongest, over the \
                       signal: noise, or a shell that was not held still."
                .to_owned(),
            ..Table::default()
        }))
}

fn row(report: &TapReport) -> Row {
    let name = unbroken(&report.name);
    match &report.outcome {
        Ok(tap) => {
            let ends = |values: &[f64; 6], write: &dyn Fn(f64) -> String| {
                format!("{} to {}", write(values[0]), write(values[5]))
            };
            Row::new(
                name,
                [
                    Cell::from(fixed(tap.stiffness_per_mass_per_s2 * 1e-8, 4)),
                    Cell::from(share(Some(NORMAL_95 * tap.standard_error_ln))),
                    Cell::from(ends(&tap.mode_frequencies_hz, &|hz| fixed(hz, 0))),
                    Cell::from(ends(&tap.mode_damping_ratios, &|z| share(Some(z)))),
                    Cell::from(share(Some(tap.residual_over_signal))),
                    Cell::from(format!(
                        "samples {} to {}",
                        tap.fitted.start, tap.fitted.end
                    )),
                ],
            )
        }
        Err(cause) => Row::new(
            name,
            [
                Cell::from(MISSING),
                Cell::from(MISSING),
                Cell::from(MISSING),
                Cell::from(MISSING),
                Cell::from(MISSING),
                Cell::from(cause.clone()),
            ],
        ),
    }
}
