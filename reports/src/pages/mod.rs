//! The report: a study's results as a page. What is measured is in [`crate::study`], how it is drawn in
//! [`sixaxis_page`]; here is decided what a reader meets, in which words and with how many digits.

pub mod evidence;
mod fault_tolerance;
mod figures;
mod identifiability;
mod ledger;
mod parameters;
mod self_calibration;
mod speed;
mod summary;
mod tables;

use crate::study::results::Results;
use sixaxis_page::{Page, Section};

pub use ledger::claims;

/// Lays out the report. `evidence` is the section about the test suites, which no study knows of; `facts` says how the
/// run came about: commit, machine, duration.
#[must_use]
pub fn report(results: &Results, evidence: Section, facts: Vec<(String, String)>) -> Page {
    let mut sections = vec![
        summary::bars(results),
        parameters::section(results),
        tables::section(results),
        figures::thresholds(results),
        figures::stiffness(results),
        identifiability::section(results),
        self_calibration::section(),
        fault_tolerance::section(),
        figures::histories(results),
        figures::orders(results),
        summary::reference(results),
        evidence,
        speed::section(),
        ledger::section(results),
    ];
    sections.retain(|section| !section.blocks.is_empty());
    Page {
        title: "Parallel six-axis accelerometer: calibration and decoupling against MuJoCo".to_owned(),
        subtitle: "Every table and figure of You, Li and Wu, *Parameter identification of parallel type \
                   six-axis accelerometer* (2013), beside what this project measures on simulated truth."
            .replace('*', ""),
        facts,
        tiles: summary::tiles(results),
        sections,
    }
}
