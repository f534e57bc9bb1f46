//! What nine limbs say more than six: failures detected, isolated and survived.

mod detection;
mod dying_limb;
mod excluded;
mod watched;

use anyhow::Result;
use sixaxis_page::{Section, Text};
use sixaxis_props::results::{Detection, DyingLimb, FailedLimbs, Published, WatchedLaboratories};

/// The section.
///
/// # Errors
/// If a published result cannot be read or the text does not fit it.
pub fn section() -> Result<Section> {
    let mut text = Text::new(include_str!("fault_tolerance.md"));
    text = excluded::fill(text, &FailedLimbs::embedded()?);
    text = detection::fill(text, &Detection::embedded()?);
    text = watched::fill(text, &WatchedLaboratories::embedded()?);
    text = dying_limb::fill(text, &DyingLimb::embedded()?);
    text.section("fault-tolerance")
}
