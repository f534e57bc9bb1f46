//! What the campaign determines of its parameters and what it leaves undetermined.

mod bias;
mod bound;
mod coverage;
mod iteration;
mod parameters;
mod propagation;
mod tap;
mod tolerance;

pub use tolerance::lost_at;

use anyhow::Result;
use sixaxis_page::{Section, Text};
use sixaxis_props::results::{Campaign, MujocoCampaign, Propagation, Published, Rooms, Taps};

use crate::study::results::Results;
use crate::study::results::identifiability::Records;

/// What step 4 is given, with the ends of anchors and the words for it.
const RECORDS: [(Records, &str, &str); 2] = [
    (Records::WholeRuns, "whole-runs", "whole runs"),
    (Records::EvenTurns, "even-turns", "turns at full speed"),
];

/// The section.
///
/// # Errors
/// If a published result cannot be read or the text does not fit the results.
pub fn section(results: &Results) -> Result<Section> {
    let study = &results.identifiability;
    let campaign = Campaign::embedded()?;
    let mut text = Text::new(include_str!("identifiability.md"));
    text = parameters::fill(text, &study.known, &campaign);
    text = coverage::fill(
        text,
        &campaign,
        &MujocoCampaign::embedded()?,
        &Rooms::embedded()?,
    );
    text = propagation::fill(text, &Propagation::embedded()?);
    text = tap::fill(text, &Taps::embedded()?, &study.known.tap);
    text = tolerance::fill(text, study);
    text = bound::fill(text, &study.bound);
    text = bias::fill(text, study);
    text = iteration::fill(text, study);
    text.section("identifiability")
}
