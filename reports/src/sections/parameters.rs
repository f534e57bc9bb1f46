//! Tables 1 to 3 and k/m: the 25 parameters, the paper's and those found here.

use core::ops::Range;

use anyhow::Result;
use serde::Serialize;
use sixaxis_calibration::page::labels::{symbol, verdict};
use sixaxis_core::Parameter;
use sixaxis_core::parameter::{DRIFT, INERTIA, SCALE};
use sixaxis_page::number::{MISSING, fixed, scientific, significant};
use sixaxis_page::{Cell, Section, Table, Text};
use sixaxis_props::truth::design_parameters;

use super::stiffness_text;
use crate::study::results::{Identification, Results};

/// One of Tables 1 to 3: its place in the text, its parameters, the unit they are printed in, that unit over SI, decimals.
type Printed = (&'static str, Range<usize>, &'static str, f64, usize);

const TABLES: [Printed; 3] = [
    ("zero-drift", DRIFT, "mV", 1e3, 3),
    ("scale", SCALE, "kg⁻¹", 1.0, 4),
    ("inertia", INERTIA, "mm²", 1e6, 4),
];

/// A campaign's identification as the text has it.
#[derive(Serialize)]
struct Run<'a> {
    name: &'a str,
    found: &'a Identification,
    scale_verdict: String,
    inertia_verdict: String,
}

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let runs = [
        ("noise-free", &r.noise_free),
        ("repeated", &r.noise_free_repeated),
        ("laboratory", &r.laboratory),
    ];
    let runs = runs.map(|(name, found)| Run {
        name,
        found,
        scale_verdict: verdict(&found.scale_verdict),
        inertia_verdict: verdict(&found.inertia_verdict),
    });
    let text = Text::new(include_str!("parameters.md"))
        .value("runs", runs)
        .value(
            "true_rate_over_reading",
            1.0 / (1.0 + r.instruments.gyroscope_gain_error),
        )
        .table("stiffness", stiffness(r));
    TABLES
        .into_iter()
        .fold(text, |text, printed| {
            text.table(printed.0, table(r, printed))
        })
        .section("parameters")
}

/// Errors of drifts are absolute, those of scale factors relative to the value, and those of inertias to the largest.
fn table(r: &Results, (_, places, unit, per_si, decimals): Printed) -> Table {
    let design = design_parameters().to_paper_order();
    let truth = r.noise_free.truth.to_paper_order();
    let exact = r.noise_free.found.to_paper_order();
    let repeated = r.noise_free_repeated.found.to_paper_order();
    let laboratory = r.laboratory.found.to_paper_order();
    let reference = r.noise_free.reference_error.to_paper_order();
    let standard_error = r.laboratory.standard_error.to_paper_order();
    let absolute = places == DRIFT;
    let largest = |a: f64, p: usize| a.max(truth[p].abs());
    let largest = places.clone().fold(0.0, largest);
    let error = |value: f64, p: usize| {
        if absolute {
            value * per_si
        } else if SCALE.contains(&p) {
            value / truth[p]
        } else {
            value / largest
        }
    };
    let small = |value: f64, p: usize| Cell::of(error(value, p), |e| scientific(e, 2));
    let rough = |value: f64, p: usize| {
        Cell::of(error(value, p), |e| match absolute {
            true => significant(e, 2),
            false => fixed(100.0 * e, 4),
        })
    };
    let rough_unit = if absolute { "mV" } else { "%" };
    let print = |si: f64| fixed(si * per_si, decimals);
    let found = |si: f64| Cell::of(si * per_si, |v| fixed(v, decimals));
    let name = |p: &usize| Parameter::at(*p).map_or(String::new(), symbol);
    Table::of(unit, places, name)
        .under("paper")
        .col("design", |&p| print(design[p]))
        .col("identified", |&p| print(truth[p]))
        .under("this project, noise-free")
        .col("four steps", |&p| found(exact[p]))
        .col("error", |&p| small(exact[p] - truth[p], p))
        .col("repeated", |&p| small(repeated[p] - truth[p], p))
        .col("reference", |&p| small(reference[p], p))
        .under("with laboratory errors")
        .col("four steps", |&p| found(laboratory[p]))
        .col(("error", rough_unit), |&p| {
            rough(laboratory[p] - truth[p], p)
        })
        .col(("std. error", rough_unit), |&p| rough(standard_error[p], p))
        .into()
}

fn stiffness(r: &Results) -> Table {
    let runs = [
        ("noise-free", &r.noise_free),
        ("noise-free, repeated", &r.noise_free_repeated),
        ("with laboratory errors", &r.laboratory),
    ];
    Table::of("10⁸ s⁻²", runs, |(name, _)| (*name).to_owned())
        .col("grid minimum", |(_, i)| {
            stiffness_text(i.found.stiffness_per_mass_per_s2, 1)
        })
        .col("between grid points", |(_, i)| {
            if i.stiffness_verdict.is_determined() {
                stiffness_text(i.stiffness_interpolated_per_s2, 4)
            } else {
                MISSING.to_owned()
            }
        })
        .text("verdict", |(_, i)| verdict(&i.stiffness_verdict))
        .into()
}
