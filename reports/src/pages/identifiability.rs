//! What the campaign can and cannot say of its parameters. Here the parts are put in order; each says its own piece.

mod bias;
mod bound;
mod iteration;
mod tolerance;
mod verdict;

use crate::study::results::Results;
use crate::view::Section;

/// The section.
pub fn section(results: &Results) -> Section {
    let study = &results.identifiability;
    let mut section = Section::new(
        "identifiability",
        "Identifiability: why step 4 leaves k/m open",
        "k/m shows itself only in how far the mass moves in the shell, and at 5 Hz that is a few millionths of what the \
         channels read. Four questions: how good the other parameters would have to be, what any method could know, what the \
         method's own neglect does, and whether repeating the steps helps.",
    );
    section.blocks.push(verdict::block(study));
    for part in [
        tolerance::blocks(study),
        bound::blocks(&study.bound),
        bias::blocks(study),
        iteration::blocks(study),
    ] {
        section.blocks.extend(part);
    }
    section
}
