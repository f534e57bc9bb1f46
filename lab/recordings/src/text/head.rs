//! Everything before the first row: comments, properties, headings.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

use super::detect::{Found, Numbered, detect};
use super::dialect::{Dialect, Separator, split, text, texts};
use super::lines::{LINE, Lines};
use super::lvm;
use super::stamp::{Stamps, date, time_of_day, whole};
use crate::channel::{Channel, MOST_CHANNELS, is_sample_rate, sample_rate};
use crate::error::{Error, Place, Result};
use crate::layout::Layout;

/// Lines other than comments that decide the dialect.
const SAMPLE: usize = 100;

/// What a file says of its rows.
#[derive(Debug)]
pub struct Table {
    /// Separator and decimal sign.
    pub dialect: Dialect,
    /// Cells of a row.
    pub cells: RangeInclusive<usize>,
    /// Where each channel is.
    pub columns: Vec<Column>,
    /// Whether a line of tabs is blank, and not a row of empty cells.
    pub loose: bool,
    /// Number of the line where the rows begin.
    pub first_line: u64,
    /// Whether the last line breaks off and is left out.
    pub cut: bool,
}

/// Where a channel is in a row.
#[derive(Debug)]
pub struct Column {
    /// Its cell.
    pub cell: usize,
    /// How its time stamps are written, and the first of them, if it is a column of these.
    pub stamps: Option<(Stamps, i128)>,
}

impl Column {
    /// Columns of numbers.
    pub fn plain(cells: Range<usize>) -> Vec<Self> {
        cells.map(|cell| Self { cell, stamps: None }).collect()
    }
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
    let mut channels = channels(&found);
    let mut properties = BTreeMap::new();
    let columns = match sample.get(found.before) {
        Some((_, row)) => columns(row, found.dialect.separator, &mut channels, &mut properties),
        None => Column::plain(0..found.columns),
    };
    let mut layout = Layout::new(format, channels, properties);
    layout.time = layout
        .time
        .or_else(|| columns.iter().position(|column| column.stamps.is_some()));
    for (number, line) in &comments {
        if let Some((key, value)) = property(line) {
            apply(path, *number, &mut layout, key, value)?;
        }
    }
    let table = Table {
        dialect: found.dialect,
        cells: found.columns..=found.columns,
        columns,
        loose: found.dialect.separator != Separator::Tab,
        first_line,
        cut: false,
    };
    Ok((layout, table))
}

/// Columns of numbers and of time stamps, as the first row shows them. A date goes with the time of day of its row and is no
/// channel by itself.
fn columns(
    row: &[u8],
    separator: Separator,
    channels: &mut Vec<Channel>,
    properties: &mut BTreeMap<String, String>,
) -> Vec<Column> {
    let mut cells = Vec::new();
    let mut columns = Column::plain(0..channels.len());
    if split(row, separator, &mut cells).is_err() || cells.len() != channels.len() {
        return columns;
    }
    let cell = |at: usize| {
        let place = cells.get(at).and_then(|&(begin, end)| row.get(begin..end));
        place.unwrap_or_default()
    };
    let day = (0..cells.len()).find(|at| date(cell(*at)).is_some());
    for (column, channel) in columns.iter_mut().zip(channels.iter_mut()) {
        let own = cell(column.cell);
        let stamps = match (whole(own), time_of_day(own)) {
            (Some(_), _) => Stamps::Whole,
            (_, Some(_)) => Stamps::TimeOfDay(day),
            _ => continue,
        };
        column.stamps = stamps.read(own, cell).map(|first| (stamps, first));
        channel.unit = Some("s".to_owned());
        let mut first = text(own);
        if let Stamps::TimeOfDay(Some(day)) = stamps {
            first = format!("{} {first}", text(cell(day)));
        }
        properties.insert(format!("{}/first_timestamp", channel.name), first);
    }
    let goes_along = |column: &Column| matches!(column.stamps, Some((Stamps::TimeOfDay(_), _)));
    if let Some(day) = day
        && columns.iter().any(goes_along)
    {
        columns.remove(day);
        channels.remove(day);
    }
    columns
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
