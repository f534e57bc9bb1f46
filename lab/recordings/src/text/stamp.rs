//! Times of a calendar in cells: ISO 8601 (`2024-05-31T14:03:07.25+02:00`, a blank for the `T`, slashes for the dashes) and
//! `31.05.2024 14:03:07,25`; times of day and times since a start (`14:03:07.25`, `03:07.25`, `25:00:00`, `1 days 01:00:00`).
//!
//! `05/31/2024` is not read: half of the world takes it for the day first.

use chrono::NaiveDate;

/// Nanoseconds of a second and of a day.
const SECOND: i128 = 1_000_000_000;
const DAY: i128 = 86_400 * SECOND;
/// So much earlier than the first row's, a time of day without a date is the next day's.
const NEXT_DAY: i128 = 3_600 * SECOND;

/// The forms that are read, in words.
pub const FORMS: &str =
    "times are read as 2024-05-31T14:03:07.25, 31.05.2024 14:03:07,25, 14:03:07.25 or seconds";

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

    /// Seconds from the first row's time to another one's.
    pub fn seconds_since(self, first: i128, now: i128) -> f64 {
        match self {
            Self::TimeOfDay(None) if now < first - NEXT_DAY => seconds(first, now + DAY),
            _ => seconds(first, now),
        }
    }
}

/// Date and time, ns since 1970, or a time of day, ns since midnight, as text columns have them.
pub fn calendar_ns(cell: &str) -> Option<i128> {
    whole(cell.as_bytes()).or_else(|| time_of_day(cell.as_bytes()))
}

/// Seconds from one time to another.
pub fn seconds(from: i128, to: i128) -> f64 {
    (to - from) as f64 / SECOND as f64
}

/// Date and time, ns since 1970: universal time where the cell has an offset from it, the cell's own where not.
pub fn whole(cell: &[u8]) -> Option<i128> {
    let at = cell.iter().position(|byte| matches!(byte, b'T' | b' '))?;
    let (day, time) = cell.split_at(at);
    let time = clock(time.get(1..)?.trim_ascii_start(), 24)?;
    Some(date(day)? + time)
}

/// Whether date and time say how far they are from universal time.
pub fn is_universal(cell: &[u8]) -> bool {
    let time = cell.iter().position(|byte| *byte == b':');
    let time = time.and_then(|at| cell.get(at..)).unwrap_or_default();
    time.iter().any(|byte| matches!(byte, b'Z' | b'+' | b'-'))
}

/// A date, ns since 1970.
pub fn date(cell: &[u8]) -> Option<i128> {
    let separator = *cell.iter().find(|byte| !byte.is_ascii_digit())?;
    let mut parts = cell.split(|byte| *byte == separator);
    let (a, b, c) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() {
        return None;
    }
    let (year, month, day) = match separator {
        b'-' | b'/' if b.len() == 2 && c.len() == 2 => (a, b, c),
        b'.' => (c, b, a),
        _ => return None,
    };
    let year = i32::try_from(digits(year).filter(|_| year.len() == 4)?).ok()?;
    let (month, day) = (of_two(month, 13)?, of_two(day, 32)?);
    let date = NaiveDate::from_ymd_opt(year, u32::try_from(month).ok()?, u32::try_from(day).ok()?)?;
    let since = date.signed_duration_since(NaiveDate::default());
    Some(i128::from(since.num_days()) * DAY)
}

/// `14:03`, `14:03:07`, `14:03:07.25` or with a comma, or `03:07.25` without hours, ns since midnight or since a start, less an offset
/// behind it (`Z`, `+02:00`, `+0200`, `+02`); of a time since a start there may be days before it, `1 days 01:00:00`, and more hours than a
/// day has.
pub fn time_of_day(cell: &[u8]) -> Option<i128> {
    let Some(at) = cell.windows(4).position(|part| part == b" day") else {
        return clock(cell, 10_000);
    };
    let (days, rest) = cell.split_at(at);
    let rest = rest
        .strip_prefix(b" days ")
        .or(rest.strip_prefix(b" day "))?;
    let days = digits(days).filter(|_| (1..=5).contains(&days.len()))?;
    Some(days * DAY + clock(rest, 24)?)
}

/// A time of day with fewer hours than these.
fn clock(cell: &[u8], hours: i128) -> Option<i128> {
    let at = cell.iter().position(|b| matches!(b, b'Z' | b'+' | b'-'));
    let (time, zone) = cell.split_at(at.unwrap_or(cell.len()));
    let mut parts = time.split(|byte| *byte == b':');
    let (first, second) = (parts.next()?, parts.next()?);
    let whole = |part: &[u8]| {
        let (whole, fraction) = part.split_at_checked(2)?;
        Some(of_two(whole, 60)? * SECOND + nanoseconds(fraction)?)
    };
    let since = match parts.next() {
        Some(part) => {
            let hour = digits(first).filter(|hour| (1..=4).contains(&first.len()) && *hour < hours);
            (hour? * 60 + of_two(second, 60).filter(|_| second.len() == 2)?) * 60 * SECOND
                + whole(part)?
        }
        None if second.len() > 2 => of_two(first, 60)? * 60 * SECOND + whole(second)?,
        None => {
            let minute = of_two(second, 60).filter(|_| second.len() == 2)?;
            (of_two(first, 24)? * 60 + minute) * 60 * SECOND
        }
    };
    if parts.next().is_some() {
        return None;
    }
    let offset_minutes = match zone {
        [] | [b'Z'] => 0,
        [sign, h1, h2, rest @ ..] => {
            let rest = rest.strip_prefix(b":").unwrap_or(rest);
            let minutes = match rest.len() {
                0 => 0,
                2 => of_two(rest, 60)?,
                _ => return None,
            };
            let offset = 60 * of_two(&[*h1, *h2], 24)? + minutes;
            if *sign == b'-' { -offset } else { offset }
        }
        _ => return None,
    };
    Some(since - offset_minutes * 60 * SECOND)
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

/// A number of one or two digits.
fn of_two(text: &[u8], below: i128) -> Option<i128> {
    digits(text).filter(|number| (1..=2).contains(&text.len()) && *number < below)
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
            "31.5.2024 12:03:07,25",
            "2024/05/31 12:03:07.25",
        ] {
            assert_eq!(whole(text.as_bytes()), Some(moment), "{text}");
        }
        for (text, seconds) in [
            (&b"00:01"[..], 60),
            (b"9:59:01", 9 * 3600 + 59 * 60 + 1),
            (b"02:07.0", 127),
            (b"25:00:00.000", 25 * 3600),
            (b"1 days 01:00:00", 25 * 3600),
            (b"0 days 00:00:07.000000", 7),
        ] {
            assert_eq!(time_of_day(text), Some(seconds * SECOND));
        }
        let night = Stamps::TimeOfDay(None);
        assert_eq!(night.seconds_since(DAY - SECOND, SECOND), 2.0);
        assert_eq!(night.seconds_since(5 * SECOND, 3 * SECOND), -2.0);
        assert_eq!(
            Stamps::Whole.seconds_since(DAY - SECOND, SECOND),
            2.0 - 86_400.0
        );
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
            "2024-5-31 12:03:07",
            "2024-05-31T12:3:07",
            "31.05.24 12:03:07",
            "1.2.3.2024 12:03:07",
            "1 days 01:00:00",
            "1.5",
            "",
            "\u{e9}024-05-31T12:03:07",
        ] {
            assert_eq!(whole(text.as_bytes()), None, "{text}");
        }
        assert_eq!(date(b"99999999999999999999"), None);
    }
}
