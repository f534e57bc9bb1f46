//! Properties and time stamps.

use std::collections::BTreeMap;
use std::fmt;

use chrono::{DateTime, NaiveDateTime};

use super::cursor::Cursor;
use super::kind::Kind;
use crate::error::{Error, Result};
use crate::numbers::{self, Number};

/// Properties of one object.
pub type Properties = BTreeMap<String, Value>;

/// A property's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Integer(i128),
    Real(f64),
    Bool(bool),
    Text(String),
    Time(Timestamp),
}

impl Value {
    /// Reads the type's code and the value.
    pub fn read(cursor: &mut Cursor) -> Result<Self> {
        let code = cursor.u32()?;
        let big_endian = cursor.big_endian;
        Ok(match Kind::from_code(code) {
            Some(Kind::Number(kind)) => {
                let number = Number { kind, big_endian };
                let bytes = cursor.bytes(kind.size() as u64)?;
                match (kind, number.integer(&bytes)) {
                    (_, Some(integer)) => Self::Integer(integer),
                    (numbers::Kind::Bool, _) => Self::Bool(bytes != [0]),
                    _ => {
                        let mut real = Vec::with_capacity(1);
                        number.append(&bytes, bytes.len(), 1, &mut real);
                        Self::Real(real.first().copied().unwrap_or(f64::NAN))
                    }
                }
            }
            Some(Kind::Text) => Self::Text(cursor.text()?),
            Some(Kind::Time) => Self::Time(Timestamp::from_bytes(cursor.array()?, big_endian)),
            Some(Kind::Complex32 | Kind::Complex64 | Kind::Void | Kind::Line(_)) | None => {
                return Err(Error::unsupported(
                    cursor.path(),
                    format!("a property of TDMS data type 0x{code:X}"),
                    "remove the property, or write it as a number or a text",
                ));
            }
        })
    }

    /// As a number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(value) => Some(*value as f64),
            Self::Real(value) => Some(*value),
            _ => None,
        }
    }

    /// As a whole number, if it is one.
    pub fn whole(&self) -> Option<u64> {
        match self {
            Self::Integer(value) => u64::try_from(*value).ok(),
            _ => None,
        }
    }

    /// As a text, if it is one.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(value) => Some(value),
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Text(value) => write!(f, "{value}"),
            Self::Time(value) => write!(f, "{value}"),
        }
    }
}

/// Time since 1904-01-01 00:00:00 UTC without leap seconds, in units of 2^-64 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Timestamp(pub i128);

/// 2^64, units in a second.
const UNITS_PER_SECOND: f64 = 18_446_744_073_709_551_616.0;
/// From 1904-01-01 to the epoch of Unix, s.
const UNIX_S: i64 = 2_082_844_800;
/// ISO 8601 in UTC.
const FORM: &str = "%Y-%m-%dT%H:%M:%S%.9fZ";

impl Timestamp {
    pub fn from_bytes(bytes: [u8; 16], big_endian: bool) -> Self {
        Self(if big_endian {
            i128::from_be_bytes(bytes)
        } else {
            i128::from_le_bytes(bytes)
        })
    }

    /// Seconds from another time to this one, correctly rounded.
    pub fn seconds_since(self, other: Self) -> f64 {
        match self.0.checked_sub(other.0) {
            Some(difference) => difference as f64 / UNITS_PER_SECOND,
            None => self.0 as f64 / UNITS_PER_SECOND - other.0 as f64 / UNITS_PER_SECOND,
        }
    }

    /// From what [`fmt::Display`] writes.
    pub fn parse(text: &str) -> Option<Self> {
        let time = NaiveDateTime::parse_from_str(text, FORM).ok()?.and_utc();
        let nanoseconds = u128::from(time.timestamp_subsec_nanos());
        // Rounded up, so that cutting it to nanoseconds gives the same again.
        let units = (nanoseconds << 64).div_ceil(1_000_000_000) as i128;
        Some(Self((i128::from(time.timestamp() + UNIX_S) << 64) + units))
    }
}

impl fmt::Display for Timestamp {
    /// ISO 8601 in UTC, cut to nanoseconds; seconds since 1904 for a year that no calendar has.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = (self.0 >> 64) as i64;
        let nanoseconds = (u128::from(self.0 as u64) * 1_000_000_000) >> 64;
        let since_unix = seconds.checked_sub(UNIX_S);
        match since_unix.and_then(|s| DateTime::from_timestamp(s, nanoseconds as u32)) {
            Some(time) => write!(f, "{}", time.format(FORM)),
            None => write!(f, "{seconds} s after 1904-01-01"),
        }
    }
}
