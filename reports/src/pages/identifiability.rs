//! What the campaign can and cannot say of its parameters. Here the parts are put in order; each says its own piece.

mod bias;
mod bound;
mod coverage;
mod iteration;
mod propagation;
mod published;
mod table;
mod tap;
#[cfg(test)]
mod tests;
mod tolerance;
mod verdict;

use crate::study::results::Results;
use sixaxis_page::{Block, Section};

/// The section.
pub fn section(results: &Results) -> Section {
    let study = &results.identifiability;
    let mut section = Section::new(
        "identifiability",
        "Identifiability: what the campaign knows of the 25",
        "First each parameter with both estimators' intervals, what no estimator could do better than, and whether the intervals \
         keep their word over a campaign of random sensors. Then why k/m stays open: how good the other parameters would have to \
         be, what any method could know, what the method's own neglect does, and whether repeating the steps helps.",
    );
    let campaign = published::campaign();
    section
        .blocks
        .extend(table::blocks(&study.known, campaign.as_ref().ok()));
    for published in [
        campaign.map(|c| coverage::blocks(&c)),
        published::propagation().map(|p| propagation::blocks(&p)),
    ] {
        section.blocks.extend(published.unwrap_or_else(unreadable));
    }
    section.blocks.push(Block::Heading("Stiffness".to_owned()));
    section.blocks.push(verdict::block(study));
    section.blocks.extend(
        published::taps().map_or_else(unreadable, |taps| tap::blocks(&taps, &study.known.tap)),
    );
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

fn unreadable(error: serde_json::Error) -> Vec<Block> {
    vec![Block::Note(format!(
        "A published result cannot be read: {error}."
    ))]
}
