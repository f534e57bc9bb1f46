//! Times of a calendar in cells: ISO 8601 (`2024-05-31T14:03:07.25+02:00`, a blank for the `T`) and `31.05.2024 14:03:07,25`.
//!
//! `05/31/2024` is not read: half of the world takes it for the day first.

use chrono::NaiveDate;

/// Nanoseconds of a second and of a day.
const SECOND: i128 = 1_000_000_000;
const DAY: i128 = 86_400 * SECOND;

/// How a column of time stamps is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamps {
    /// Date and time in one cell.
    Whole,
    /// The time of day; the date, if the file has any, is in the cell of this number.
    TimeOfDay(Option<usize>),
}

impl Stamps {
    /// The time in a cell, ns since 1970 or since midnight; `cell` gives the text of a cell of the same row.
    pub fn read<'a>(self, own: &[u8], cell: impl Fn(usize) -> &'a [u8]) -> Option<i128> {
        match self {
            Self::Whole => whole(own),
            Self::TimeOfDay(None) => time_of_day(own),
            Self::TimeOfDay(Some(at)) => Some(date(cell(at))? + time_of_day(own)?),
        }
    }
}

/// Date and time, ns since 1970, or a time of day, ns since midnight, as text columns have them.
#[must_use]
pub fn calendar_ns(cell: &str) -> Option<i128> {
    whole(cell.as_bytes()).or_else(|| time_of_day(cell.as_bytes()))
}

/// Seconds from one time to another.
pub fn seconds(from: i128, to: i128) -> f64 {
    (to - from) as f64 / SECOND as f64
}

/// Date and time, ns since 1970: universal time where the cell has an offset from it, the cell's own where not.
pub fn whole(cell: &[u8]) -> Option<i128> {
    let (day, rest) = cell.split_at_checked(10)?;
    let time = rest.strip_prefix(b"T").or(rest.strip_prefix(b" "))?;
    Some(date(day)? + time_of_day(time.trim_ascii_start())?)
}

/// A date, ns since 1970.
pub fn date(cell: &[u8]) -> Option<i128> {
    let (year, month, day) = match cell {
        [y1, y2, y3, y4, b'-', m1, m2, b'-', d1, d2] => {
            ([*y1, *y2, *y3, *y4], [*m1, *m2], [*d1, *d2])
        }
        [d1, d2, b'.', m1, m2, b'.', y1, y2, y3, y4] => {
            ([*y1, *y2, *y3, *y4], [*m1, *m2], [*d1, *d2])
        }
        _ => return None,
    };
    let year = i32::try_from(digits(&year)?).ok()?;
    let (month, day) = (digits(&month)?, digits(&day)?);
    let date = NaiveDate::from_ymd_opt(year, u32::try_from(month).ok()?, u32::try_from(day).ok()?)?;
    let since = date.signed_duration_since(NaiveDate::default());
    Some(i128::from(since.num_days()) * DAY)
}

/// `14:03`, `14:03:07`, `14:03:07.25` or with a comma, ns since midnight, less an offset behind it (`Z`, `+02:00`, `+0200`, `+02`).
pub fn time_of_day(cell: &[u8]) -> Option<i128> {
    let at = cell.iter().position(|b| matches!(b, b'Z' | b'+' | b'-'));
    let (time, zone) = cell.split_at(at.unwrap_or(cell.len()));
    let mut parts = time.split(|byte| *byte == b':');
    let hour = of_two(parts.next()?, 24)?;
    let minute = of_two(parts.next()?, 60)?;
    let (second, fraction) = match parts.next() {
        None => (0, 0),
        Some(part) => {
            let (whole, fraction) = part.split_at_checked(2)?;
            (of_two(whole, 60)?, nanoseconds(fraction)?)
        }
    };
    if parts.next().is_some() {
        return None;
    }
    let offset_minutes = match zone {
        [] | [b'Z'] => 0,
        [sign, h1, h2, rest @ ..] => {
            let rest = rest.strip_prefix(b":").unwrap_or(rest);
            let minutes = if rest.is_empty() {
                0
            } else {
                of_two(rest, 60)?
            };
            let offset = 60 * of_two(&[*h1, *h2], 24)? + minutes;
            if *sign == b'-' { -offset } else { offset }
        }
        _ => return None,
    };
    Some(((hour * 60 + minute - offset_minutes) * 60 + second) * SECOND + fraction)
}

/// `.25` or `,25` in ns; more than nine digits are cut. Nothing is none.
fn nanoseconds(fraction: &[u8]) -> Option<i128> {
    let digits_of = match fraction {
        [] => return Some(0),
        [b'.' | b',', digits @ ..] if !digits.is_empty() => digits,
        _ => return None,
    };
    digits(digits_of.get(9..).unwrap_or_default())?;
    let kept = digits_of.get(..9).unwrap_or(digits_of);
    let missing = u32::try_from(9 - kept.len()).ok()?;
    Some(digits(kept)? * 10_i128.pow(missing))
}

fn of_two(text: &[u8], below: i128) -> Option<i128> {
    digits(text).filter(|number| text.len() == 2 && *number < below)
}

/// A number of nothing but digits; none of them is 0. Short enough not to overflow, or none.
fn digits(text: &[u8]) -> Option<i128> {
    let mut number = 0_i128;
    for byte in text {
        let digit = byte.is_ascii_digit().then(|| i128::from(byte - b'0'))?;
        number = number.checked_mul(10)?.checked_add(digit)?;
    }
    Some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_moment() {
        let moment = 1_717_156_987_250_000_000;
        for text in [
            "2024-05-31T12:03:07.25Z",
            "2024-05-31 12:03:07.250",
            "2024-05-31T14:03:07,25+02:00",
            "2024-05-31T14:03:07.25+0200",
            "2024-05-31T07:03:07.2500000009-05",
            "31.05.2024 12:03:07,25",
        ] {
            assert_eq!(whole(text.as_bytes()), Some(moment), "{text}");
        }
        assert_eq!(time_of_day(b"00:01"), Some(60 * SECOND));
        assert_eq!(date(b"29.02.2024"), Some(19_782 * DAY));
    }

    #[test]
    fn what_is_no_time() {
        for text in [
            "2024-05-31",
            "2023-02-29 00:00:00",
            "2024-05-31T24:00:00",
            "2024-05-31T12:60:00",
            "2024-05-31T12:03:07.",
            "2024-05-31T12:03:07.x",
            "2024-05-31T12:03:07+2",
            "2024-05-31T12:03:07:00",
            "05/31/2024 12:03:07",
            "31.5.2024 12:03:07",
            "2024-05-31T1:03:07",
            "1.5",
            "",
            "\u{e9}024-05-31T12:03:07",
        ] {
            assert_eq!(whole(text.as_bytes()), None, "{text}");
        }
        assert_eq!(date(b"99999999999999999999"), None);
    }
}
