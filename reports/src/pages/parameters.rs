//! Tables 1 to 3 and k/m: the 25 parameters, the paper's and ours.

use sixaxis_calibration::page::labels::verdict;
use sixaxis_props::truth;

use crate::study::results::{Identification, Results};
use sixaxis_page::number::{MISSING, fixed, scientific, significant};
use sixaxis_page::{Block, Cell, Column, HeadCell, Row, Section, Table};

/// Where a column's numbers come from.
type Get = fn(&Identification) -> Vec<f64>;

struct Family {
    caption: &'static str,
    /// Before and after the index.
    symbol: (&'static str, &'static str),
    unit: &'static str,
    per_si: f64,
    decimals: usize,
    design: Vec<f64>,
    truth: Get,
    found: Get,
    reference: Get,
    standard_error: Get,
    /// Errors are over this: each value, or the largest of the family, or nothing (absolute, in the unit).
    relative_to: RelativeTo,
    note: &'static str,
}

#[derive(PartialEq)]
enum RelativeTo {
    Itself,
    Largest,
    Nothing,
}

fn families() -> Vec<Family> {
    let design = truth::design_parameters();
    vec![
        Family {
            caption: "Table 1: zero drift",
            symbol: ("$d$", ""),
            unit: "mV",
            per_si: 1e3,
            decimals: 3,
            design: design.zero_drift_v.to_vec(),
            truth: |i| i.truth.zero_drift_v.to_vec(),
            found: |i| i.found.zero_drift_v.to_vec(),
            reference: |i| i.reference_error.zero_drift_v.to_vec(),
            standard_error: |i| i.standard_error.zero_drift_v.to_vec(),
            relative_to: RelativeTo::Nothing,
            note: "Ten minutes at rest. Errors in mV, also of the repetition.",
        },
        Family {
            caption: "Table 2: scale factor over mass",
            symbol: ("$s$", "/$m$"),
            unit: "kg⁻¹",
            per_si: 1.0,
            decimals: 4,
            design: design.scale_per_mass_per_kg.to_vec(),
            truth: |i| i.truth.scale_per_mass_per_kg.to_vec(),
            found: |i| i.found.scale_per_mass_per_kg.to_vec(),
            reference: |i| i.reference_error.scale_per_mass_per_kg.to_vec(),
            standard_error: |i| i.standard_error.scale_per_mass_per_kg.to_vec(),
            relative_to: RelativeTo::Itself,
            note: "Errors, also of the repetition, relative to the value. The laboratory's share one error, the gain of its standard accelerometer.",
        },
        Family {
            caption: "Table 3: inertia over mass",
            symbol: ("$I$", "/$m$"),
            unit: "mm²",
            per_si: 1e6,
            decimals: 4,
            design: design.inertia_per_mass.to_paper_order().to_vec(),
            truth: |i| i.truth.inertia_per_mass.to_paper_order().to_vec(),
            found: |i| i.found.inertia_per_mass.to_paper_order().to_vec(),
            reference: |i| i.reference_error.inertia_per_mass_m2.to_vec(),
            standard_error: |i| i.standard_error.inertia_per_mass_m2.to_vec(),
            relative_to: RelativeTo::Largest,
            note: "Errors, also of the repetition, relative to the largest entry.",
        },
    ]
}

/// The section.
pub fn section(r: &Results) -> Section {
    let mut section = Section::new(
        "parameters",
        "Tables 1 to 3: the 25 parameters",
        "The simulated sensor has the paper's *identified* columns as its truth; the four steps start from the design and see \
         only recordings. What halving the simulator's step changes stands beside each error."
            .replace('*', ""),
    );
    for family in families() {
        section = section.block(Block::Table(table(&family, r)));
    }
    section
        .block(Block::Table(stiffness(r)))
        .block(Block::Text(steps(r)))
}

fn table(family: &Family, r: &Results) -> Table {
    let truth = (family.truth)(&r.noise_free);
    let exact = (family.found)(&r.noise_free);
    let repeated = (family.found)(&r.noise_free_repeated);
    let laboratory = (family.found)(&r.laboratory);
    let reference = (family.reference)(&r.noise_free);
    let standard_error = (family.standard_error)(&r.laboratory);
    let largest = truth.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let error = |value: f64, i: usize| match family.relative_to {
        RelativeTo::Itself => value / truth[i],
        RelativeTo::Largest => value / largest,
        RelativeTo::Nothing => value * family.per_si,
    };
    let small = |value: f64, i: usize| {
        let e = error(value, i);
        let text = if e == 0.0 {
            "0".to_owned()
        } else {
            scientific(e, 2)
        };
        Cell::from(text).title(e.to_string())
    };
    let rough = |value: f64, i: usize| {
        let e = error(value, i);
        Cell::from(if family.relative_to == RelativeTo::Nothing {
            significant(e, 2)
        } else {
            fixed(100.0 * e, 4)
        })
        .title(e.to_string())
    };
    let print = |si: f64| fixed(si * family.per_si, family.decimals);
    let rows = (0..truth.len()).map(|i| {
        Row::new(
            format!("{}_{{{}}}{}", family.symbol.0, i + 1, family.symbol.1),
            vec![
                Cell::from(print(family.design[i])),
                Cell::from(print(truth[i])),
                Cell::from(print(exact[i])).title((exact[i] * family.per_si).to_string()),
                small(exact[i] - truth[i], i),
                small(repeated[i] - truth[i], i),
                small(reference[i], i),
                Cell::from(print(laboratory[i])).title((laboratory[i] * family.per_si).to_string()),
                rough(laboratory[i] - truth[i], i),
                rough(standard_error[i], i),
            ],
        )
    });
    Table {
        caption: family.caption.to_owned(),
        stub: family.unit.to_owned(),
        head: vec![vec![
            HeadCell::new("paper", 2),
            HeadCell::new("this project, noise-free", 4),
            HeadCell::new("with laboratory errors", 3),
        ]],
        columns: vec![
            Column::number("design", ""),
            Column::number("identified", ""),
            Column::number("four steps", ""),
            Column::number("error", ""),
            Column::number("repeated", ""),
            Column::number("reference", ""),
            Column::number("four steps", ""),
            Column::number("error", family.rough_unit()),
            Column::number("std. error", family.rough_unit()),
        ],
        rows: rows.collect(),
        footnote: family.note.to_owned(),
    }
}

impl Family {
    /// Unit of the laboratory's errors.
    fn rough_unit(&self) -> &'static str {
        match self.relative_to {
            RelativeTo::Nothing => "mV",
            _ => "%",
        }
    }
}

fn stiffness(r: &Results) -> Table {
    let row = |name: &str, i: &Identification| {
        Row::new(
            name,
            vec![
                Cell::from(fixed(i.found.stiffness_per_mass_per_s2 / 1e8, 1)),
                Cell::from(if i.stiffness_verdict.is_determined() {
                    fixed(i.stiffness_interpolated_per_s2 / 1e8, 4)
                } else {
                    MISSING.to_owned()
                }),
                Cell::from(verdict(&i.stiffness_verdict)),
            ],
        )
    };
    Table {
        caption: "Step 4: stiffness over mass (design 3.1, found by the paper and true here 2.0)"
            .to_owned(),
        stub: "10⁸ s⁻²".to_owned(),
        columns: vec![
            Column::number("grid minimum", ""),
            Column::number("between grid points", ""),
            Column::text("verdict"),
        ],
        rows: vec![
            row("noise-free", &r.noise_free),
            row("noise-free, repeated", &r.noise_free_repeated),
            row("with laboratory errors", &r.laboratory),
        ],
        ..Table::default()
    }
}

fn steps(r: &Results) -> String {
    let line = |name: &str, i: &Identification| {
        let gain = i.rate_over_reading.map_or(String::new(), |(gain, error)| {
            format!(
                "; true rate over gyroscope reading found as {} ± {} (true {})",
                fixed(gain, 5),
                fixed(error, 5),
                fixed(1.0 / (1.0 + r.instruments.gyroscope_gain_error), 5)
            )
        });
        format!(
            "- {name}: step 2 has condition number {} and residual {} m/s² ({}); step 3 has condition number {} and residual {} m²/s² ({}){gain}",
            significant(i.scale_condition, 3),
            scientific(i.scale_residual_m_s2, 2),
            verdict(&i.scale_verdict),
            significant(i.inertia_condition, 3),
            scientific(i.inertia_residual_m2_s2, 2),
            verdict(&i.inertia_verdict),
        )
    };
    [
        line("noise-free", &r.noise_free),
        line("repeated", &r.noise_free_repeated),
        line("laboratory", &r.laboratory),
    ]
    .join("\n")
}
