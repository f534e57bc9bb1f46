//! Scale factors checked in the field without a standard: how well, what a motion leaves open, who drifted, how stiff.

mod drift;
mod motions;
mod published;
mod ratios;
mod stiffness;

use sixaxis_page::number::{count, percent};
use sixaxis_page::{Block, Section};

/// The section.
pub fn section() -> Section {
    let mut section = Section::new(
        "self-calibration",
        "Self-calibration: eight of nine scale ratios without a standard",
        "Equally stiff limbs obey three coordination equations in every motion. A recording of the sensor being tumbled tells \
         from them how the nine scale factors stand to each other, and so which limb has drifted since its calibration.",
    );
    match published::published() {
        Ok(p) => {
            section.blocks.push(Block::Text(format!(
                "Random sensors, tumbled by hand in closed form after a calibration whose scale factors are off by 0.5 % each, \
                 {} kHz, noise of a sample {} of its channel's peak, seeds from {}: {}. The accumulator takes a recording of any \
                 length in {} bytes. Against MuJoCo the ratios of 2 s are right to 5 × 10⁻⁸ without noise (test \
                 `ref_a_tumble_in_mujoco_tells_eight_ratios`).",
                p.sample_rate_hz / 1e3,
                percent(p.noise_over_peak, 2),
                count(p.first_seed),
                published::MAKE,
                count(p.accumulator_bytes),
            )));
            for part in [
                ratios::blocks(&p),
                motions::blocks(&p),
                drift::blocks(&p),
                stiffness::blocks(&p),
            ] {
                section.blocks.extend(part);
            }
        }
        Err(error) => section.blocks.push(Block::Note(format!(
            "A published result cannot be read: {error}."
        ))),
    }
    section
}
