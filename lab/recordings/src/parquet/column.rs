//! What the schema says of a column, and its numbers as f64.

use ::parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::schema::types::ColumnDescriptor;

/// How the stored numbers are to be understood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    /// As they are.
    Plain,
    /// The bits are those of an unsigned integer.
    Unsigned,
    /// IEEE binary16 in two bytes.
    Half,
    /// Points in time since 1970, so many per second, by universal time or by the clock on a wall.
    Stamp { per_second: f64, universal: bool },
    /// Durations or times of day, so many per second.
    Span(f64),
}

impl Meaning {
    /// The unit that follows from it.
    pub(super) fn unit(self) -> Option<&'static str> {
        matches!(self, Self::Stamp { .. } | Self::Span(_)).then_some("s")
    }
}

fn per_second(unit: &TimeUnit) -> f64 {
    match unit {
        TimeUnit::MILLIS => 1e3,
        TimeUnit::MICROS => 1e6,
        TimeUnit::NANOS => 1e9,
    }
}

/// How a column's numbers are to be understood, or else what it is called that is not understood.
pub(super) fn meaning(column: &ColumnDescriptor) -> Result<Meaning, String> {
    if column.max_rep_level() > 0 || column.path().parts().len() != 1 {
        return Err("nested".to_owned());
    }
    let physical = column.physical_type();
    let strange = |what: &dyn std::fmt::Debug| Err(format!("{what:?}"));
    if let Some(logical) = column.logical_type_ref() {
        return match (logical, physical) {
            (LogicalType::Integer(kind), Type::INT32 | Type::INT64) => Ok(if kind.is_signed {
                Meaning::Plain
            } else {
                Meaning::Unsigned
            }),
            (LogicalType::Timestamp(kind), Type::INT64) => Ok(Meaning::Stamp {
                per_second: per_second(&kind.unit),
                universal: kind.is_adjusted_to_u_t_c,
            }),
            (LogicalType::Time(kind), Type::INT32 | Type::INT64) => {
                Ok(Meaning::Span(per_second(&kind.unit)))
            }
            (LogicalType::Float16, Type::FIXED_LEN_BYTE_ARRAY) if column.type_length() == 2 => {
                Ok(Meaning::Half)
            }
            _ => strange(logical),
        };
    }
    let stamp = |per_second, universal| Meaning::Stamp {
        per_second,
        universal,
    };
    match (column.converted_type(), physical) {
        (
            ConvertedType::NONE,
            Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE,
        )
        | (ConvertedType::INT_8 | ConvertedType::INT_16 | ConvertedType::INT_32, Type::INT32)
        | (ConvertedType::INT_64, Type::INT64) => Ok(Meaning::Plain),
        (ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32, Type::INT32)
        | (ConvertedType::UINT_64, Type::INT64) => Ok(Meaning::Unsigned),
        (ConvertedType::TIMESTAMP_MILLIS, Type::INT64) => Ok(stamp(1e3, true)),
        (ConvertedType::TIMESTAMP_MICROS, Type::INT64) => Ok(stamp(1e6, true)),
        (ConvertedType::TIME_MILLIS, Type::INT32) => Ok(Meaning::Span(1e3)),
        (ConvertedType::TIME_MICROS, Type::INT64) => Ok(Meaning::Span(1e6)),
        // Twelve bytes, only ever used for time stamps in nanoseconds.
        (ConvertedType::NONE, Type::INT96) => Ok(stamp(1e9, false)),
        (ConvertedType::NONE, _) => strange(&physical),
        (converted, _) => strange(&converted),
    }
}

/// What went wrong when a column was read.
#[derive(Debug)]
pub(super) enum Trouble {
    /// This sample of those asked for is null.
    Null(usize),
    /// The library says no.
    Library(ParquetError),
}

impl From<ParquetError> for Trouble {
    fn from(error: ParquetError) -> Self {
        Self::Library(error)
    }
}

/// Appends the next `rows` samples of a column to `out`. `first` is the column's first time stamp, set when it is met.
/// Returns how many there were.
pub(super) fn append(
    reader: &mut ColumnReader,
    meaning: Meaning,
    first: &mut Option<i64>,
    rows: usize,
    out: &mut Vec<f64>,
) -> Result<usize, Trouble> {
    let since = |first: &mut Option<i64>, stamp: i64, per_second: f64| {
        let start = *first.get_or_insert(stamp);
        // The difference of two i64 fits an i128, and its rounding to f64 is the only one besides the division's.
        (i128::from(stamp) - i128::from(start)) as f64 / per_second
    };
    match reader {
        ColumnReader::DoubleColumnReader(reader) => pull(reader, rows, out),
        ColumnReader::FloatColumnReader(reader) => convert(reader, rows, out, |v| f64::from(*v)),
        ColumnReader::BoolColumnReader(reader) => {
            convert(reader, rows, out, |v| f64::from(u8::from(*v)))
        }
        ColumnReader::Int32ColumnReader(reader) => match meaning {
            Meaning::Unsigned => convert(reader, rows, out, |v| {
                f64::from(u32::from_ne_bytes(v.to_ne_bytes()))
            }),
            Meaning::Span(rate) => convert(reader, rows, out, |v| f64::from(*v) / rate),
            _ => convert(reader, rows, out, |v| f64::from(*v)),
        },
        ColumnReader::Int64ColumnReader(reader) => match meaning {
            Meaning::Unsigned => convert(reader, rows, out, |v| {
                u64::from_ne_bytes(v.to_ne_bytes()) as f64
            }),
            Meaning::Span(rate) => convert(reader, rows, out, |v| *v as f64 / rate),
            Meaning::Stamp { per_second, .. } => {
                convert(reader, rows, out, |v| since(first, *v, per_second))
            }
            _ => convert(reader, rows, out, |v| *v as f64),
        },
        ColumnReader::Int96ColumnReader(reader) => {
            convert(reader, rows, out, |v| since(first, v.to_nanos(), 1e9))
        }
        ColumnReader::FixedLenByteArrayColumnReader(reader) => {
            convert(reader, rows, out, |v| match *v.data() {
                [low, high] => half::f16::from_le_bytes([low, high]).to_f64(),
                _ => f64::NAN,
            })
        }
        ColumnReader::ByteArrayColumnReader(_) => {
            Err(ParquetError::General("a column of texts".to_owned()).into())
        }
    }
}

fn convert<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    out: &mut Vec<f64>,
    number: impl FnMut(&T::T) -> f64,
) -> Result<usize, Trouble> {
    let mut values = Vec::new();
    let read = pull(reader, rows, &mut values)?;
    out.extend(values.iter().map(number));
    Ok(read)
}

fn pull<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    values: &mut Vec<T::T>,
) -> Result<usize, Trouble> {
    let mut levels = Vec::new();
    let (_, present, levels_read) = reader.read_records(rows, Some(&mut levels), None, values)?;
    if present != levels_read {
        // A flat column has levels 0 (null) and 1.
        return Err(Trouble::Null(
            levels.iter().position(|&level| level == 0).unwrap_or(0),
        ));
    }
    Ok(present)
}
