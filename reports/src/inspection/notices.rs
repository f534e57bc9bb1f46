//! What is noticed, in sentences with their numbers.

use super::findings::{ChannelFacts, FlatTop, Group, Inspection, Notice, RateOrigin};
use super::listing::{brief, seconds, with_unit};
use super::sensor::Expected;

/// Jitter beyond this share of a step is noticed.
const JITTER: f64 = 0.01;
/// Difference of two statements of one rate that is noticed.
const RATE: f64 = 1e-4;
/// Channels of which one kind of notice names each by itself.
const EACH: usize = 3;
/// Channel names in a sentence.
const NAMED: usize = 12;

/// Fills in what is noticed and what else is to be known.
pub fn add(inspection: &mut Inspection, expected: Option<&Expected>) {
    let mut notices = Vec::new();
    let mut remarks = Vec::new();
    for refused in &inspection.unreadable {
        notices.push(Notice {
            kind: "unreadable",
            channels: vec![refused.channel.clone()],
            text: format!("{} cannot be read: {}", refused.channel, refused.cause),
        });
    }
    for group in &inspection.groups {
        of_stamps(group, &mut notices, &mut remarks);
        of_channels(group, expected, &mut notices, &mut remarks);
    }
    of_twins(inspection, &mut notices);
    of_rate(inspection, &mut remarks);
    of_units(inspection, &mut remarks);
    of_sensor(inspection, expected, &mut remarks);
    // Channels read in several passes share their time stamps.
    for notice in notices {
        if !inspection.noticed.contains(&notice) {
            inspection.noticed.push(notice);
        }
    }
    for remark in remarks {
        if !inspection.remarks.contains(&remark) {
            inspection.remarks.push(remark);
        }
    }
}

fn notice(kind: &'static str, channel: &ChannelFacts, text: String) -> Notice {
    Notice {
        kind,
        channels: vec![channel.name.clone()],
        text,
    }
}

fn of_stamps(group: &Group, notices: &mut Vec<Notice>, remarks: &mut Vec<String>) {
    let Some(stamps) = &group.time_stamps else {
        return;
    };
    let mut add = |kind, text| {
        notices.push(Notice {
            kind,
            channels: vec![stamps.channel.clone()],
            text,
        });
    };
    if stamps.not_finite > 0 {
        add(
            "not_finite",
            format!("{} time stamps are not finite", stamps.not_finite),
        );
    }
    if let Some(sample) = stamps.first_not_advancing {
        add(
            "not_advancing",
            format!(
                "time stamps do not advance at {} {}, first at sample {sample}",
                stamps.not_advancing,
                if stamps.not_advancing == 1 {
                    "place"
                } else {
                    "places"
                },
            ),
        );
    }
    if let Some(gap) = stamps.first_gaps.first() {
        let longest = stamps
            .first_gaps
            .iter()
            .map(|g| g.length_s)
            .fold(0.0, f64::max);
        let more = if stamps.gaps > 1 {
            format!(
                "; {} gaps in all, {} samples missing, the longest of those listed {}",
                stamps.gaps,
                stamps.missing,
                seconds(longest)
            )
        } else {
            String::new()
        };
        add(
            "gap",
            format!(
                "gap before sample {}: {} from time {} on, {} samples missing{more}",
                gap.sample,
                seconds(gap.length_s),
                seconds(gap.time_s),
                gap.missing,
            ),
        );
        remarks.push(
            "spectra and noise floors take the samples on either side of a gap for neighbours"
                .to_owned(),
        );
    }
    if let Some((rms, step)) = stamps.jitter_rms_s.zip(stamps.mean_step_s)
        && rms > JITTER * step
    {
        add(
            "jitter",
            format!(
                "time stamps jitter by {} rms, {} at most, about steps of {}",
                seconds(rms),
                seconds(stamps.jitter_max_s.unwrap_or(f64::NAN)),
                seconds(step)
            ),
        );
    }
    let told = stamps.mean_step_s.map(|step| 1.0 / step);
    if let Some((told, stated)) = told.zip(group.sample_rate_hz)
        && group.sample_rate_origin != RateOrigin::TimeStamps
        && (told / stated - 1.0).abs() > RATE
    {
        add(
            "rate",
            format!(
                "time stamps tell of {} Hz, {} Hz {}",
                brief(told, 6),
                brief(stated, 6),
                group.sample_rate_origin.words()
            ),
        );
    }
}

fn of_channels(
    group: &Group,
    expected: Option<&Expected>,
    notices: &mut Vec<Notice>,
    remarks: &mut Vec<String>,
) {
    let channels = &group.channels;
    if group.samples == 0 {
        let names: Vec<String> = channels.iter().map(|c| c.name.clone()).collect();
        if !names.is_empty() {
            notices.push(Notice {
                kind: "empty",
                text: format!("no samples in {}", list(&names)),
                channels: names,
            });
        }
        return;
    }
    for channel in channels {
        not_finite(channel, notices);
    }
    let some = |kind, which: &dyn Fn(&ChannelFacts) -> bool, verb: &str| {
        let names: Vec<String> = channels
            .iter()
            .filter(|c| which(c))
            .map(|c| c.name.clone())
            .collect();
        (names.len() > EACH).then(|| Notice {
            kind,
            text: format!("{} {verb}", list(&names)),
            channels: names,
        })
    };
    // A single sample is no constant channel.
    let still = |c: &ChannelFacts| c.constant && c.finite() > 1;
    let excused = |c: &ChannelFacts| expected.is_some_and(|e| e.may_be_still(&c.name));
    let constant = |c: &ChannelFacts| still(c) && !excused(c);
    for channel in channels.iter().filter(|c| still(c) && excused(c)) {
        remarks.push(format!(
            "{} reads one value throughout; this recording's motion does not reach it",
            channel.name
        ));
    }
    match some("constant", &constant, "read one value each throughout") {
        Some(all) => notices.push(all),
        None => {
            for channel in channels.iter().filter(|c| constant(c)) {
                notices.push(notice(
                    "constant",
                    channel,
                    format!(
                        "{} reads {} throughout",
                        channel.name,
                        with_unit(channel.mean.unwrap_or(f64::NAN), channel.unit_name())
                    ),
                ));
            }
        }
    }
    for channel in channels {
        clipped(channel, notices);
    }
    let drifts = |c: &ChannelFacts| c.drift_stands_out;
    match some(
        "drift",
        &drifts,
        "do not end where they began: see the column of drifts",
    ) {
        Some(all) => notices.push(all),
        None => {
            for channel in channels.iter().filter(|c| drifts(c)) {
                notices.push(notice(
                    "drift",
                    channel,
                    format!(
                        "{} drifts: the mean of its last tenth is {} from that of its first",
                        channel.name,
                        with_unit(channel.drift.unwrap_or(f64::NAN), channel.unit_name())
                    ),
                ));
            }
        }
    }
    mains(channels, notices);
}

fn not_finite(channel: &ChannelFacts, notices: &mut Vec<Notice>) {
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
        format!(
            "{}: {}, first at sample {first}",
            channel.name,
            parts.join(", ")
        )
    };
    notices.push(notice("not_finite", channel, text));
}

fn clipped(channel: &ChannelFacts, notices: &mut Vec<Notice>) {
    if let Some(count) = channel.at_full_scale.filter(|count| *count > 0) {
        notices.push(notice(
            "clipped",
            channel,
            format!(
                "{} clips: {count} of {} samples stand at the full scale that the session states, or beyond",
                channel.name, channel.samples
            ),
        ));
        return;
    }
    for (end, top) in [
        ("smallest", &channel.flat_bottom),
        ("largest", &channel.flat_top),
    ] {
        if let Some(top) = top {
            notices.push(notice("clipped", channel, flat(channel, end, top)));
        }
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
        with_unit(top.value, channel.unit_name()),
        top.samples,
        top.longest_run,
        top.first_sample
    )
}

fn mains(channels: &[ChannelFacts], notices: &mut Vec<Notice>) {
    for nominal in [50.0, 60.0] {
        // The fundamental of each; its harmonics are in the numbers.
        let mut humming: Vec<(&ChannelFacts, f64)> = channels
            .iter()
            .filter_map(|c| {
                let line = c
                    .mains
                    .iter()
                    .find(|l| (l.frequency - nominal).abs() < 2.0)?;
                Some((c, line.amplitude))
            })
            .collect();
        humming.sort_by(|a, b| b.1.total_cmp(&a.1));
        let Some((loudest, amplitude)) = humming.first() else {
            continue;
        };
        let largest = with_unit(*amplitude, loudest.unit_name());
        let names: Vec<String> = channels
            .iter()
            .filter(|c| humming.iter().any(|h| std::ptr::eq(h.0, *c)))
            .map(|c| c.name.clone())
            .collect();
        let text = if names.len() == 1 {
            format!(
                "mains hum of {nominal} Hz on {}, amplitude {largest}",
                names[0]
            )
        } else {
            format!(
                "mains hum of {nominal} Hz on {}; largest on {}, amplitude {largest}",
                list(&names),
                loudest.name
            )
        };
        notices.push(Notice {
            kind: "mains",
            channels: names,
            text,
        });
    }
}

fn of_twins(inspection: &Inspection, notices: &mut Vec<Notice>) {
    for pair in &inspection.twins {
        let [a, b] = &pair.channels;
        let text = match (pair.exact, pair.opposite) {
            (true, false) => format!("{b} is the same as {a}, sample by sample"),
            (true, true) => format!("{b} is {a} with its sign turned, sample by sample"),
            (false, false) => {
                format!("{b} and {a} agree down to their noise: one signal on two channels")
            }
            (false, true) => {
                format!(
                    "{b} is {a} with its sign turned, down to the noise: one signal on two channels"
                )
            }
        };
        notices.push(Notice {
            kind: if pair.opposite {
                "opposite"
            } else {
                "identical"
            },
            channels: pair.channels.to_vec(),
            text,
        });
    }
}

fn of_rate(inspection: &Inspection, remarks: &mut Vec<String>) {
    if inspection
        .groups
        .iter()
        .any(|g| g.sample_rate_hz.is_none() && g.samples > 1)
    {
        remarks.push(
            "nothing tells the sample rate: frequencies are in cycles per sample, and mains hum is not looked for".to_owned(),
        );
    }
}

fn of_units(inspection: &Inspection, remarks: &mut Vec<String>) {
    let mut unknown: Vec<String> = inspection
        .groups
        .iter()
        .flat_map(|g| &g.channels)
        .filter_map(|c| c.unit.as_ref())
        .filter(|u| u.measures.is_none())
        .map(|u| u.name.clone())
        .collect();
    unknown.sort();
    unknown.dedup();
    if !unknown.is_empty() {
        remarks.push(format!(
            "units that `calibrate` and `decouple` do not understand: {}",
            list(&unknown)
        ));
    }
}

fn of_sensor(inspection: &Inspection, expected: Option<&Expected>, remarks: &mut Vec<String>) {
    if let Some(expected) = expected.filter(|e| !e.listed) {
        remarks.push(format!(
            "not among the recordings of {}",
            expected.session.display()
        ));
    }
    let Some(sensor) = &inspection.sensor else {
        if let Some(expected) = expected {
            remarks.push(format!(
                "the session's nine limbs, {}, are not all in this file",
                list(&expected.limbs)
            ));
        }
        return;
    };
    let standard = |name: &Option<String>, what: &str| match name {
        Some(name) => format!("{what} ({name})"),
        None => format!("no {what}"),
    };
    remarks.push(format!(
        "nine limbs ({} to {}), {}, {}",
        sensor.limbs.first().map_or("", String::as_str),
        sensor.limbs.last().map_or("", String::as_str),
        standard(&sensor.accelerometer, "accelerometer"),
        standard(&sensor.gyroscope, "gyroscope")
    ));
    if !sensor.dead.is_empty() {
        remarks.push(format!("dead limbs: {}", list(&sensor.dead)));
    }
    if !sensor.silent.is_empty() {
        remarks.push(format!(
            "{} {} nothing but noise while most limbs move: dead, or this motion does not reach {}",
            list(&sensor.silent),
            if sensor.silent.len() == 1 {
                "shows"
            } else {
                "show"
            },
            if sensor.silent.len() == 1 {
                "it"
            } else {
                "them"
            },
        ));
    }
    remarks.push(
        "exchanged, inverted or wrongly scaled limbs do not show in one recording: `sixaxis calibrate SESSION` looks for them in all trials together"
            .to_owned(),
    );
}

fn list(names: &[String]) -> String {
    let shown = names
        .iter()
        .take(NAMED)
        .map(String::as_str)
        .collect::<Vec<&str>>()
        .join(", ");
    if names.len() > NAMED {
        format!("{shown} and {} more", names.len() - NAMED)
    } else {
        shown
    }
}
