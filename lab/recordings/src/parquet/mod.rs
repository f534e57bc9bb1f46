//! Parquet files, as pandas, Polars and DuckDB write them.
//!
//! A flat numeric column is a channel; its name may carry the unit, `u1 [mV]`, or Arrow's metadata of the field under `unit`.
//! Columns that this crate writes are called `u1_mV`, `ax_m_s2`; the key `heading:NAME` holds `u1 [mV]`. A column in which a sample is missing (null,
//! which is also what pandas makes of NaN) is refused where it is read: a recording has no holes. Time stamps become seconds
//! since the column's first sample, durations and times of day seconds. Integers beyond 2^53 are rounded to the nearest f64. Text, dates, decimals and nested
//! columns are no channels; the property [`LEFT_OUT`] names them.
//!
//! The file's key-value metadata become its properties. The key `sample_rate_hz` is the rate of all channels,
//! `sample_rate_hz:NAME` that of one; likewise `start_offset_s`. Files of this crate carry them so.
//!
//! Memory: one page and its dictionary per selected channel, besides the block.
//!
//! | file | holds |
//! |---|---|
//! | `column` | what the schema says of a column, and its numbers as f64 |
//! | `arrow` | durations and units, where Arrow wrote the file |
//! | `pages` | pages from the file, sizes checked, zstd |
//! | `source`, `sink` | reading and writing |

mod arrow;
mod column;
mod pages;
mod sink;
mod source;

pub use crate::layout::LEFT_OUT;
pub(crate) use sink::create;
pub(crate) use source::open;

/// Samples per second, of the file or of one column.
const RATE_KEY: &str = "sample_rate_hz";
/// Name and unit of one column's channel, `ax [m/s^2]`.
const HEADING_KEY: &str = "heading";
/// Time of the first sample, s.
const OFFSET_KEY: &str = "start_offset_s";
