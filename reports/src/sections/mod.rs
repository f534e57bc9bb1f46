//! The report: a study's results as the sections of a page. What is measured is in [`crate::study`], how it is drawn in
//! [`sixaxis_page`]. Each section is a text file and a module beside it, which gives the text its values, figures and
//! tables.

mod acceptance;
mod blind;
mod budget;
mod compound;
pub mod evidence;
mod fault_tolerance;
mod histories;
mod hours;
mod identifiability;
mod ledger;
mod orders;
mod parameters;
mod reference;
mod self_calibration;
mod speed;
mod stiffness;
#[cfg(test)]
mod tests;
mod thresholds;

use core::f64::consts::PI;

use anyhow::Result;
use sixaxis_page::number::fixed;
use sixaxis_page::{Page, Section, State};

use crate::study::results::Results;

pub use ledger::claims;

/// Units of the paper in SI units.
const MM_PER_M: f64 = 1e3;
const DEG_PER_RAD: f64 = 180.0 / PI;
/// Unit in which k/m is printed, s^-2.
const STIFFNESS_UNIT_PER_S2: f64 = 1e8;

/// A k/m in that unit.
fn stiffness_text(per_s2: f64, decimals: usize) -> String {
    fixed(per_s2 / STIFFNESS_UNIT_PER_S2, decimals)
}

/// How a limit that is met or missed is marked.
fn met(met: bool) -> State {
    if met { State::Good } else { State::Bad }
}

/// Lays out the report. `evidence` is the section about the test suites, which no study knows of; `facts` says how the
/// run came about: commit, machine, duration.
///
/// # Errors
/// If a published result cannot be read, or if a section's text does not fit the results.
pub fn report(results: &Results, evidence: Section, facts: Vec<(String, String)>) -> Result<Page> {
    Ok(Page {
        title: "Parallel six-axis accelerometer: calibration and decoupling against MuJoCo".to_owned(),
        subtitle: "Tables 1 to 6 and Figs. 7 and 10 of You, Li and Wu, Parameter identification of parallel type \
                   six-axis accelerometer (2013), beside what this project measures on simulated truth."
            .to_owned(),
        facts,
        tiles: acceptance::tiles(results)?,
        sections: vec![
            acceptance::section(results)?,
            parameters::section(results)?,
            compound::section(results)?,
            budget::section()?,
            thresholds::section(results)?,
            stiffness::section(results)?,
            identifiability::section(results)?,
            self_calibration::section()?,
            fault_tolerance::section()?,
            blind::section()?,
            histories::section(results)?,
            hours::section()?,
            orders::section(results)?,
            reference::section(results)?,
            evidence,
            speed::section()?,
            ledger::section(results)?,
        ],
    })
}
