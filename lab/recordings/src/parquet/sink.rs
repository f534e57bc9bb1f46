//! Writing.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::parquet::basic::{Compression, Encoding, Repetition, Type as Physical};
use ::parquet::data_type::DoubleType;
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

use super::keys::{LEFT_OUT, OFFSET_KEY, RATE_KEY};
use crate::channel::{Block, Channel, Layout};
use crate::draft::Draft;
use crate::error::{Error, Result};
use crate::sink::Sink;

/// Rows of a row group: what is held in memory, and what a reader may fetch by itself.
const GROUP_ROWS: usize = 131_072;

/// Bytes of a page. Small enough that its buffers stay in the cache, and that the allocator does not return them to the system
/// after each page.
const PAGE_BYTES: usize = 1 << 16;

/// A Parquet file being written.
pub(super) struct ParquetSink {
    path: PathBuf,
    draft: Draft,
    writer: SerializedFileWriter<File>,
    pending: Vec<Vec<f64>>,
}

impl ParquetSink {
    pub(super) fn create(path: &Path, layout: &Layout) -> Result<Self> {
        if layout.channels.is_empty() {
            return Err(Error::unsupported(
                path,
                "a Parquet file without channels",
                "select at least one",
            ));
        }
        let refused = |error| io_error(path, error);
        let fields = layout
            .channels
            .iter()
            .map(|channel| {
                Type::primitive_type_builder(&heading(channel), Physical::DOUBLE)
                    .with_repetition(Repetition::REQUIRED)
                    .build()
                    .map(Arc::new)
            })
            .collect::<std::result::Result<Vec<_>, _>>()
            .map_err(refused)?;
        let schema = Type::group_type_builder("recording")
            .with_fields(fields)
            .build()
            .map_err(refused)?;
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
            .set_key_value_metadata(Some(key_values(layout)))
            .build();
        let (draft, file) = Draft::create(path)?;
        let writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
            .map_err(refused)?;
        Ok(Self {
            path: path.to_owned(),
            draft,
            writer,
            pending: vec![Vec::new(); layout.channels.len()],
        })
    }

    fn write_group(&mut self) -> std::result::Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.pending {
            let Some(mut writer) = group.next_column()? else {
                break;
            };
            writer
                .typed::<DoubleType>()
                .write_batch(column, None, None)?;
            writer.close()?;
            column.clear();
        }
        group.close()?;
        Ok(())
    }

    fn rows_pending(&self) -> usize {
        self.pending.first().map_or(0, Vec::len)
    }
}

/// The channel's heading; a name without a unit that looks as if it had one is marked as such.
fn heading(channel: &Channel) -> String {
    let heading = channel.heading();
    if Channel::from_heading(&heading).name == channel.name {
        heading
    } else {
        format!("{} []", channel.name)
    }
}

fn io_error(path: &Path, error: ParquetError) -> Error {
    let source = match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(source) => *source,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    };
    Error::io(path, source)
}

/// Properties, rates and offsets. What all channels have in common stands once, the rest per channel.
fn key_values(layout: &Layout) -> Vec<KeyValue> {
    let mut pairs: Vec<_> = layout
        .properties
        .iter()
        .filter(|(key, _)| !matches!(key.as_str(), LEFT_OUT | RATE_KEY | OFFSET_KEY))
        .map(|(key, value)| KeyValue::new(key.clone(), value.clone()))
        .collect();
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

impl Sink for ParquetSink {
    fn write(&mut self, block: &Block) -> Result<()> {
        let rows = block.rows();
        if block.columns.len() != self.pending.len()
            || block.columns.iter().any(|column| column.len() != rows)
        {
            return Err(Error::io(
                &self.path,
                io::Error::new(
                    io::ErrorKind::InvalidInput,
                    "a block of other columns than the layout has channels, or of unequal ones",
                ),
            ));
        }
        let mut from = 0;
        while from < rows {
            let to = rows.min(from + GROUP_ROWS - self.rows_pending());
            for (pending, column) in self.pending.iter_mut().zip(&block.columns) {
                pending.extend_from_slice(column.get(from..to).unwrap_or_default());
            }
            if self.rows_pending() >= GROUP_ROWS {
                self.write_group()
                    .map_err(|error| io_error(&self.path, error))?;
            }
            from = to;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let path = self.path.clone();
        let refused = |error| io_error(&path, error);
        if self.rows_pending() > 0 {
            self.write_group().map_err(refused)?;
        }
        let file = self.writer.into_inner().map_err(refused)?;
        self.draft.keep(&file)
    }
}
