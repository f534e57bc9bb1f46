//! What nine limbs say more than six: failures seen, named and survived. Here the parts are put in order.

mod amplification;
mod detection;
mod dying_limb;
mod map;
mod published;
mod sets;
#[cfg(test)]
mod tests;

use sixaxis_page::{Block, Section};

/// The section.
pub fn section() -> Section {
    let mut section = Section::new(
        "fault-tolerance",
        "Fault tolerance: limbs that fail",
        "Nine limbs say three things more than six accelerations ask for: three sums of limb forces are zero whatever the motion. \
         They stand in for limbs whose channels are lost; and what they leave says that a limb has failed and, in six classes, \
         which. The channel's own course says how, and at times which of two twins.",
    );
    for part in [
        sets::failed_limbs().map(|f| [map::blocks(&f), amplification::blocks(&f)].concat()),
        published::detection().map(|d| detection::blocks(&d)),
        published::dying_limb().map(|d| dying_limb::blocks(&d)),
    ] {
        section.blocks.extend(part.unwrap_or_else(unreadable));
    }
    section
}

fn unreadable(error: serde_json::Error) -> Vec<Block> {
    vec![Block::Note(format!(
        "A published result cannot be read: {error}."
    ))]
}
