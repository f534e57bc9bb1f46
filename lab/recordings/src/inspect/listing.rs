//! The facts as text for a terminal: plain characters, aligned columns.

use super::allan::Coefficient;
use super::facts::{ChannelFacts, Group, Inspection, NUMBERS, Severity};
use crate::ingest::clock::Stamps;
use crate::printable::line;

/// Significant digits of a table.
const DIGITS: usize = 4;
/// Properties shown, and characters of each.
const PROPERTIES: usize = 12;
const PROPERTY: usize = 96;
/// Characters of a name in a table.
const NAME: usize = 32;
/// Jitter up to this share of a step is the rounding of a double.
const ROUNDING: f64 = 1e-6;
/// Gaps listed.
const GAPS: usize = 5;

/// A number with so many significant digits: plain where that is short, with an exponent elsewhere.
pub fn brief(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}").replace("-0", "0");
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// A number in its unit.
pub fn with_unit(value: f64, unit: &str) -> String {
    let number = brief(value, DIGITS);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// A time with the prefix that suits it.
pub fn seconds(value: f64) -> String {
    let (factor, unit) = match value.abs() {
        v if v >= 1.0 || v == 0.0 || v.is_nan() => (1.0, "s"),
        v if v >= 1e-3 => (1e3, "ms"),
        v if v >= 1e-6 => (1e6, "us"),
        _ => (1e9, "ns"),
    };
    format!("{} {unit}", brief(value * factor, DIGITS))
}

/// A number of things.
pub(super) fn plural(n: u64, one: &str) -> String {
    match n {
        1 => format!("1 {one}"),
        _ => format!("{n} {one}s"),
    }
}

/// The whole text, one line break at its end.
pub fn text(inspection: &Inspection) -> String {
    let mut lines = vec![
        line(&inspection.file, 4096),
        format!("  {}", line(&inspection.format, 256)),
    ];
    for (name, value) in inspection.properties.iter().take(PROPERTIES) {
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        let (name, value) = (line(name, NAME), line(&value, PROPERTY));
        lines.push(format!("  {name}: {value}"));
    }
    if let Some(more @ 1..) = inspection.properties.len().checked_sub(PROPERTIES) {
        lines.push(format!("  and {more} more properties (--json has all)"));
    }
    for group in &inspection.groups {
        lines.push(format!("\n  {}", heading(group)));
        if let Some(stamps) = &group.time_stamps {
            lines.extend(clock(stamps));
        }
        if !group.channels.is_empty() {
            lines.push(String::new());
            lines.extend(table(group));
        }
        lines.extend(at_rest(group));
    }
    if !inspection.axis_noise.is_empty() {
        lines.push("\n  noise of the accelerations at rest, one-sided root density".to_owned());
        lines.extend(inspection.axis_noise.iter().map(|noise| {
            let density = brief(noise.noise_density, DIGITS);
            format!("    {:<8} {density} {}", noise.axis, noise.unit)
        }));
    }
    lines.push(String::new());
    let told = |severity| {
        let facts = inspection.told(severity);
        facts.map(|fact| format!("  - {}", line(&fact.text, 1024)))
    };
    if inspection.told(Severity::Noticed).next().is_none() {
        lines.push("  nothing noticed".to_owned());
    } else {
        lines.push("  noticed".to_owned());
        lines.extend(told(Severity::Noticed));
    }
    if inspection.told(Severity::Remark).next().is_some() {
        lines.push("  to be known".to_owned());
        lines.extend(told(Severity::Remark));
    }
    lines.join("\n") + "\n"
}

/// Channels, samples, rate and duration in one line.
pub fn heading(group: &Group) -> String {
    let channels = plural(group.channels.len() as u64, "channel");
    let samples = plural(group.samples, "sample");
    let rate = match group.sample_rate_hz {
        Some(rate) => format!(
            "{} Hz ({})",
            trimmed(&brief(rate, 7)),
            group.sample_rate_origin.words()
        ),
        None => "sample rate unknown".to_owned(),
    };
    let duration = group
        .duration_s
        .map_or_else(String::new, |duration| format!(", {}", seconds(duration)));
    let start_s = group.channels.first().map_or(0.0, |c| c.start_offset_s);
    let start = match start_s == 0.0 {
        true => String::new(),
        false => format!(", from {} after the file's start on", seconds(start_s)),
    };
    format!("{channels} of {samples}, {rate}{duration}{start}")
}

/// Without zeros at the end of a fraction.
fn trimmed(number: &str) -> &str {
    if number.contains('.') && !number.contains('e') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

/// Steps, jitter and gaps of the time stamps.
fn clock(stamps: &Stamps) -> Vec<String> {
    let name = line(&stamps.channel, NAME);
    let steps = match (stamps.mean_step_s, stamps.jitter_rms_s, stamps.jitter_max_s) {
        (Some(step), Some(rms), Some(most)) => {
            let jitter = if most > ROUNDING * step {
                format!("jitter {} rms, {} at most", seconds(rms), seconds(most))
            } else {
                "no jitter".to_owned()
            };
            let gaps = match stamps.gaps {
                0 => "no gap".to_owned(),
                some => plural(some, "gap"),
            };
            let standing = match stamps.not_advancing {
                0 => "all advancing".to_owned(),
                some => format!("{some} not advancing"),
            };
            format!("steps of {}, {jitter}; {gaps}, {standing}", seconds(step))
        }
        _ => "no step forward".to_owned(),
    };
    let mut lines = vec![format!("  time stamps in {name}: {steps}")];
    lines.extend(stamps.first_gaps.iter().take(GAPS).map(|gap| {
        format!(
            "    gap before sample {}: {} from time {} on",
            gap.sample,
            seconds(gap.length_s),
            seconds(gap.time_s)
        )
    }));
    lines
}

/// A channel's unit as a table has it: `-` for none, a question mark behind one that the other commands do not understand.
pub fn unit(channel: &ChannelFacts) -> String {
    match &channel.unit {
        None => "-".to_owned(),
        Some(unit) if unit.measures.is_some() => line(&unit.name, NAME),
        Some(unit) => format!("{}?", line(&unit.name, NAME)),
    }
}

/// What the channels of a group at rest show over averaging times, and why a coefficient is missing.
fn at_rest(group: &Group) -> Vec<String> {
    let at_rest: Vec<_> = group
        .channels
        .iter()
        .filter_map(|channel| Some((channel, channel.stability.as_ref()?)))
        .collect();
    if at_rest.is_empty() {
        return Vec::new();
    }
    let coefficient = |found: Option<Coefficient>| {
        found.map_or("-".to_owned(), |c| {
            format!(
                "{} +- {}",
                brief(c.value, DIGITS),
                brief(c.standard_error, 2)
            )
        })
    };
    let heading = [
        "channel",
        "unit",
        "density/rtHz",
        "bias instability",
        "at s",
        "walk/rts",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (channel, found) in &at_rest {
        rows.push(vec![
            line(&channel.name, NAME),
            unit(channel),
            coefficient(found.noise_density),
            coefficient(found.bias_instability.map(|(value, _)| value)),
            found
                .bias_instability
                .map_or("-".to_owned(), |(_, at_s)| brief(at_s, DIGITS)),
            coefficient(found.random_walk),
        ]);
    }
    let mut lines = vec![String::new(), "  at rest (Allan deviation)".to_owned()];
    lines.extend(aligned(&rows));
    let mut said: Vec<(&str, &str, Vec<&str>)> = Vec::new();
    for (channel, found) in &at_rest {
        for (&name, why) in &found.absent {
            match said.iter_mut().find(|(n, w, _)| *n == name && w == why) {
                Some((.., channels)) => channels.push(&channel.name),
                None => said.push((name, why, vec![&channel.name])),
            }
        }
    }
    lines.extend(said.iter().map(|(name, why, channels)| {
        let channels = line(&channels.join(", "), PROPERTY);
        format!("    no {} of {channels}: {why}", name.replace('_', " "))
    }));
    lines
}

/// The table of a group's channels. `-` stands for what does not exist.
fn table(group: &Group) -> Vec<String> {
    let mut heading = vec!["channel", "unit"];
    heading.extend(NUMBERS.map(|(name, ..)| name));
    heading.push("peak at");
    let mut rows: Vec<Vec<String>> = vec![heading.into_iter().map(str::to_owned).collect()];
    let per = match group.sample_rate_hz {
        Some(_) => "Hz",
        None => "/sample",
    };
    for channel in &group.channels {
        let mut row = vec![line(&channel.name, NAME), unit(channel)];
        row.extend(
            NUMBERS.map(|(_, digits, value)| {
                value(channel).map_or("-".to_owned(), |x| brief(x, digits))
            }),
        );
        row.push(channel.dominant.map_or("-".to_owned(), |line| {
            format!("{} {per}", brief(line.frequency, DIGITS))
        }));
        rows.push(row);
    }
    aligned(&rows)
}

/// Columns of equal width.
fn aligned(rows: &[Vec<String>]) -> Vec<String> {
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max();
    let widths: Vec<usize> = (0..rows[0].len()).filter_map(width).collect();
    rows.iter()
        .map(|row| {
            let cells = row.iter().zip(&widths).enumerate();
            let line = cells.map(|(k, (cell, &width))| match k {
                // Names to the left, numbers to the right.
                0 | 1 => format!("  {cell:<width$}"),
                _ => format!("  {cell:>width$}"),
            });
            line.collect::<String>().trim_end().to_owned()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(brief(0.012_345_6, 4), "0.01235");
        assert_eq!(brief(-98_735.8, 4), "-98736");
        assert_eq!(brief(9.999_96, 4), "10.00");
        assert_eq!(brief(1.234_56e-7, 4), "1.235e-7");
        assert_eq!(brief(-0.0, 4), "0");
        assert_eq!(seconds(1.234_56e-5), "12.35 us");
        assert_eq!(trimmed("1000.000"), "1000");
    }
}
