//! What nine limbs say more than six: failures detected, isolated and survived.

mod detection;
mod dying_limb;
mod excluded;
mod published;
mod sets;
#[cfg(test)]
mod tests;

use anyhow::Result;
use sixaxis_page::{Section, Text};

/// The section.
///
/// # Errors
/// If a published result cannot be read or the text does not fit it.
pub fn section() -> Result<Section> {
    let mut text = Text::new(include_str!("fault_tolerance.md"));
    text = excluded::fill(text, &sets::failed_limbs()?);
    text = detection::fill(text, &published::detection()?);
    text = dying_limb::fill(text, &published::dying_limb()?);
    text.section("fault-tolerance")
}
