//! Writing.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
use sixaxis_recordings::draft::Draft;

use super::{
    CHECKSUM_KEY, COUNT_KEY, FIRST_SEED_KEY, FORMAT, FORMAT_KEY, PART_KEY, PLAN_KEY, Provenance,
    SEED, VERSION_KEY, checksum, columns, file_name, numbers,
};
use crate::error::Result;
use crate::row::{Row, Text};

/// Writes consecutive cases into a folder as one part, whole or not at all: under another name first, flushed, renamed. The same
/// rows give the same bytes.
///
/// # Errors
/// [`crate::Error::File`].
pub fn write(folder: &Path, provenance: &Provenance, rows: &[Row]) -> Result<PathBuf> {
    let first = rows.first().map_or(0, |row| row.seed);
    let path = folder.join(file_name(&(first..first + rows.len() as u64)));
    let (draft, file) = Draft::create(&path)?;
    let file = filled(file, provenance, rows).map_err(|error| {
        let source = match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(source) => *source,
                Err(other) => io::Error::other(other),
            },
            other => io::Error::other(other),
        };
        sixaxis_recordings::Error::io(&path, source)
    })?;
    draft.keep(&file)?;
    Ok(path)
}

fn filled(
    file: File,
    provenance: &Provenance,
    rows: &[Row],
) -> std::result::Result<File, ParquetError> {
    let mut writer = SerializedFileWriter::new(
        file,
        Arc::new(schema()?),
        Arc::new(properties(provenance, rows)),
    )?;
    let mut group = writer.next_row_group()?;
    if let Some(mut column) = group.next_column()? {
        // At most 2^63 - 1: [`crate::plan::LARGEST_SEED`].
        let seeds: Vec<i64> = rows.iter().map(|row| row.seed as i64).collect();
        column
            .typed::<Int64Type>()
            .write_batch(&seeds, None, None)?;
        column.close()?;
    }
    for text in Text::ALL {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        let (levels, values) = sparse(rows.iter().map(|row| {
            row.text(text)
                .map(|text| ByteArray::from(Bytes::copy_from_slice(text.as_bytes())))
        }));
        column
            .typed::<ByteArrayType>()
            .write_batch(&values, Some(&levels), None)?;
        column.close()?;
    }
    // Row by row into columns.
    let mut series = vec![Vec::with_capacity(rows.len()); columns().1.len()];
    for row in rows {
        for (column, value) in series.iter_mut().zip(numbers(row)) {
            column.push(value);
        }
    }
    for values in series {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        let (levels, values) = sparse(values.into_iter());
        column
            .typed::<DoubleType>()
            .write_batch(&values, Some(&levels), None)?;
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}

/// Which are there, and those that are.
fn sparse<T>(values: impl Iterator<Item = Option<T>>) -> (Vec<i16>, Vec<T>) {
    let mut levels = Vec::new();
    let mut there = Vec::new();
    for value in values {
        levels.push(i16::from(value.is_some()));
        there.extend(value);
    }
    (levels, there)
}

fn schema() -> std::result::Result<Type, ParquetError> {
    let (texts, numbers) = columns();
    let seed = Type::primitive_type_builder(SEED, Physical::INT64)
        .with_repetition(Repetition::REQUIRED)
        .build();
    let texts = texts.iter().map(|name| {
        Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
            .with_logical_type(Some(LogicalType::String))
            .with_repetition(Repetition::OPTIONAL)
            .build()
    });
    let numbers = numbers.iter().map(|name| {
        Type::primitive_type_builder(name, Physical::DOUBLE)
            .with_repetition(Repetition::OPTIONAL)
            .build()
    });
    let fields = std::iter::once(seed)
        .chain(texts)
        .chain(numbers)
        .map(|field| field.map(Arc::new))
        .collect::<std::result::Result<Vec<_>, _>>()?;
    Type::group_type_builder("cases")
        .with_fields(fields)
        .build()
}

fn properties(provenance: &Provenance, rows: &[Row]) -> WriterProperties {
    let first = rows.first().map_or(0, |row| row.seed);
    let asked = &provenance.asked;
    let pairs = [
        (FORMAT_KEY, FORMAT.to_owned()),
        (VERSION_KEY, provenance.version.clone()),
        (PLAN_KEY, provenance.plan.clone()),
        (FIRST_SEED_KEY, asked.start.to_string()),
        (COUNT_KEY, (asked.end - asked.start).to_string()),
        (
            PART_KEY,
            format!("{} cases from seed {first} on", rows.len()),
        ),
        (CHECKSUM_KEY, format!("{:016x}", checksum(rows))),
    ];
    WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        // A query for some seeds need not open the others.
        .set_column_statistics_enabled(ColumnPath::from(SEED), EnabledStatistics::Chunk)
        .set_encoding(Encoding::PLAIN)
        .set_created_by(concat!("sixaxis-campaign version ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(
            pairs
                .into_iter()
                .map(|(key, value)| KeyValue::new(key.to_owned(), value))
                .collect(),
        ))
        .build()
}
