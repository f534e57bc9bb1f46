//! Which dialect the first lines are written in, and which of them are headings.

use super::dialect::{Decimal, Dialect, Separator, number, split, texts};
use super::stamp::{date, time_of_day, whole};

/// A line with its number.
pub type Numbered = (u64, Vec<u8>);

/// What the first lines turn out to be.
#[derive(Debug)]
pub struct Found {
    /// Separator and decimal sign.
    pub dialect: Dialect,
    /// Cells of a row.
    pub columns: usize,
    /// Names, if there is a line of them.
    pub headings: Option<Vec<String>>,
    /// Units, if there is a line of them.
    pub units: Option<Vec<String>>,
    /// Lines before the numbers.
    pub before: usize,
}

/// In this order the first wins a tie.
const CANDIDATES: [Separator; 4] = [
    Separator::Tab,
    Separator::Semicolon,
    Separator::Comma,
    Separator::Blanks,
];

/// Cells that stand for a missing value: a line of them is a row, not one of units.
const MISSING: [&str; 8] = ["", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// Whether a cell stands for a missing value.
pub fn is_missing(cell: &str) -> bool {
    MISSING.contains(&cell.to_ascii_lowercase().as_str())
}

/// Decides. `lines` has no comments and no blank lines, and at least one line. The error has the line.
pub fn detect(lines: &[Numbered], given: Option<Separator>) -> Result<Found, (u64, String)> {
    // Two lines at most come before the numbers; what follows is taken for rows.
    let body = lines
        .get(2.min(lines.len().saturating_sub(1))..)
        .unwrap_or_default();
    let candidates = match &given {
        Some(separator) => std::slice::from_ref(separator),
        None => &CANDIDATES[..],
    };
    let mut best: Option<Score> = None;
    for &separator in candidates.iter().chain([&Separator::None]) {
        // One column is the last resort: `2024-01-01` is no row of one number, and `1;2` none either.
        if let Some(score) = score(body, separator)
            && score.share > best.as_ref().map_or(0.0, |b| b.share)
        {
            best = Some(score);
        }
    }
    match best {
        // A lone line with a number here and there is a line of names such as `u 1`.
        Some(best) if lines.len() > 1 || best.share >= 0.5 => arrange(lines, &best),
        _ if lines.len() <= 2 => names_only(lines, candidates),
        _ => Err((
            body.first().map_or(0, |line| line.0),
            "no number in this line nor below with any of the separators tab, semicolon, comma and blank; expected is at \
             most one line of headings and one of units, then numbers (begin other lines with #)"
                .to_owned(),
        )),
    }
}

struct Score {
    dialect: Dialect,
    columns: usize,
    /// Which columns are numbers.
    numeric: Vec<bool>,
    /// Share of the cells that are numbers or times of a calendar.
    share: f64,
}

fn score(body: &[Numbered], separator: Separator) -> Option<Score> {
    let mut cells = Vec::new();
    let mut counts: Vec<usize> = Vec::with_capacity(body.len());
    for (_, line) in body {
        let _ = split(line, separator, &mut cells);
        counts.push(cells.len());
    }
    let columns = most_common(&counts)?;
    if separator != Separator::None && columns < 2 {
        return None;
    }
    let decimal = decimal_sign(body, separator);
    let (mut hits, mut rows, mut stamps, mut empty) =
        (vec![0_usize; columns], 0_usize, 0_usize, 0_usize);
    let mut scratch = String::new();
    for (_, line) in body {
        if split(line, separator, &mut cells).is_err() || cells.len() != columns {
            continue;
        }
        rows += 1;
        for (hits, &(begin, end)) in hits.iter_mut().zip(&cells) {
            let cell = line.get(begin..end).unwrap_or_default();
            let is_number = number(cell, &mut decimal.clone(), &mut scratch).is_some();
            *hits += usize::from(is_number);
            stamps += usize::from(!is_number && is_stamp(cell));
            empty += usize::from(cell.is_empty());
        }
    }
    // Runs of blanks swallow what tabs leave empty, and would then have the larger share.
    let of_tabs = if separator == Separator::Tab {
        empty
    } else {
        0
    };
    let found = hits.iter().sum::<usize>() + stamps;
    let share = if found == 0 {
        0.0
    } else {
        (found + of_tabs) as f64 / (columns * body.len()) as f64
    };
    (share > 0.0).then(|| Score {
        dialect: Dialect { separator, decimal },
        columns,
        numeric: hits.iter().map(|&hits| 2 * hits > rows).collect(),
        share,
    })
}

/// Whether a cell is a date, a time of day or both.
fn is_stamp(cell: &[u8]) -> bool {
    whole(cell).is_some() || date(cell).is_some() || time_of_day(cell).is_some()
}

fn most_common(counts: &[usize]) -> Option<usize> {
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    sorted
        .chunk_by(|a, b| a == b)
        .max_by_key(|run| run.len())
        .and_then(|run| run.first().copied())
}

fn decimal_sign(body: &[Numbered], separator: Separator) -> Decimal {
    if separator == Separator::None {
        return Decimal::Point;
    }
    let (mut cells, mut scratch) = (Vec::new(), String::new());
    let (mut points, mut commas, mut fractions) = (0_usize, 0_usize, 0_usize);
    for (_, line) in body {
        let _ = split(line, separator, &mut cells);
        for &(begin, end) in &cells {
            let mut decimal = Decimal::Open;
            let cell = line.get(begin..end).unwrap_or_default();
            if number(cell, &mut decimal, &mut scratch).is_some() {
                points += usize::from(decimal == Decimal::Point);
                commas += usize::from(decimal == Decimal::Comma);
                fractions += usize::from(decimal == Decimal::Comma && !in_thousands(cell));
            }
        }
    }
    // Between commas a cell with one of its own is quoted; whole numbers with thousands separators are that, too.
    if separator == Separator::Comma && fractions == 0 {
        return Decimal::Point;
    }
    match (points, commas) {
        (0, 0) => Decimal::Open,
        _ if commas > points => Decimal::Comma,
        _ => Decimal::Point,
    }
}

/// Whether what follows a comma may be a group of three digits.
fn in_thousands(cell: &[u8]) -> bool {
    let behind = cell.iter().rev().take_while(|byte| **byte != b',').count();
    behind == 3
}

/// Tells headings and units from numbers.
fn arrange(lines: &[Numbered], best: &Score) -> Result<Found, (u64, String)> {
    let mut found = Found {
        dialect: best.dialect,
        columns: best.columns,
        headings: None,
        units: None,
        before: 0,
    };
    for (at, (line, bytes)) in lines.iter().take(2).enumerate() {
        let names =
            texts(bytes, best.dialect.separator).map_err(|cause| (*line, cause.to_owned()))?;
        if !is_words(&names, best, at == 0) {
            break;
        }
        if names.len() != best.columns {
            return Err((*line, differing(names.len(), best)));
        }
        if at == 0 {
            found.headings = Some(names);
        } else {
            found.units = Some(names);
        }
        found.before = at + 1;
    }
    // All rows of the sample have a say in the sign, the first two as well.
    let rows = lines.get(found.before..).unwrap_or_default();
    found.dialect.decimal = decimal_sign(rows, best.dialect.separator);
    Ok(found)
}

fn differing(names: usize, best: &Score) -> String {
    // A comma within each number makes up to two columns of one.
    let split = (names..=2 * names).contains(&best.columns);
    let advice = if best.dialect.separator == Separator::Comma && split {
        "; if the comma is also the decimal sign, save the file with semicolons between the columns"
    } else {
        "; lines that are neither headings nor numbers are to begin with #"
    };
    format!(
        "{names} headings, but {} columns below (separator: {}){advice}",
        best.columns,
        best.dialect.describe()
    )
}

/// Whether a line is headings (or units) and not a row.
fn is_words(names: &[String], best: &Score, headings: bool) -> bool {
    let mut scratch = String::new();
    let is_number = |name: &str, scratch: &mut String| {
        number(name.as_bytes(), &mut best.dialect.decimal.clone(), scratch).is_some()
    };
    let over_numbers: Vec<&String> = names
        .iter()
        .enumerate()
        .filter(|(at, _)| best.numeric.get(*at).copied().unwrap_or(true))
        .map(|(_, name)| name)
        .collect();
    if over_numbers.iter().all(|name| is_missing(name)) {
        return false;
    }
    if !over_numbers
        .iter()
        .any(|name| is_number(name, &mut scratch))
    {
        return true;
    }
    // pandas numbers columns without names, behind the empty name of the index: `,0,1,2`.
    let counting = names.get(1..).unwrap_or_default();
    let first_is_text = names
        .first()
        .is_some_and(|name| !is_number(name, &mut scratch));
    let count_up = counting
        .iter()
        .enumerate()
        .all(|(at, name)| name.parse() == Ok(at) || name.parse() == Ok(at + 1));
    headings
        && first_is_text
        && best.numeric.first() == Some(&true)
        && !counting.is_empty()
        && count_up
}

/// A file of headings (and units) without a row.
fn names_only(lines: &[Numbered], candidates: &[Separator]) -> Result<Found, (u64, String)> {
    let (line, first) = lines.first().ok_or((1, "no line in it".to_owned()))?;
    let mut separator = Separator::None;
    for &candidate in candidates.iter().filter(|&&c| c != Separator::Blanks) {
        if texts(first, candidate).is_ok_and(|names| names.len() > 1) {
            separator = candidate;
            break;
        }
    }
    let read =
        |line: u64, bytes: &[u8]| texts(bytes, separator).map_err(|cause| (line, cause.to_owned()));
    let headings = read(*line, first)?;
    let units = match lines.get(1) {
        Some((line, bytes)) => {
            let units = read(*line, bytes)?;
            if units.len() != headings.len() || units.iter().all(|unit| is_missing(unit)) {
                return Err((*line, "no number in this line".to_owned()));
            }
            Some(units)
        }
        None => None,
    };
    Ok(Found {
        dialect: Dialect {
            separator,
            decimal: match separator {
                Separator::Comma | Separator::None => Decimal::Point,
                _ => Decimal::Open,
            },
        },
        columns: headings.len(),
        headings: Some(headings),
        units,
        before: lines.len(),
    })
}
