//! Jumps in sentences: what one limb does alone, and what several do at once.

use std::collections::BTreeMap;

use super::Facts;
use crate::inspect::facts::{ChannelFacts, Group, Sensor};
use crate::inspect::jumps::{self, Jump};
use crate::inspect::listing::{plural, with_unit};

/// Samples within which channels jump at once: a blow reaches one after the other.
const AT_ONCE: u64 = 256;
impl Facts {
    /// A blow reaches the limbs of an axis, three of them: what one limb shows alone is the channel's.
    pub(super) fn of_jumps(&mut self, group: &Group, sensor: Option<&Sensor>) {
        let is_limb = |name: &String| sensor.is_some_and(|sensor| sensor.limbs.contains(name));
        let all: Vec<&ChannelFacts> = group.channels.iter().filter(|c| is_limb(&c.name)).collect();
        // Behind the last that was kept nobody knows who jumps along.
        let full = all
            .iter()
            .filter(|channel| channel.jumps.len() == jumps::KEPT);
        let known = full.filter_map(|channel| Some(channel.jumps.last()?.sample));
        let known = known.min().unwrap_or(u64::MAX);
        let mut all: Vec<(&Jump, &ChannelFacts)> = all
            .into_iter()
            .flat_map(|channel| channel.jumps.iter().map(move |jump| (jump, channel)))
            .filter(|(jump, _)| jump.sample <= known)
            .collect();
        all.sort_by_key(|(jump, _)| jump.sample);
        let more = |places: usize| match places {
            0 | 1 => String::new(),
            more => format!(", and at {}", plural(more as u64 - 1, "other place")),
        };
        let mut several: Vec<u64> = Vec::new();
        let mut alone: BTreeMap<&String, Vec<(&Jump, &ChannelFacts)>> = BTreeMap::new();
        for at_once in all.chunk_by(|(a, _), (b, _)| b.sample - a.sample <= AT_ONCE) {
            let (first, channel) = at_once[0];
            if at_once.iter().any(|(_, other)| other.name != channel.name) {
                several.push(first.sample);
            } else {
                alone.entry(&channel.name).or_default().extend(at_once);
            }
        }
        for (name, jumps) in alone {
            let (Jump { sample, by }, channel) = jumps[0];
            let text = format!(
                "{name} jumps by {} before sample {sample}, alone{}: a spike or a step that no motion makes",
                with_unit(*by, channel.unit_name()),
                more(jumps.len())
            );
            self.notice("jump", [name], text);
        }
        let has_gaps = group
            .time_stamps
            .as_ref()
            .is_some_and(|stamps| stamps.gaps > 0);
        if let Some(sample) = several.first().filter(|_| !has_gaps) {
            self.remark(format!(
                "several limbs jump at once before sample {sample}{}: samples may be missing there, or something was struck",
                more(several.len())
            ));
        }
    }
}
