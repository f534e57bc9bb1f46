//! The header of LabVIEW Measurement files: lines of key and values, one value per channel.

use std::collections::BTreeMap;
use std::path::Path;

use super::dialect::{Decimal, Dialect, Separator, number, texts};
use super::head::{Column, Table, is_blank};
use super::lines::Lines;
use crate::channel::{Channel, MOST_CHANNELS};
use crate::error::{Error, Place, Result};
use crate::layout::Layout;

const END: &str = "***End_of_Header***";
/// Lines that a header may have.
const HEADER: u64 = 1000;

/// Whether the first line of a file says so.
pub fn is_lvm(line: &[u8]) -> bool {
    line.starts_with(b"LabVIEW Measurement")
}

#[derive(Default)]
struct Header {
    rows: Vec<(String, Vec<String>)>,
}

impl Header {
    fn values(&self, key: &str) -> &[String] {
        let row = self.rows.iter().rfind(|(k, _)| k == key);
        row.map_or(&[], |(_, values)| values)
    }

    fn value(&self, key: &str) -> &str {
        self.values(key).first().map_or("", String::as_str)
    }
}

/// Reads the two headers and the headings; the first line has been read.
///
/// # Errors
/// [`Error::Unsupported`] for an X column per channel; [`Error::Malformed`], [`Error::Io`].
pub fn read(path: &Path, lines: &mut Lines) -> Result<(Layout, Table)> {
    let mut header = Header::default();
    let mut separator = Separator::Tab;
    let mut ends = 0;
    let headings = loop {
        let Some((at, line)) = lines.next()? else {
            let cause = "the file ends within the LabVIEW header";
            return Err(Error::malformed(path, Place::Whole, cause));
        };
        if at > HEADER {
            let cause = format!("the LabVIEW header does not end within {HEADER} lines");
            return Err(Error::malformed(path, Place::Line(at), cause));
        }
        if is_blank(line) || line.iter().all(|byte| b"\t, ".contains(byte)) {
            continue;
        }
        let mut words = texts(line, separator)
            .map_err(|cause| Error::malformed(path, Place::Line(at), cause))?;
        let key = words.first().cloned().unwrap_or_default();
        if key.starts_with(END) {
            ends += 1;
        } else if key == "Separator" || key.starts_with("Separator,") {
            // This line is written with the separator that it names.
            if key.starts_with("Separator,") || words.get(1).is_some_and(|word| word == "Comma") {
                separator = Separator::Comma;
            }
        } else if ends >= 2 || key == "X_Value" {
            break (at, words);
        } else {
            words.remove(0);
            header.rows.push((key, words));
        }
    };
    table(path, &header, separator, headings)
}

fn table(
    path: &Path,
    header: &Header,
    separator: Separator,
    (line, mut names): (u64, Vec<String>),
) -> Result<(Layout, Table)> {
    if header.value("X_Columns") == "Multi" {
        return Err(Error::unsupported(
            path,
            "a LabVIEW Measurement file with an X column per channel",
            "export it with one X column or none, or as TDMS",
        ));
    }
    let decimal = match header.value("Decimal_Separator") {
        "," => Decimal::Comma,
        _ => Decimal::Point,
    };
    // Behind the channels stands a column for remarks, mostly empty, often left out.
    if names.last().is_some_and(|name| name == "Comment") {
        names.pop();
    }
    while names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    let has_x = header.value("X_Columns") != "No";
    if names.first().is_none_or(|name| name != "X_Value") || names.len() < 2 {
        let cause = "expected the headings X_Value and those of the channels";
        return Err(Error::malformed(path, Place::Line(line), cause));
    }
    if names.len() > MOST_CHANNELS {
        return Err(Error::unsupported(
            path,
            format!("a table of {} columns", names.len()),
            format!("at most {MOST_CHANNELS} are read"),
        ));
    }
    let is_time = |at: usize| {
        let dimensions = header.values("X_Dimension");
        dimensions
            .get(at)
            .is_none_or(|d| d.is_empty() || d == "Time")
    };
    let mut scratch = String::new();
    let mut figure = |key: &str, at: usize| {
        let value = header.values(key).get(at)?;
        number(value.as_bytes(), &mut decimal.clone(), &mut scratch).filter(|v| v.is_finite())
    };
    let mut channels = Vec::new();
    for (at, name) in names.iter().skip(1).enumerate() {
        let unit = header.values("Y_Unit_Label").get(at).map(String::as_str);
        let mut channel = Channel::new(name.as_str(), unit.filter(|unit| !unit.is_empty()));
        if is_time(at) {
            channel.sample_rate_hz = figure("Delta_X", at)
                .filter(|step| *step > 0.0)
                .map(|step| 1.0 / step);
            channel.start_offset_s = figure("X0", at).unwrap_or(0.0);
        }
        channels.push(channel);
    }
    let time = has_x && is_time(0);
    if has_x {
        channels.insert(0, Channel::new("X_Value", time.then_some("s")));
    }
    let dialect = Dialect { separator, decimal };
    let mut properties = BTreeMap::new();
    for key in [
        "Project",
        "Operator",
        "Description",
        "Date",
        "Time",
        "Test_Name",
    ] {
        let value = header.value(key);
        if !value.is_empty() {
            properties.insert(key.to_owned(), value.to_owned());
        }
    }
    let format = format!("LabVIEW Measurement ({})", dialect.describe());
    let layout = Layout {
        time: time.then_some(0),
        ..Layout::new(format, channels, properties)
    };
    let table = Table {
        dialect,
        cells: names.len()..=names.len() + 1,
        columns: Column::plain(usize::from(!has_x)..names.len()),
        loose: true,
        first_line: line + 1,
        cut: false,
    };
    Ok((layout, table))
}
