//! Properties and time stamps.

use std::collections::BTreeMap;
use std::fmt;

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
const SECONDS_PER_DAY: i64 = 86_400;
/// Days from 0000-03-01, where the calendar's leap days come at the end of the year, to 1904-01-01.
const EPOCH_DAY: i64 = 695_361;

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
        let (date, time) = text.strip_suffix('Z')?.split_once('T')?;
        let mut date = date.rsplitn(3, '-').map(str::parse::<i64>);
        let mut time = time.splitn(3, ':');
        let (day, month, year) = (date.next()?.ok()?, date.next()?.ok()?, date.next()?.ok()?);
        let hour: i64 = time.next()?.parse().ok()?;
        let minute: i64 = time.next()?.parse().ok()?;
        let (second, fraction) = time.next()?.split_once('.')?;
        let second: i64 = second.parse().ok()?;
        let valid = (1..=12).contains(&month)
            && (1..=31).contains(&day)
            && (0..=999_999).contains(&year)
            && (0..24).contains(&hour)
            && (0..60).contains(&minute)
            && (0..60).contains(&second)
            && fraction.len() == 9;
        if !valid {
            return None;
        }
        let nanoseconds: u32 = fraction.parse().ok()?;
        let year = if month <= 2 { year - 1 } else { year };
        let month = (month + 9) % 12;
        let days = year * 365 + year.div_euclid(4) - year.div_euclid(100)
            + year.div_euclid(400)
            + (153 * month + 2) / 5
            + day
            - 1
            - EPOCH_DAY;
        let seconds = days * SECONDS_PER_DAY + hour * 3600 + minute * 60 + second;
        // Rounded up, so that cutting it to nanoseconds gives the same again.
        let units = ((u128::from(nanoseconds) << 64).div_ceil(1_000_000_000)) as i128;
        Some(Self((i128::from(seconds) << 64) + units))
    }
}

impl fmt::Display for Timestamp {
    /// ISO 8601 in UTC, cut to nanoseconds.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = (self.0 >> 64) as i64;
        let fraction = self.0 as u64;
        let nanoseconds = (u128::from(fraction) * 1_000_000_000) >> 64;
        let day = seconds.div_euclid(SECONDS_PER_DAY) + EPOCH_DAY;
        let second = seconds.rem_euclid(SECONDS_PER_DAY);
        // Years that begin in March, in eras of 400 years.
        let era = day.div_euclid(146_097);
        let day_of_era = day.rem_euclid(146_097);
        let year_of_era =
            (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
        let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let month = (5 * day_of_year + 2) / 153;
        let day_of_month = day_of_year - (153 * month + 2) / 5 + 1;
        let (month, carry) = if month < 10 {
            (month + 3, 0)
        } else {
            (month - 9, 1)
        };
        let year = year_of_era + era * 400 + carry;
        write!(
            f,
            "{year:04}-{month:02}-{day_of_month:02}T{:02}:{:02}:{:02}.{nanoseconds:09}Z",
            second / 3600,
            second / 60 % 60,
            second % 60
        )
    }
}
