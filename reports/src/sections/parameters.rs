//! Tables 1 to 3 and k/m: the 25 parameters, the paper's and those found here.

use anyhow::Result;
use serde::Serialize;
use sixaxis_calibration::page::labels::verdict;
use sixaxis_page::number::{MISSING, fixed, scientific, significant};
use sixaxis_page::{Cell, Section, Table, Text};
use sixaxis_props::truth::design_parameters;

use super::stiffness_text;
use crate::study::results::{Identification, Parameters25, Results};

/// What a family's errors are relative to.
#[derive(Clone, Copy, PartialEq)]
enum RelativeTo {
    Itself,
    Largest,
    /// Absolute, in the family's unit.
    Nothing,
}

/// Parameters of one kind: their symbol before and after the index, how they are printed, and where they stand.
struct Family {
    id: &'static str,
    symbol: (&'static str, &'static str),
    unit: &'static str,
    per_si: f64,
    decimals: usize,
    relative_to: RelativeTo,
    of: fn(&Parameters25) -> &[f64],
}

const FAMILIES: [Family; 3] = [
    Family {
        id: "zero-drift",
        symbol: ("$d$", ""),
        unit: "mV",
        per_si: 1e3,
        decimals: 3,
        relative_to: RelativeTo::Nothing,
        of: |p| &p.zero_drift_v,
    },
    Family {
        id: "scale",
        symbol: ("$s$", "/$m$"),
        unit: "kg⁻¹",
        per_si: 1.0,
        decimals: 4,
        relative_to: RelativeTo::Itself,
        of: |p| &p.scale_per_mass_per_kg,
    },
    Family {
        id: "inertia",
        symbol: ("$I$", "/$m$"),
        unit: "mm²",
        per_si: 1e6,
        decimals: 4,
        relative_to: RelativeTo::Largest,
        of: |p| &p.inertia_per_mass_m2,
    },
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
    FAMILIES
        .iter()
        .fold(text, |text, family| text.table(family.id, family.table(r)))
        .section("parameters")
}

impl Family {
    fn table(&self, r: &Results) -> Table {
        let of = |p: &Parameters25| (self.of)(p).to_vec();
        let design = of(&design_parameters().into());
        let truth = of(&r.noise_free.truth.into());
        let exact = of(&r.noise_free.found.into());
        let repeated = of(&r.noise_free_repeated.found.into());
        let laboratory = of(&r.laboratory.found.into());
        let reference = of(&r.noise_free.reference_error);
        let standard_error = of(&r.laboratory.standard_error);
        let largest = truth.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let error = |value: f64, i: usize| match self.relative_to {
            RelativeTo::Itself => value / truth[i],
            RelativeTo::Largest => value / largest,
            RelativeTo::Nothing => value * self.per_si,
        };
        let small = |value: f64, i: usize| Cell::of(error(value, i), |e| scientific(e, 2));
        let (rough_unit, percent) = match self.relative_to {
            RelativeTo::Nothing => ("mV", false),
            _ => ("%", true),
        };
        let rough = |value: f64, i: usize| {
            Cell::of(error(value, i), |e| match percent {
                true => fixed(100.0 * e, 4),
                false => significant(e, 2),
            })
        };
        let print = |si: f64| fixed(si * self.per_si, self.decimals);
        let found = |si: f64| Cell::of(si * self.per_si, |v| fixed(v, self.decimals));
        let name = |i: &usize| format!("{}_{{{}}}{}", self.symbol.0, i + 1, self.symbol.1);
        Table::of(self.unit, 0..truth.len(), name)
            .under("paper")
            .col("design", |&i| print(design[i]))
            .col("identified", |&i| print(truth[i]))
            .under("this project, noise-free")
            .col("four steps", |&i| found(exact[i]))
            .col("error", |&i| small(exact[i] - truth[i], i))
            .col("repeated", |&i| small(repeated[i] - truth[i], i))
            .col("reference", |&i| small(reference[i], i))
            .under("with laboratory errors")
            .col("four steps", |&i| found(laboratory[i]))
            .col(("error", rough_unit), |&i| {
                rough(laboratory[i] - truth[i], i)
            })
            .col(("std. error", rough_unit), |&i| rough(standard_error[i], i))
            .into()
    }
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
