//! Reading, every value and the checksum over them.

use std::path::Path;

use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::file::metadata::KeyValue;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use sixaxis_recordings::unwinding::caught;
use sixaxis_recordings::whole::read_bytes;

use super::{
    CHECKSUM_KEY, COUNT_KEY, FIRST_SEED_KEY, FORMAT, FORMAT_KEY, PLAN_KEY, Provenance, SEED,
    VERSION_KEY, checksum, columns, seeds_of,
};
use crate::error::{Error, Result};
use crate::row::{Group, Row, Scalar};
use sixaxis_core::parameter::PARAMETERS;

/// A part as it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Where its cases come from.
    pub provenance: Provenance,
    /// Its cases, seeds ascending without a gap.
    pub rows: Vec<Row>,
}

/// Why a part cannot be used, in words.
type Refused<T> = std::result::Result<T, String>;

/// Bytes of a part at most: one of 64 cases has 100 kB.
const MOST: u64 = 1 << 30;

/// Reads a part.
///
/// # Errors
/// [`Error::File`] if it cannot be opened; [`Error::Damaged`] for anything but what [`super::write`] wrote under this name.
pub fn read(path: &Path) -> Result<Part> {
    let bytes = read_bytes(path, MOST)?;
    // The library panics on some hostile files.
    caught(|| parse(Bytes::from(bytes)))
        .unwrap_or_else(|| Err("the Parquet library gave up on it".to_owned()))
        .and_then(|part| {
            let seeds = part.rows.iter().map(|row| row.seed);
            match seeds_of(path) {
                Some(named) if !seeds.eq(named.clone()) => {
                    Err("its cases are not those of its name".to_owned())
                }
                _ => Ok(part),
            }
        })
        .map_err(|cause| Error::Damaged {
            path: path.to_owned(),
            cause,
        })
}

fn words(error: impl core::fmt::Display) -> String {
    error.to_string()
}

fn parse(bytes: Bytes) -> Refused<Part> {
    let reader = SerializedFileReader::new(bytes).map_err(words)?;
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().map_or(&[][..], Vec::as_slice);
    if value(pairs, FORMAT_KEY)? != FORMAT {
        return Err(format!("not a part of format {FORMAT}"));
    }
    let (texts, numbers) = columns();
    let expected = std::iter::once(SEED)
        .chain(texts.iter().map(String::as_str))
        .chain(numbers.iter().map(String::as_str));
    if !metadata
        .schema_descr()
        .columns()
        .iter()
        .map(|column| column.name())
        .eq(expected)
    {
        return Err("its columns are not those of a part".to_owned());
    }
    let first: u64 = value(pairs, FIRST_SEED_KEY)?.parse().map_err(words)?;
    let count: u64 = value(pairs, COUNT_KEY)?.parse().map_err(words)?;
    let provenance = Provenance {
        version: value(pairs, VERSION_KEY)?.to_owned(),
        plan: value(pairs, PLAN_KEY)?.to_owned(),
        asked: first
            ..first
                .checked_add(count)
                .ok_or("its campaign has too many seeds")?,
    };
    let mut rows = Vec::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(words)?;
        rows.extend(rows_of(group.as_ref(), texts.len())?);
    }
    let expected = u64::from_str_radix(value(pairs, CHECKSUM_KEY)?, 16).map_err(words)?;
    if checksum(&rows) != expected {
        return Err("damaged: its values do not have its checksum".to_owned());
    }
    Ok(Part { provenance, rows })
}

fn value<'a>(pairs: &'a [KeyValue], key: &str) -> Refused<&'a str> {
    pairs
        .iter()
        .find(|pair| pair.key == key)
        .and_then(|pair| pair.value.as_deref())
        .ok_or_else(|| format!("it has no {key} in its metadata"))
}

fn rows_of(group: &dyn RowGroupReader, texts: usize) -> Refused<Vec<Row>> {
    let count = usize::try_from(group.metadata().num_rows()).map_err(words)?;
    let strange = || "a column is not of its type".to_owned();
    let ColumnReader::Int64ColumnReader(reader) = group.get_column_reader(0).map_err(words)? else {
        return Err(strange());
    };
    let mut rows = all(reader, count)?
        .into_iter()
        .map(|seed| {
            let seed = seed.ok_or_else(strange)?;
            Ok(Row::blank(u64::try_from(seed).map_err(words)?))
        })
        .collect::<Refused<Vec<Row>>>()?;
    for text in 0..texts {
        let ColumnReader::ByteArrayColumnReader(reader) =
            group.get_column_reader(1 + text).map_err(words)?
        else {
            return Err(strange());
        };
        for (row, value) in rows.iter_mut().zip(all(reader, count)?) {
            row.texts[text] = value
                .map(|bytes| String::from_utf8(bytes.data().to_vec()).map_err(words))
                .transpose()?;
        }
    }
    for number in 0..Scalar::ALL.len() + Group::ALL.len() * PARAMETERS {
        let ColumnReader::DoubleColumnReader(reader) =
            group.get_column_reader(1 + texts + number).map_err(words)?
        else {
            return Err(strange());
        };
        for (row, value) in rows.iter_mut().zip(all(reader, count)?) {
            match number.checked_sub(Scalar::ALL.len()) {
                None => row.scalars[number] = value,
                Some(i) => row.groups[i / PARAMETERS][i % PARAMETERS] = value,
            }
        }
    }
    Ok(rows)
}

/// A whole column, nulls as none.
fn all<T: DataType>(mut reader: ColumnReaderImpl<T>, rows: usize) -> Refused<Vec<Option<T::T>>> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (more, _, _) = reader
            .read_records(rows - read, Some(&mut levels), None, &mut values)
            .map_err(words)?;
        if more == 0 {
            return Err("a column ends early".to_owned());
        }
        read += more;
    }
    if levels.is_empty() {
        return Ok(values.into_iter().map(Some).collect());
    }
    let mut values = values.into_iter();
    Ok(levels
        .into_iter()
        .map(|level| (level > 0).then(|| values.next()).flatten())
        .collect())
}
