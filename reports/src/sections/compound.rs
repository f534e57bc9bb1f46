//! Tables 4 to 6: decoupling of the compound runs before and after identification.

use anyhow::Result;
use sixaxis_core::Scheme;
use sixaxis_page::number::{MISSING, fixed, percent, scientific, significant};
use sixaxis_page::{Cell, Section, Table, Text};
use sixaxis_reference::paper::{COMPOUND_TABLES, CompoundTable, GRAVITY_M_S2};

use super::{DEG_PER_RAD, met};
use crate::study::results::{
    Compound, DESIGN, FOUR_STEPS, Gravity, MEASURED, ParameterSet, REPEATED, Results, Standard,
    Way, worst,
};

const NAMES: [&str; 6] = [
    "$a$_{x},\u{a0}g",
    "$a$_{y},\u{a0}g",
    "$a$_{z},\u{a0}g",
    "$α$_{x},\u{a0}°/s²",
    "$α$_{y},\u{a0}°/s²",
    "$α$_{z},\u{a0}°/s²",
];

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let runs = COMPOUND_TABLES.map(|t| {
        let d = t.direction;
        format!(
            "{} Hz, direction ({}, {}, {})/√6",
            t.frequency_hz, d.x, d.y, d.z
        )
    });
    let text = Text::new(include_str!("compound.md"))
        .value("runs", runs)
        .table("axis-level", axis_level(r));
    COMPOUND_TABLES
        .iter()
        .fold(text, |text, printed| {
            let id = format!("table-{}", printed.number);
            text.table(&id, table(r, printed))
        })
        .section("compound")
}

/// Linear in g, angular in deg/s².
fn in_paper_units(value: f64, axis: usize) -> String {
    match axis {
        0..3 => fixed(value / GRAVITY_M_S2, 3),
        _ => fixed(value * DEG_PER_RAD, 1),
    }
}

fn table(r: &Results, printed: &CompoundTable) -> Table {
    let of = |runs: &'_ [Compound]| runs.iter().position(|c| c.table == printed.number);
    let exact = of(&r.compound_noise_free).map(|i| &r.compound_noise_free[i]);
    let laboratory = of(&r.compound_laboratory).map(|i| &r.compound_laboratory[i]);
    let error =
        |run: Option<&Compound>, way: Way, axis: usize| Some(run?.comparison(way)?.error[axis]);
    let share = |e: f64| Cell::of(e, |e| significant(100.0 * e, 2));
    let small = |e: f64| Cell::of(e, |e| scientific(e, 1));
    let judged = |e: Option<f64>, limit: f64, cell: &dyn Fn(f64) -> Cell| {
        Cell::or_dash(e.map(cell)).state(met(e.is_some_and(|e| e <= limit)))
    };
    Table::of("axis", 0..6, |axis| NAMES[*axis].to_owned())
        .under("target")
        .col("paper", |&axis| fixed(printed.target[axis], 2))
        .col("here", |&axis| {
            exact.map_or(MISSING.to_owned(), |c| {
                in_paper_units(c.amplitude[axis], axis)
            })
        })
        .under("paper: error")
        .col(("before", "%"), |&axis| {
            fixed(printed.error_before_percent[axis], 3)
        })
        .col(("after", "%"), |&axis| {
            fixed(printed.error_after_percent[axis], 3)
        })
        .under("laboratory: error")
        .col(("before", "%"), |&axis| {
            Cell::or_dash(error(laboratory, DESIGN, axis).map(share))
        })
        .col(("after", "%"), |&axis| {
            judged(error(laboratory, MEASURED, axis), 0.01, &share)
        })
        .col(("against truth", "%"), |&axis| {
            judged(error(laboratory, FOUR_STEPS, axis), 0.013, &share)
        })
        .under("noise-free: error")
        .col("four steps", |&axis| {
            judged(error(exact, FOUR_STEPS, axis), 1e-5, &small)
        })
        .col("repeated", |&axis| {
            judged(error(exact, REPEATED, axis), 1e-5, &small)
        })
        .col("reference", |&axis| {
            Cell::or_dash(exact.map(|c| small(c.reference_error[axis])))
        })
        .into()
}

fn axis_level(r: &Results) -> Table {
    let largest = |errors: [f64; 6]| errors.into_iter().fold(0.0, f64::max);
    let kept = (ParameterSet::True, Scheme::HeunSubstepped, Standard::Truth);
    let neglected = |run: &Compound| {
        let mut all = run.comparisons.iter();
        let found = all.find(|c| {
            (c.parameters, c.gravity, c.against)
                == (ParameterSet::True, Gravity::Neglected, Standard::Truth)
        });
        found.map_or(f64::NAN, |c| largest(c.error))
    };
    Table::of("run", &r.compound_axis_level, |run| {
        format!("{} Hz", run.frequency_hz)
    })
    .col("gravity reckoned with", |run| {
        scientific(worst(core::slice::from_ref(*run), kept), 1)
    })
    .col("reference", |run| {
        scientific(largest(run.reference_error), 1)
    })
    .col("gravity neglected, as in the paper", |run| {
        percent(neglected(run), 2)
    })
    .into()
}
