//! What the nine channels show of the limb forces: sensitivities and cross-talk.

use crate::geometry::LIMBS;
use crate::sensor::TrueSensor;

/// What the channels show at an hour of the day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channels {
    /// Sensitivity over that of the truth.
    pub sensitivity: [f64; LIMBS],
    /// Share of the next limb's force, and of the first one's in the last channel.
    pub of_next: [f64; LIMBS],
}

impl Channels {
    /// What they show of limb forces beyond those at rest, with each channel's share of the next one's charge.
    pub(super) fn shown(
        &self,
        force: &[f64; LIMBS],
        rest: &[f64; LIMBS],
        sensor: &TrueSensor,
    ) -> [f64; LIMBS] {
        let scale = &sensor.scale_per_mass_per_kg;
        let change = |i: usize| self.sensitivity[i] * (force[i] - rest[i]);
        core::array::from_fn(|i| {
            let next = (i + 1) % LIMBS;
            change(i) + self.of_next[i] * change(next) * scale[i] / scale[next]
        })
    }
}
