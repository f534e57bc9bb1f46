//! Which limb has drifted.

use super::published::Published;
use sixaxis_page::Block;
use sixaxis_page::number::{count, fixed};

/// Text.
pub fn blocks(p: &Published) -> Vec<Block> {
    let d = &p.drift;
    let none = p.lengths.iter().max_by_key(|l| l.draws);
    let mut blocks = vec![
        Block::Heading("Who has drifted?".to_owned()),
        Block::Text(format!(
            "The smallest set of limbs whose change explains the record, at most four; the others are taken to have kept their scale. \
             With limb {} off by {} % it is named, alone and without a rival, in {} % of {} records of {} s, its change right to \
             {} % rms; 95 % intervals hold it in {} %.",
            d.limb,
            100.0 * d.change,
            fixed(100.0 * d.named_alone, 1),
            count(d.draws),
            d.duration_s,
            fixed(100.0 * d.rms_error, 4),
            fixed(100.0 * d.coverage_95, 1),
        )),
    ];
    if let Some(none) = none {
        blocks.push(Block::Text(format!(
            "Where no limb has drifted, one is said to have in {} % of {} records at a stated rate of {} %, and in {} % at {} %.",
            fixed(100.0 * none.named_without_drift[0], 2),
            count(none.draws - none.refused),
            100.0 * p.rates[0],
            fixed(100.0 * none.named_without_drift[1], 2),
            100.0 * p.rates[1],
        )));
    }
    blocks
}
