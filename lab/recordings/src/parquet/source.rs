//! Reading.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use ::parquet::basic::Compression;
use ::parquet::column::reader::{ColumnReader, get_column_reader};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};

use super::arrow;
use super::column::{Meaning, Trouble, append, meaning};
use super::pages::page_reader;
use super::{HEADING_KEY, LEFT_OUT, OFFSET_KEY, RATE_KEY};
use crate::began::Began;
use crate::channel::{Channel, is_sample_rate};
use crate::error::{Error, Place, Result};
use crate::layout::Layout;
use crate::source::{Decoder, Source, reading};
use crate::unit::in_name;
use crate::unwinding::caught;

/// Key-value metadata that describe the columns to one library or another, not the recording to a person.
const TECHNICAL_KEYS: [&str; 3] = [
    arrow::KEY,
    "pandas",
    "org.apache.spark.sql.parquet.row.metadata",
];

/// A Parquet file, open for reading.
struct Parquet {
    path: PathBuf,
    file: File,
    metadata: ParquetMetaData,
    /// Column of the file and meaning of each channel.
    columns: Vec<(usize, Meaning)>,
}

/// Where reading stands.
struct Position {
    selected: Vec<Reading>,
    /// Row group being read, and how many of its rows have been.
    group: usize,
    group_rows_read: u64,
    /// Rows read in all.
    rows_read: u64,
}

/// A selected channel.
struct Reading {
    channel: usize,
    reader: Option<ColumnReader>,
    first_stamp: Option<i64>,
}

/// Runs the library, whose panics on hostile files become errors of the file.
fn guarded<T>(path: &Path, place: Place, work: impl FnOnce() -> T) -> Result<T> {
    caught(work).ok_or_else(|| Error::malformed(path, place, "the Parquet library gave up on it"))
}

fn refused(path: &Path, place: Place, what: &str, error: &ParquetError) -> Error {
    let cause = match error {
        ParquetError::General(text) | ParquetError::EOF(text) => text.clone(),
        other => other.to_string(),
    };
    match error {
        ParquetError::NYI(_) => Error::unsupported(
            path,
            format!("{what}: {cause}"),
            "write the file with plain or dictionary encoding and snappy",
        ),
        _ => Error::malformed(path, place, format!("{what}: {cause}")),
    }
}

/// Opens a Parquet file.
///
/// # Errors
/// Those of [`Source`]; [`Error::Unsupported`] for an encrypted file or one without a numeric column.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let io = |source| Error::io(path, source);
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let metadata = guarded(path, Place::Whole, || {
        ParquetMetaDataReader::new().parse_and_finish(&file)
    })?
    .map_err(|error| refused(path, Place::Byte(length), "footer", &error))?;
    let (mut layout, columns) = arrange(path, &metadata)?;
    let mut parquet = Parquet {
        path: path.to_owned(),
        file,
        metadata,
        columns,
    };
    for channel in 0..layout.channels.len() {
        if let Some(began) = parquet.began(&layout, channel) {
            let name = format!("{}/first_timestamp", layout.channels[channel].name);
            layout.properties.insert(name, began);
        }
    }
    Ok(reading(path, layout, parquet))
}

impl Parquet {
    /// Date and time of the first sample of a channel of time stamps; none where it cannot be read, which who reads it is told.
    fn began(&mut self, layout: &Layout, channel: usize) -> Option<String> {
        let (
            _,
            Meaning::Stamp {
                per_second,
                universal,
            },
        ) = self.columns[channel]
        else {
            return None;
        };
        let mut at = self.start(layout, &[channel], 0).ok()?;
        self.next(&mut at, layout, &mut [Vec::new()], 1).ok()?;
        let ns = (1e9 / per_second) as i128 * i128::from(at.selected[0].first_stamp?);
        Began { ns, universal }.text()
    }

    /// Opens the selected channels' chunks of the current row group.
    fn open_group(&self, at: &mut Position, layout: &Layout) -> Result<()> {
        let group = self.metadata.row_group(at.group);
        let place = Place::Sample(at.rows_read);
        let malformed = |cause| Error::malformed(&self.path, place, cause);
        for reading in &mut at.selected {
            let name = &layout.channels[reading.channel].name;
            let (column, _) = self.columns[reading.channel];
            let what = format!("channel {name:?}, row group {}", at.group);
            let Some(chunk) = group.columns().get(column) else {
                return Err(malformed(format!("{what} is missing")));
            };
            check_codec(&self.path, name, chunk.compression())?;
            let (samples, rows) = (chunk.num_values(), group.num_rows());
            if samples != rows {
                let cause = format!("{what} has {samples} samples, the row group {rows}");
                return Err(malformed(cause));
            }
            let rows = usize::try_from(rows).unwrap_or(usize::MAX);
            let reader = guarded(&self.path, place, || {
                page_reader(&self.file, chunk, rows)
                    .map(|pages| get_column_reader(chunk.column_descr_ptr(), pages))
            })?
            .map_err(|error| refused(&self.path, place, &what, &error))?;
            reading.reader = Some(reader);
        }
        Ok(())
    }

    /// Appends the next rows of a channel.
    fn fill(
        &self,
        reading: &mut Reading,
        name: &str,
        before: u64,
        rows: usize,
        column: &mut Vec<f64>,
    ) -> Result<()> {
        let (_, meaning) = self.columns[reading.channel];
        let Some(reader) = &mut reading.reader else {
            return Ok(());
        };
        let read = guarded(&self.path, Place::Sample(before), || {
            append(reader, meaning, &mut reading.first_stamp, rows, column)
        })?;
        let (at, cause) = match read {
            Ok(read) if read == rows => return Ok(()),
            Ok(read) => (
                read,
                format!("channel {name:?} ends here, before its row group does"),
            ),
            Err(Trouble::Null(at)) => (
                at,
                format!(
                    "channel {name:?} has no value here (null); a recording has no holes, fill it or cut it"
                ),
            ),
            Err(Trouble::Library(error)) => {
                let what = format!("channel {name:?}");
                return Err(refused(&self.path, Place::Sample(before), &what, &error));
            }
        };
        let place = Place::Sample(before + at as u64);
        Err(Error::malformed(&self.path, place, cause))
    }
}

/// Channels and properties, with the column and the meaning of each channel.
fn arrange(path: &Path, metadata: &ParquetMetaData) -> Result<(Layout, Vec<(usize, Meaning)>)> {
    let file = metadata.file_metadata();
    let rows = file.num_rows();
    let in_groups = metadata.row_groups().iter().try_fold(0i64, |sum, group| {
        (group.num_rows() >= 0).then_some(())?;
        sum.checked_add(group.num_rows())
    });
    if in_groups != Some(rows) {
        return Err(Error::malformed(
            path,
            Place::Whole,
            format!("{rows} rows announced, and row groups of another sum"),
        ));
    }
    let mut properties: BTreeMap<String, String> = file
        .key_value_metadata()
        .into_iter()
        .flatten()
        .filter(|pair| !TECHNICAL_KEYS.contains(&pair.key.as_str()))
        .map(|pair| (pair.key.clone(), pair.value.clone().unwrap_or_default()))
        .collect();
    let described = file
        .key_value_metadata()
        .into_iter()
        .flatten()
        .find(|pair| pair.key == arrow::KEY)
        .and_then(|pair| arrow::fields(pair.value.as_deref()?))
        .unwrap_or_default();
    let (mut channels, mut columns, mut left_out) = (Vec::<Channel>::new(), Vec::new(), Vec::new());
    for (index, column) in file.schema_descr().columns().iter().enumerate() {
        match meaning(column) {
            Ok(mut meaning) => {
                let heading = properties.remove(&format!("{HEADING_KEY}:{}", column.name()));
                let mut channel =
                    Channel::from_heading(heading.as_deref().unwrap_or(column.name()));
                if heading.is_none() && channel.unit.is_none() {
                    // Software that copies a file may keep the columns' names and not the metadata.
                    let unit = in_name(&channel.name).map(|(_, unit)| unit.to_owned());
                    channel.unit = unit;
                }
                if let Some(field) = described.iter().find(|f| f.name == column.name()) {
                    channel.unit = channel.unit.or_else(|| field.unit.clone());
                    if let (Meaning::Plain, Some(rate)) = (meaning, field.duration) {
                        meaning = Meaning::Span(rate);
                    }
                }
                // Time is converted, whatever the heading calls it.
                if let Some(unit) = meaning.unit() {
                    channel.unit = Some(unit.to_owned());
                }
                channel.samples = u64::try_from(rows).ok();
                channels.push(channel);
                columns.push((index, meaning));
            }
            Err(kind) => left_out.push(format!("{} ({kind})", column.path().string())),
        }
    }
    if channels.is_empty() {
        return Err(Error::unsupported(
            path,
            format!("a table without a numeric column ({})", left_out.join(", ")),
            "store each channel as a column of floats or integers",
        ));
    }
    let mut layout = Layout::new("Parquet", channels, properties);
    let properties = &mut layout.properties;
    for (key, set) in [
        (
            RATE_KEY,
            (|c, v| c.sample_rate_hz = Some(v)) as fn(&mut Channel, f64),
        ),
        (OFFSET_KEY, |c, v| c.start_offset_s = v),
    ] {
        let name = properties
            .keys()
            .find(|name| *name == key || (key == RATE_KEY && is_sample_rate(name)))
            .cloned();
        let of_all = name.and_then(|name| properties.remove(&name));
        for channel in &mut layout.channels {
            let own = properties.remove(&format!("{key}:{}", channel.name));
            let Some(text) = own.as_ref().or(of_all.as_ref()) else {
                continue;
            };
            let number = text.trim().parse::<f64>().ok();
            match number.filter(|v| v.is_finite() && (key != RATE_KEY || *v > 0.0)) {
                Some(value) => set(channel, value),
                None => {
                    return Err(Error::malformed(
                        path,
                        Place::Whole,
                        format!("the metadata say {key} = {text:?}"),
                    ));
                }
            }
        }
    }
    if !left_out.is_empty() {
        properties.insert(LEFT_OUT.to_owned(), left_out.join(", "));
    }
    Ok((layout, columns))
}

fn check_codec(path: &Path, channel: &str, codec: Compression) -> Result<()> {
    match codec {
        Compression::BROTLI(_) | Compression::LZO => Err(Error::unsupported(
            path,
            format!("channel {channel:?} compressed by {codec}"),
            "write the file with snappy",
        )),
        _ => Ok(()),
    }
}

impl Decoder for Parquet {
    type Position = Position;

    fn start(&mut self, _layout: &Layout, selected: &[usize], _samples: u64) -> Result<Position> {
        let readings = selected.iter().map(|&channel| Reading {
            channel,
            reader: None,
            first_stamp: None,
        });
        Ok(Position {
            selected: readings.collect(),
            group: 0,
            group_rows_read: 0,
            rows_read: 0,
        })
    }

    fn next(
        &mut self,
        at: &mut Position,
        layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize> {
        let left = loop {
            let Some(group) = self.metadata.row_groups().get(at.group) else {
                return Ok(0);
            };
            let rows = u64::try_from(group.num_rows()).unwrap_or(0);
            if at.group_rows_read < rows {
                break rows - at.group_rows_read;
            }
            at.group += 1;
            at.group_rows_read = 0;
        };
        if at.group_rows_read == 0 {
            self.open_group(at, layout)?;
        }
        let rows = usize::try_from(left).map_or(limit, |left| left.min(limit));
        for (reading, column) in at.selected.iter_mut().zip(columns) {
            let name = &layout.channels[reading.channel].name;
            self.fill(reading, name, at.rows_read, rows, column)?;
        }
        at.group_rows_read += rows as u64;
        at.rows_read += rows as u64;
        Ok(rows)
    }
}
