//! Writing.

use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use ::parquet::basic::{Compression, Encoding, Repetition, Type as Physical};
use ::parquet::data_type::DoubleType;
use ::parquet::errors::{ParquetError, Result};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

use super::{HEADING_KEY, LEFT_OUT, OFFSET_KEY, RATE_KEY};
use crate::channel::Channel;
use crate::layout::Layout;
use crate::sink::{self, Encoder, Sink};

/// Rows of a row group: what is held in memory, and what a reader may fetch by itself.
const GROUP_ROWS: usize = 131_072;

/// Bytes of a page. Small enough that its buffers stay in the cache, and that the allocator does not return them to the system
/// after each page.
const PAGE_BYTES: usize = 1 << 16;

/// Starts a Parquet file: one DOUBLE column per channel, snappy.
///
/// # Errors
/// Those of [`sink::create`].
pub(crate) fn create(path: &Path, layout: &Layout) -> crate::Result<Box<dyn Sink>> {
    sink::create(path, layout, |file| writer(file, layout).map_err(io_error))
}

fn writer(file: File, layout: &Layout) -> Result<SerializedFileWriter<File>> {
    let names = column_names(layout);
    let fields = names
        .iter()
        .map(|name| {
            Type::primitive_type_builder(name, Physical::DOUBLE)
                .with_repetition(Repetition::REQUIRED)
                .build()
                .map(Arc::new)
        })
        .collect::<Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("recording")
        .with_fields(fields)
        .build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_data_page_size_limit(PAGE_BYTES)
        .set_max_row_group_row_count(Some(GROUP_ROWS))
        .set_created_by(
            concat!("sixaxis-recordings version ", env!("CARGO_PKG_VERSION")).to_owned(),
        )
        .set_key_value_metadata(Some(key_values(layout, &names)))
        .build();
    SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
}

fn write_group(to: &mut SerializedFileWriter<File>, columns: &[Vec<f64>]) -> Result<()> {
    let mut group = to.next_row_group()?;
    for column in columns {
        let Some(mut writer) = group.next_column()? else {
            break;
        };
        writer
            .typed::<DoubleType>()
            .write_batch(column, None, None)?;
        writer.close()?;
    }
    group.close()?;
    Ok(())
}

impl Encoder for SerializedFileWriter<File> {
    fn rows(&self) -> usize {
        GROUP_ROWS
    }

    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        write_group(self, columns).map_err(io_error)
    }

    fn finish(self) -> io::Result<File> {
        self.into_inner().map_err(io_error)
    }
}

fn io_error(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(source) => *source,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

/// Names of the columns: of letters, digits and underscores, with the unit at the end, so that they can be written without
/// quotes in Python and SQL.
fn column_names(layout: &Layout) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let channels = layout.channels.iter().enumerate();
    let names = channels.map(|(at, channel)| {
        let plain = plain_name(channel, at);
        let mut name = plain.clone();
        for again in 2.. {
            if taken.insert(name.clone()) {
                break;
            }
            name = format!("{plain}_{again}");
        }
        name
    });
    names.collect()
}

/// `ax_m_s2` of `ax` in `m/s^2`.
fn plain_name(channel: &Channel, at: usize) -> String {
    let unit = channel.unit.as_deref().filter(|unit| *unit != "1");
    let unit = unit.unwrap_or_default().replace('^', "").replace('²', "2");
    let unit = unit.replace('°', "deg").replace('µ', "u");
    let both = format!("{} {unit}", channel.name);
    let words = both.split(|c: char| !c.is_alphanumeric() && c != '_');
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    match words.join("_") {
        name if name.is_empty() => format!("column_{}", at + 1),
        name if name.starts_with(|c: char| c.is_numeric()) => format!("column_{name}"),
        name => name,
    }
}

/// Headings that the columns' names do not show, properties, rates and offsets. What all channels have in common stands once, the rest per channel.
fn key_values(layout: &Layout, names: &[String]) -> Vec<KeyValue> {
    let mut pairs: Vec<_> = layout
        .properties
        .iter()
        .filter(|(key, _)| !matches!(key.as_str(), LEFT_OUT | RATE_KEY | OFFSET_KEY))
        .map(|(key, value)| KeyValue::new(key.clone(), value.clone()))
        .collect();
    for (channel, name) in layout.channels.iter().zip(names) {
        let heading = channel.heading();
        if heading != *name {
            pairs.push(KeyValue::new(format!("{HEADING_KEY}:{name}"), heading));
        }
    }
    let rate: fn(&Channel) -> Option<f64> = |c| c.sample_rate_hz;
    let offset: fn(&Channel) -> Option<f64> =
        |c| (c.start_offset_s != 0.0).then_some(c.start_offset_s);
    for (key, value) in [(RATE_KEY, rate), (OFFSET_KEY, offset)] {
        let mut values = layout.channels.iter().map(value);
        let first = values.next().flatten();
        if values.all(|other| other == first) {
            pairs.extend(first.map(|v| KeyValue::new(key.to_owned(), v.to_string())));
        } else {
            pairs.extend(layout.channels.iter().filter_map(|channel| {
                let text = value(channel)?.to_string();
                Some(KeyValue::new(format!("{key}:{}", channel.name), text))
            }));
        }
    }
    pairs
}
