//! The answer as text for a terminal: plain characters, aligned columns.

use std::fmt::Write as _;

use super::clock::Stamps;
use super::findings::{ChannelFacts, Group, Inspection};

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
#[must_use]
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
#[must_use]
pub fn with_unit(value: f64, unit: &str) -> String {
    let number = brief(value, DIGITS);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// A time with the prefix that suits it.
#[must_use]
pub fn seconds(value: f64) -> String {
    let (factor, unit) = match value.abs() {
        v if v >= 1.0 || v == 0.0 || v.is_nan() => (1.0, "s"),
        v if v >= 1e-3 => (1e3, "ms"),
        v if v >= 1e-6 => (1e6, "us"),
        _ => (1e9, "ns"),
    };
    format!("{} {unit}", brief(value * factor, DIGITS))
}

/// A name from a file without what a terminal would take for a command, cut to so many characters.
#[must_use]
pub fn printable(text: &str, most: usize) -> String {
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut shown: String = text.chars().take(most).map(clean).collect();
    if text.chars().nth(most).is_some() {
        shown.pop();
        shown.push('…');
    }
    shown
}

/// The whole answer, one line break at its end.
#[must_use]
pub fn text(inspection: &Inspection) -> String {
    let mut out = String::new();
    // Writing to a String does not fail.
    let _ = write_text(&mut out, inspection);
    out
}

fn write_text(out: &mut String, inspection: &Inspection) -> std::fmt::Result {
    writeln!(out, "{}", printable(&inspection.file, 4096))?;
    writeln!(out, "  {}", printable(&inspection.format, 256))?;
    for (name, value) in inspection.properties.iter().take(PROPERTIES) {
        let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
        writeln!(
            out,
            "  {}: {}",
            printable(name, NAME),
            printable(&value, PROPERTY)
        )?;
    }
    if inspection.properties.len() > PROPERTIES {
        writeln!(
            out,
            "  and {} more properties (--json has all)",
            inspection.properties.len() - PROPERTIES
        )?;
    }
    for group in &inspection.groups {
        writeln!(out, "\n  {}", heading(group))?;
        if let Some(stamps) = &group.time_stamps {
            write_stamps(out, stamps)?;
        }
        if !group.channels.is_empty() {
            out.push('\n');
            write_table(out, group)?;
        }
    }
    out.push('\n');
    if inspection.noticed.is_empty() {
        writeln!(out, "  nothing noticed")?;
    } else {
        writeln!(out, "  noticed")?;
        for notice in &inspection.noticed {
            writeln!(out, "  - {}", printable(&notice.text, 1024))?;
        }
    }
    if !inspection.remarks.is_empty() {
        writeln!(out, "  to be known")?;
        for remark in &inspection.remarks {
            writeln!(out, "  - {}", printable(remark, 1024))?;
        }
    }
    Ok(())
}

/// Channels, samples, rate and duration in one line.
#[must_use]
pub fn heading(group: &Group) -> String {
    let plural = |n: u64, one: &str| {
        if n == 1 {
            format!("1 {one}")
        } else {
            format!("{n} {one}s")
        }
    };
    let mut line = format!(
        "{} of {}",
        plural(group.channels.len() as u64, "channel"),
        plural(group.samples, "sample")
    );
    match group.sample_rate_hz {
        Some(rate) => {
            let _ = write!(
                line,
                ", {} Hz ({})",
                trimmed(&brief(rate, 7)),
                group.sample_rate_origin.words()
            );
        }
        None => line.push_str(", sample rate unknown"),
    }
    if let Some(duration) = group.duration_s {
        let _ = write!(line, ", {}", seconds(duration));
    }
    line
}

/// Without zeros at the end of a fraction.
fn trimmed(number: &str) -> &str {
    if number.contains('.') && !number.contains('e') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

fn write_stamps(out: &mut String, stamps: &Stamps) -> std::fmt::Result {
    let name = printable(&stamps.channel, NAME);
    match (stamps.mean_step_s, stamps.jitter_rms_s, stamps.jitter_max_s) {
        (Some(step), Some(rms), Some(most)) => {
            let jitter = if most > ROUNDING * step {
                format!("jitter {} rms, {} at most", seconds(rms), seconds(most))
            } else {
                "no jitter".to_owned()
            };
            let gaps = match stamps.gaps {
                0 => "no gap".to_owned(),
                1 => "1 gap".to_owned(),
                more => format!("{more} gaps"),
            };
            let standing = match stamps.not_advancing {
                0 => "all advancing".to_owned(),
                some => format!("{some} not advancing"),
            };
            writeln!(
                out,
                "  time stamps in {name}: steps of {}, {jitter}; {gaps}, {standing}",
                seconds(step)
            )?;
        }
        _ => writeln!(out, "  time stamps in {name}: no step forward")?,
    }
    for gap in stamps.first_gaps.iter().take(GAPS) {
        writeln!(
            out,
            "    gap before sample {}: {} from time {} on",
            gap.sample,
            seconds(gap.length_s),
            seconds(gap.time_s)
        )?;
    }
    Ok(())
}

/// Heading of each column of the table.
pub const COLUMNS: [&str; 11] = [
    "channel", "unit", "min", "max", "mean", "std dev", "noise", "step", "bits", "drift", "peak at",
];

/// A channel's row of the table. `-` stands for what does not exist.
#[must_use]
pub fn row(channel: &ChannelFacts, hertz: bool) -> [String; 11] {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |x| brief(x, DIGITS));
    let unit = match &channel.unit {
        None => "-".to_owned(),
        Some(unit) if unit.measures.is_some() => printable(&unit.name, NAME),
        Some(unit) => format!("{}?", printable(&unit.name, NAME)),
    };
    [
        printable(&channel.name, NAME),
        unit,
        number(channel.minimum),
        number(channel.maximum),
        number(channel.mean),
        number(channel.standard_deviation),
        number(channel.noise_floor),
        number(channel.smallest_step),
        channel
            .bits_used
            .map_or("-".to_owned(), |bits| format!("{bits:.1}")),
        number(channel.drift),
        channel.dominant.map_or("-".to_owned(), |line| {
            format!(
                "{} {}",
                brief(line.frequency, DIGITS),
                if hertz { "Hz" } else { "/sample" }
            )
        }),
    ]
}

fn write_table(out: &mut String, group: &Group) -> std::fmt::Result {
    let mut rows = vec![COLUMNS.map(str::to_owned)];
    rows.extend(
        group
            .channels
            .iter()
            .map(|c| row(c, group.sample_rate_hz.is_some())),
    );
    let widths: [usize; 11] = std::array::from_fn(|k| {
        rows.iter()
            .map(|r| r[k].chars().count())
            .max()
            .unwrap_or_default()
    });
    for row in &rows {
        let mut line = String::from("  ");
        for (k, (cell, width)) in row.iter().zip(widths).enumerate() {
            let space = " ".repeat(width - cell.chars().count());
            // Names to the left, numbers to the right.
            if k < 2 {
                line.push_str(cell);
                line.push_str(&space);
            } else {
                line.push_str(&space);
                line.push_str(cell);
            }
            line.push_str("  ");
        }
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
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
        assert_eq!(printable("a\u{1b}[2Jb", 10), "a\u{fffd}[2Jb");
    }
}
