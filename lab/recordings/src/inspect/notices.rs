//! What a person should know about a recording, each fact in one sentence with its numbers.

mod jumps;
mod limbs;

use super::facts::{ChannelFacts, Fact, FlatTop, Group, Inspection, RateOrigin, Severity, Twins};
use super::listing::{brief, plural, seconds, with_unit};
use super::sensor::Expected;
use crate::ingest::clock::{CLOSEST_S, Stamps};
use crate::runs::stands_still;

/// Standard deviations, and steps of a converter, from the mean from which on a sample at rest is a wild one.
const WILD: f64 = 10.0;
const WILD_STEPS: f64 = 4.0;
/// Jitter beyond this share of a step is noticed.
const JITTER: f64 = 0.01;
/// Difference of two statements of one rate that is noticed.
const RATE: f64 = 1e-4;
/// Channels of which one kind of fact names each by itself.
const EACH: usize = 3;
/// Channel names in a sentence.
const NAMED: usize = 12;

/// All facts about a recording.
pub fn of(inspection: &Inspection, expected: Option<&Expected>) -> Vec<Fact> {
    let mut facts = Facts(Vec::new());
    if let Some(cut) = &inspection.cut {
        facts.notice("cut", None, cut.clone());
    }
    for refused in &inspection.unreadable {
        let text = format!("{} cannot be read: {}", refused.channel, refused.cause);
        facts.notice("unreadable", [&refused.channel], text);
    }
    for group in &inspection.groups {
        if let Some(stamps) = &group.time_stamps {
            facts.of_stamps(stamps, group);
        }
        facts.of_jumps(group, inspection.sensor.as_ref());
        if group.samples > 0 {
            facts.of_channels(&group.channels, expected);
        } else if !group.channels.is_empty() {
            let names: Vec<&String> = group.channels.iter().map(|c| &c.name).collect();
            let text = format!("no samples in {}", list(&names));
            facts.notice("empty", names, text);
        }
    }
    inspection
        .twins
        .iter()
        .for_each(|pair| facts.of_twins(pair));
    facts.of_rate_and_units(inspection);
    facts.of_sensor(inspection, expected);
    facts.0
}

struct Facts(Vec<Fact>);

impl Facts {
    /// Adds a fact once: channels that are read in several passes share their time stamps.
    fn add(&mut self, fact: Fact) {
        if !self.0.contains(&fact) {
            self.0.push(fact);
        }
    }

    fn notice<'a>(
        &mut self,
        kind: &'static str,
        channels: impl IntoIterator<Item = &'a String>,
        text: String,
    ) {
        self.add(Fact {
            kind,
            channels: channels.into_iter().cloned().collect(),
            text,
            severity: Severity::Noticed,
        });
    }

    fn remark(&mut self, text: impl Into<String>) {
        self.add(Fact {
            kind: "remark",
            channels: Vec::new(),
            text: text.into(),
            severity: Severity::Remark,
        });
    }

    /// Names up to [`EACH`] channels each with a sentence of its own, more of them in one.
    fn each(
        &mut self,
        kind: &'static str,
        channels: &[&ChannelFacts],
        one: impl Fn(&ChannelFacts) -> String,
        all: &str,
    ) {
        if channels.len() > EACH {
            let names: Vec<&String> = channels.iter().map(|c| &c.name).collect();
            let text = format!("{} {all}", list(&names));
            return self.notice(kind, names, text);
        }
        for channel in channels {
            self.notice(kind, [&channel.name], one(channel));
        }
    }

    fn of_stamps(&mut self, stamps: &Stamps, group: &Group) {
        let time = [&stamps.channel];
        if stamps.not_finite > 0 {
            let text = format!("{} time stamps are not finite", stamps.not_finite);
            self.notice("not_finite", time, text);
        }
        if let Some(sample) = stamps.first_not_advancing {
            let places = plural(stamps.not_advancing, "place");
            let text = format!("time stamps do not advance at {places}, first at sample {sample}");
            self.notice("not_advancing", time, text);
        }
        if let Some(gap) = stamps.first_gaps.first() {
            let longest = stamps.first_gaps.iter().map(|g| g.length_s);
            let more = if stamps.gaps > 1 {
                format!(
                    "; {} gaps in all, {} samples missing, the longest of those listed {}",
                    stamps.gaps,
                    stamps.missing,
                    seconds(longest.fold(0.0, f64::max))
                )
            } else {
                String::new()
            };
            let text = format!(
                "gap before sample {}{}: {} from time {} on, {} samples missing{more}",
                gap.sample,
                gap.line
                    .map_or_else(String::new, |line| format!(" (line {line})")),
                seconds(gap.length_s),
                seconds(gap.time_s),
                gap.missing,
            );
            self.notice("gap", time, text);
            self.remark(
                "spectra and noise floors take the samples on either side of a gap for neighbours",
            );
        }
        if let Some(step) = stamps.mean_step_s.filter(|step| *step < CLOSEST_S) {
            let text = format!(
                "time stamps are {step:.1e} s apart, as those in days or hours without a unit in the heading"
            );
            self.notice("rate", time, text);
        }
        if let Some((rms, step)) = stamps.jitter_rms_s.zip(stamps.mean_step_s)
            && rms > JITTER * step
        {
            let text = format!(
                "time stamps jitter by {} rms, {} at most, about steps of {}",
                seconds(rms),
                seconds(stamps.jitter_max_s.unwrap_or(f64::NAN)),
                seconds(step)
            );
            self.notice("jitter", time, text);
        }
        if let Some((counted, stated)) = stamps.mean_rate_hz.zip(group.sample_rate_hz)
            && group.sample_rate_origin != RateOrigin::TimeStamps
            && (counted / stated - 1.0).abs() > RATE
        {
            let text = format!(
                "time stamps tell of {} Hz, {} Hz {}",
                brief(counted, 6),
                brief(stated, 6),
                group.sample_rate_origin.words()
            );
            self.notice("rate", time, text);
        }
    }

    fn of_channels(&mut self, channels: &[ChannelFacts], expected: Option<&Expected>) {
        for channel in channels {
            self.of_not_finite(channel);
        }
        // A single sample is no constant channel.
        let constant = channels.iter().filter(|c| c.constant && c.finite() > 1);
        let (excused, constant): (Vec<_>, Vec<_>) =
            constant.partition(|c| expected.is_some_and(|e| e.may_be_still(&c.name)));
        for channel in excused {
            self.remark(format!(
                "{} reads one value throughout; this recording's motion does not reach it",
                channel.name
            ));
        }
        let text = |c: &ChannelFacts| format!("{} reads {} throughout", c.name, c.in_unit(c.mean));
        self.each(
            "constant",
            &constant,
            text,
            "read one value each throughout",
        );
        let runs: Vec<_> = channels.iter().map(|c| c.runs).collect();
        for (at, channel) in channels.iter().enumerate() {
            if let Some(run) = stands_still(&runs, at) {
                let text = format!(
                    "{} stands still to the last bit for {} samples from sample {} on, while other channels move",
                    channel.name, run.samples, run.first
                );
                self.notice("still", [&channel.name], text);
            }
        }
        for channel in channels {
            self.of_clipping(channel);
            self.of_wild_samples(channel);
        }
        let drifting: Vec<_> = channels.iter().filter(|c| c.drift_stands_out).collect();
        let text = |c: &ChannelFacts| {
            format!(
                "{} drifts: the mean of its last tenth is {} from that of its first",
                c.name,
                c.in_unit(c.drift)
            )
        };
        let all = "do not end where they began: see the column of drifts";
        self.each("drift", &drifting, text, all);
        for nominal_hz in [50.0, 60.0] {
            self.of_mains(channels, nominal_hz);
        }
    }

    fn of_not_finite(&mut self, channel: &ChannelFacts) {
        let Some(first) = channel.first_not_finite else {
            return;
        };
        let counts = [
            (channel.not_a_number, "not a number"),
            (channel.infinite, "infinite"),
        ];
        let parts: Vec<String> = counts
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(n, what)| format!("{n} of {} samples are {what}", channel.samples))
            .collect();
        let text = if channel.finite() == 0 {
            format!("{}: no sample is a finite number", channel.name)
        } else {
            let parts = parts.join(", ");
            format!("{}: {parts}, first at sample {first}", channel.name)
        };
        self.notice("not_finite", [&channel.name], text);
    }

    fn of_clipping(&mut self, channel: &ChannelFacts) {
        let name = &channel.name;
        if let Some(count) = channel.at_full_scale.filter(|count| *count > 0) {
            let text = format!(
                "{name} clips: {count} of {} samples stand at the full scale that the session states, or beyond",
                channel.samples
            );
            return self.notice("clipped", [name], text);
        }
        for (end, top) in [
            ("smallest", &channel.flat_bottom),
            ("largest", &channel.flat_top),
        ] {
            if let Some(top) = top {
                self.notice("clipped", [name], flat(channel, end, top));
            }
        }
    }

    /// Samples far outside the noise of a channel at rest, as long as they are few: many widen the deviation that they are held against. A single
    /// step of the converter is none.
    fn of_wild_samples(&mut self, channel: &ChannelFacts) {
        let ends = [
            channel.minimum,
            channel.maximum,
            channel.mean,
            channel.standard_deviation,
        ];
        let [Some(minimum), Some(maximum), Some(mean), Some(deviation)] = ends else {
            return;
        };
        let furthest = (maximum - mean).max(mean - minimum);
        let least = (WILD * deviation).max(WILD_STEPS * channel.smallest_step.unwrap_or(0.0));
        if channel.stability.is_some() && furthest > least {
            let text = format!(
                "{} has a wild sample or more: one is {} from the mean, {:.0} standard deviations; they count in its noise",
                channel.name,
                channel.in_unit(Some(furthest)),
                furthest / deviation
            );
            self.notice("wild", [&channel.name], text);
        }
    }

    /// The fundamental of each; its harmonics are in the numbers.
    fn of_mains(&mut self, channels: &[ChannelFacts], nominal_hz: f64) {
        let amplitude = |c: &ChannelFacts| {
            let mut lines = c.mains.iter();
            let line = lines.find(|l| (l.frequency - nominal_hz).abs() < 2.0)?;
            Some(line.amplitude)
        };
        let humming: Vec<(&ChannelFacts, f64)> = channels
            .iter()
            .filter_map(|c| Some((c, amplitude(c)?)))
            .collect();
        // The first of equal ones.
        let by_amplitude = humming.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((loudest, amplitude)) = by_amplitude else {
            return;
        };
        let largest = loudest.in_unit(Some(*amplitude));
        let names: Vec<&String> = humming.iter().map(|(c, _)| &c.name).collect();
        let which = match names.as_slice() {
            [_] => String::new(),
            _ => format!("; largest on {}", loudest.name),
        };
        let text = format!(
            "mains hum of {nominal_hz} Hz on {}{which}, amplitude {largest}",
            list(&names)
        );
        self.notice("mains", names, text);
    }

    fn of_twins(&mut self, pair: &Twins) {
        let [a, b] = &pair.channels;
        let text = match (pair.exact, pair.opposite) {
            (true, false) => format!("{b} is the same as {a}, sample by sample"),
            (true, true) => format!("{b} is {a} with its sign turned, sample by sample"),
            (false, false) => {
                format!("{b} and {a} agree down to their noise: one signal on two channels")
            }
            (false, true) => format!(
                "{b} is {a} with its sign turned, down to the noise: one signal on two channels"
            ),
        };
        let kind = if pair.opposite {
            "opposite"
        } else {
            "identical"
        };
        self.notice(kind, [a, b], text);
    }

    fn of_rate_and_units(&mut self, inspection: &Inspection) {
        let mut groups = inspection.groups.iter();
        if groups.any(|g| g.sample_rate_hz.is_none() && g.samples > 1) {
            self.remark(
                "nothing tells the sample rate: frequencies are in cycles per sample, and mains hum is not looked for",
            );
        }
        let mut unknown: Vec<&String> = inspection
            .groups
            .iter()
            .flat_map(|g| &g.channels)
            .filter_map(|c| c.unit.as_ref())
            .filter(|u| u.measures.is_none())
            .map(|u| &u.name)
            .collect();
        unknown.sort();
        unknown.dedup();
        if !unknown.is_empty() {
            self.remark(format!(
                "units that `calibrate` and `decouple` do not understand: {}",
                list(&unknown)
            ));
        }
    }
}

impl ChannelFacts {
    /// A number in the channel's unit.
    fn in_unit(&self, value: Option<f64>) -> String {
        with_unit(value.unwrap_or(f64::NAN), self.unit_name())
    }
}

fn flat(channel: &ChannelFacts, end: &str, top: &FlatTop) -> String {
    let ending = if top.at_round_limit {
        ", a converter's limit by the look of it"
    } else if top.value == 0.0 {
        ": clipped, or a signal that rests at zero"
    } else {
        ""
    };
    format!(
        "{} is flat at its {end} value, {}, in {} samples, up to {} in a row, first at sample {}{ending}",
        channel.name,
        channel.in_unit(Some(top.value)),
        top.samples,
        top.longest_run,
        top.first_sample
    )
}

/// Names, the first [`NAMED`] of them.
fn list(names: &[impl AsRef<str>]) -> String {
    let shown: Vec<&str> = names.iter().take(NAMED).map(AsRef::as_ref).collect();
    let more = match names.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    shown.join(", ") + &more
}
