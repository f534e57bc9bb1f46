//! Everything before the first row: comments, properties, headings.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

use super::detect::{Found, Numbered, detect};
use super::dialect::{Dialect, Separator, text, texts};
use super::lines::{LINE, Lines};
use super::lvm;
use crate::channel::{Channel, Layout, MOST_CHANNELS, is_sample_rate, sample_rate};
use crate::error::{Error, Place, Result};

/// Lines other than comments that decide the dialect.
const SAMPLE: usize = 100;

/// What a file says of its rows.
#[derive(Debug)]
pub struct Table {
    /// Separator and decimal sign.
    pub dialect: Dialect,
    /// Cells of a row.
    pub cells: RangeInclusive<usize>,
    /// Cell of the first channel.
    pub first_cell: usize,
    /// Whether a line of tabs is blank, and not a row of empty cells.
    pub loose: bool,
    /// Number of the line where the rows begin.
    pub first_line: u64,
}

/// Reads up to the first row and decides.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
pub fn read(path: &Path) -> Result<(Layout, Table)> {
    let mut lines = Lines::open(path)?;
    let mut comments: Vec<Numbered> = Vec::new();
    let mut sample: Vec<Numbered> = Vec::new();
    let (mut given, mut bytes) = (None, 0);
    let kind = if lines.is_gzip() { "CSV, gzip" } else { "CSV" };
    while let Some((number, line)) = lines.next()? {
        if number == 1 && lvm::is_lvm(line) {
            return lvm::read(path, &mut lines);
        }
        if number == 1
            && let Some(separator) = excel_separator(line)
        {
            given = Some(separator);
            continue;
        }
        bytes += line.len();
        if is_comment(line) {
            // Comments between the rows are nobody's properties.
            if sample.is_empty() {
                comments.push((number, line.to_vec()));
            }
        } else if !is_blank(line) {
            sample.push((number, line.to_vec()));
        }
        if sample.len() >= SAMPLE || bytes >= LINE {
            break;
        }
    }
    let Some((begin, _)) = sample.first() else {
        let cause = "no line with numbers or headings in the first MiB";
        return Err(Error::malformed(path, Place::Whole, cause));
    };
    let begin = *begin;
    let mut found = detect(&sample, given)
        .map_err(|(line, cause)| Error::malformed(path, Place::Line(line), cause))?;
    if found.columns > MOST_CHANNELS {
        return Err(Error::unsupported(
            path,
            format!("a table of {} columns", found.columns),
            format!(
                "at most {MOST_CHANNELS} are read; write one row per sample, or a binary format"
            ),
        ));
    }
    if found.headings.is_none() {
        found.headings = comments
            .last()
            .and_then(|(_, line)| commented_headings(line, &found));
    }
    let first_line = match found.before {
        0 => begin,
        before => sample.get(before - 1).map_or(begin, |line| line.0 + 1),
    };
    let format = format!("{kind} ({})", found.dialect.describe());
    let mut layout = Layout::new(format, channels(&found), BTreeMap::new());
    for (number, line) in &comments {
        if let Some((key, value)) = property(line) {
            apply(path, *number, &mut layout, key, value)?;
        }
    }
    let table = Table {
        dialect: found.dialect,
        cells: found.columns..=found.columns,
        first_cell: 0,
        loose: found.dialect.separator != Separator::Tab,
        first_line,
    };
    Ok((layout, table))
}

/// Whether a line is a comment.
pub fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

/// Whether nothing is in a line, not even a separator other than a blank.
pub fn is_blank(line: &[u8]) -> bool {
    line.iter().all(|byte| *byte == b' ' || *byte == b'\r')
}

/// Excel's `sep=;`.
fn excel_separator(line: &[u8]) -> Option<Separator> {
    match line.strip_prefix(b"sep=")? {
        b"\t" => Some(Separator::Tab),
        b";" => Some(Separator::Semicolon),
        b"," => Some(Separator::Comma),
        _ => None,
    }
}

/// `# key = value` or `# key: value`.
fn property(line: &[u8]) -> Option<(String, String)> {
    let comment = text(line.trim_ascii_start());
    let comment = comment.trim_start_matches(['#', '%']);
    let (key, value) = comment.split_once(['=', ':'])?;
    let (key, value) = (key.trim(), value.trim());
    (!key.is_empty() && !value.is_empty() && key.len() <= 64)
        .then(|| (key.to_owned(), value.to_owned()))
}

/// Keeps a property, and the sample rate if it is that.
fn apply(path: &Path, line: u64, layout: &mut Layout, key: String, value: String) -> Result<()> {
    if is_sample_rate(&key) {
        let rate = sample_rate(&key, &value)
            .map_err(|cause| Error::malformed(path, Place::Line(line), cause))?;
        for channel in &mut layout.channels {
            channel.sample_rate_hz = Some(rate);
        }
    }
    layout.properties.insert(key, value);
    Ok(())
}

/// Names in a comment, as `numpy.savetxt` writes them.
fn commented_headings(line: &[u8], found: &Found) -> Option<Vec<String>> {
    if found.columns < 2 || property(line).is_some() {
        return None;
    }
    let line = line.trim_ascii_start();
    let start = line
        .iter()
        .position(|byte| *byte != b'#' && *byte != b'%')?;
    let line = line.get(start..)?;
    let names = texts(line, found.dialect.separator).ok()?;
    let named = names
        .iter()
        .all(|n| !n.is_empty() && n.parse::<f64>().is_err());
    (names.len() == found.columns && named).then_some(names)
}

fn channels(found: &Found) -> Vec<Channel> {
    (0..found.columns)
        .map(|at| {
            let heading = found.headings.as_ref().and_then(|h| h.get(at));
            let unit = found.units.as_ref().and_then(|u| u.get(at));
            channel(at, heading.map_or("", String::as_str), unit)
        })
        .collect()
}

/// A channel from its heading and its cell in the line of units.
fn channel(at: usize, heading: &str, unit: Option<&String>) -> Channel {
    let mut channel = Channel::from_heading(heading);
    if let Some(unit) = unit {
        let unit = unit.trim_matches(|c: char| c.is_whitespace() || "[]()".contains(c));
        if channel.unit.as_deref() != Some(unit) {
            // The brackets in the heading are then part of the name.
            channel = Channel::new(heading.trim(), (!unit.is_empty()).then_some(unit));
        }
    }
    if channel.name.is_empty() {
        channel.name = format!("column_{}", at + 1);
    }
    channel
}
