//! Tables 4 to 6: decoupling of the compound runs before and after identification.

use anyhow::Result;
use sixaxis_page::number::{MISSING, fixed, percent, scientific, significant};
use sixaxis_page::{Cell, Section, Table, Text};
use sixaxis_props::evidence::Quantiles;
use sixaxis_props::results::{Laboratories, Published};
use sixaxis_reference::paper::{COMPOUND_TABLES, CompoundTable, GRAVITY_M_S2};

use super::{DEG_PER_RAD, met};
use crate::study::results::{
    Compound, Correction, FOUR_STEPS, Gravity, ParameterSet, REPEATED, Results, Standard, Way,
    substepped, worst,
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
    let published = Laboratories::embedded()?;
    let text = Text::new(include_str!("compound.md"))
        .value("runs", runs)
        .value("seed", r.seed)
        .value("rate_khz", rate_khz(r))
        .value("quick", r.quick)
        .value("seeds", published.identified.open_loop.truth.len())
        .value("first_seed", published.first_seed)
        .value("make", Laboratories::MAKE)
        .table("laboratories", laboratories(r, &published))
        .table("axis-level", axis_level(r));
    COMPOUND_TABLES
        .iter()
        .fold(text, |text, printed| {
            let id = format!("table-{}", printed.number);
            text.table(&id, table(r, printed))
        })
        .section("compound")
}

/// Sample rate of the laboratory's runs.
pub fn rate_khz(r: &Results) -> f64 {
    let first = r.compound_laboratory.first();
    first.map_or(f64::NAN, |run| run.sample_rate_hz / 1e3)
}

/// Linear in g, angular in deg/s².
fn in_paper_units(value: f64, axis: usize) -> String {
    match axis {
        0..3 => fixed(value / GRAVITY_M_S2, 3),
        _ => fixed(value * DEG_PER_RAD, 1),
    }
}

fn table(r: &Results, printed: &CompoundTable) -> Table {
    let place = |runs: &'_ [Compound]| runs.iter().position(|c| c.table == printed.number);
    let exact = place(&r.compound_noise_free).map(|i| &r.compound_noise_free[i]);
    let laboratory = place(&r.compound_laboratory).map(|i| &r.compound_laboratory[i]);
    let error =
        |run: Option<&Compound>, way: Way, axis: usize| Some(run?.comparison(way)?.error[axis]);
    let share = |e: f64| Cell::of(e, |e| significant(100.0 * e, 2));
    let small = |e: f64| Cell::of(e, |e| scientific(e, 1));
    let measured = |set, correction, axis: usize| {
        let way = substepped(set, correction, Standard::Instruments);
        Cell::or_dash(error(laboratory, way, axis).map(share))
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
        .under("laboratory, open loop")
        .col(("before", "%"), |&axis| {
            measured(ParameterSet::Design, Correction::OpenLoop, axis)
        })
        .col(("after", "%"), |&axis| {
            measured(ParameterSet::Identified, Correction::OpenLoop, axis)
        })
        .under("the same, corrected")
        .col(("before", "%"), |&axis| {
            measured(ParameterSet::Design, Correction::RestToRest, axis)
        })
        .col(("after", "%"), |&axis| {
            measured(ParameterSet::Identified, Correction::RestToRest, axis)
        })
        .under("noise-free: error")
        .col("four steps", |&axis| {
            Cell::or_dash(error(exact, FOUR_STEPS, axis).map(small))
        })
        .col("repeated", |&axis| {
            let error = error(exact, REPEATED, axis);
            Cell::or_dash(error.map(small)).state(met(error.is_some_and(|e| e <= 1e-5)))
        })
        .col("reference", |&axis| {
            Cell::or_dash(exact.map(|c| small(c.reference_error[axis])))
        })
        .into()
}

/// The largest of the 18 errors: in this laboratory, and in those of the published seeds.
fn laboratories(r: &Results, published: &Laboratories) -> Table {
    let sets = [
        ParameterSet::Design,
        ParameterSet::Identified,
        ParameterSet::True,
    ];
    let treatments = [Correction::OpenLoop, Correction::RestToRest];
    let ways = sets
        .into_iter()
        .flat_map(|set| treatments.map(|correction| (set, correction)))
        .zip(published.ways());
    let here = |(set, correction), standard| {
        let error = worst(
            &r.compound_laboratory,
            substepped(set, correction, standard),
        );
        Cell::of(error, |e| significant(100.0 * e, 2))
    };
    let seeds = |errors: &[f64], of: fn(&Quantiles) -> f64| {
        let value = Laboratories::quantiles(errors).map(|q| of(&q));
        Cell::or_dash(value.map(|e| Cell::of(e, |e| significant(100.0 * e, 2))))
    };
    Table::of("decoupled", ways, |(_, (name, _))| (*name).to_owned())
        .under("against the instruments")
        .col(("this seed", "%"), |(way, _)| {
            here(*way, Standard::Instruments)
        })
        .col(("median", "%"), |(_, (_, of))| {
            seeds(&of.instruments, |q| q.median)
        })
        .col(("worst", "%"), |(_, (_, of))| {
            seeds(&of.instruments, |q| q.max)
        })
        .under("against truth")
        .col(("this seed", "%"), |(way, _)| here(*way, Standard::Truth))
        .col(("median", "%"), |(_, (_, of))| {
            seeds(&of.truth, |q| q.median)
        })
        .col(("worst", "%"), |(_, (_, of))| seeds(&of.truth, |q| q.max))
        .into()
}

fn axis_level(r: &Results) -> Table {
    let largest = |errors: [f64; 6]| errors.into_iter().fold(0.0, f64::max);
    let kept = substepped(ParameterSet::True, Correction::OpenLoop, Standard::Truth);
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
