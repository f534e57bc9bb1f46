//! How a line becomes cells, and a cell a number.

/// What stands between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// A tab.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
    /// Any number of blanks and tabs.
    Blanks,
    /// Nothing: one column.
    None,
}

/// What stands before the fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimal {
    /// A point.
    Point,
    /// A comma.
    Comma,
    /// Not known yet: whole numbers only so far. The first sign met decides.
    Open,
}

/// Both of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    /// What stands between two cells.
    pub separator: Separator,
    /// What stands before the fraction.
    pub decimal: Decimal,
}

impl Dialect {
    /// As a person would name it.
    pub fn describe(self) -> String {
        let separator = match self.separator {
            Separator::Tab => "tab",
            Separator::Semicolon => "semicolon",
            Separator::Comma => "comma",
            Separator::Blanks => "blanks",
            Separator::None => "one column",
        };
        match self.decimal {
            Decimal::Comma => format!("{separator}, decimal comma"),
            Decimal::Point | Decimal::Open => separator.to_owned(),
        }
    }
}

/// Begin and end of every cell of a line, without blanks and quotes around it. Fails on a quote that does not end.
pub fn split(
    line: &[u8],
    separator: Separator,
    cells: &mut Vec<(usize, usize)>,
) -> Result<(), &'static str> {
    cells.clear();
    let sign = match separator {
        Separator::Tab => b'\t',
        Separator::Semicolon => b';',
        Separator::Comma => b',',
        Separator::None => {
            // A quoted name may hold anything; a lone cell has no sign to end it.
            cells.push(bare(line, 0, line.len()));
            return Ok(());
        }
        Separator::Blanks => return split_blanks(line, cells),
    };
    if memchr::memchr(b'"', line).is_some() {
        return split_quoted(line, sign, cells);
    }
    let mut begin = 0;
    for end in memchr::memchr_iter(sign, line) {
        cells.push(trim(line, begin, end));
        begin = end + 1;
    }
    cells.push(trim(line, begin, line.len()));
    Ok(())
}

fn split_quoted(
    line: &[u8],
    sign: u8,
    cells: &mut Vec<(usize, usize)>,
) -> Result<(), &'static str> {
    let (mut begin, mut inside) = (0, false);
    for (at, &byte) in line.iter().enumerate() {
        if byte == b'"' {
            inside = !inside;
        } else if byte == sign && !inside {
            cells.push(bare(line, begin, at));
            begin = at + 1;
        }
    }
    if inside {
        return Err(UNCLOSED);
    }
    cells.push(bare(line, begin, line.len()));
    Ok(())
}

fn split_blanks(line: &[u8], cells: &mut Vec<(usize, usize)>) -> Result<(), &'static str> {
    let (mut begin, mut inside) = (None, false);
    for (at, &byte) in line.iter().enumerate() {
        if (byte == b' ' || byte == b'\t') && !inside {
            if let Some(begin) = begin.take() {
                cells.push(bare(line, begin, at));
            }
            continue;
        }
        inside ^= byte == b'"';
        begin.get_or_insert(at);
    }
    if inside {
        return Err(UNCLOSED);
    }
    if let Some(begin) = begin {
        cells.push(bare(line, begin, line.len()));
    }
    Ok(())
}

const UNCLOSED: &str = "a quote that does not end in this line";

/// Without blanks around.
fn trim(line: &[u8], mut begin: usize, mut end: usize) -> (usize, usize) {
    let blank = |at: usize| matches!(line.get(at), Some(b' ' | b'\t'));
    while begin < end && blank(begin) {
        begin += 1;
    }
    while begin < end && blank(end - 1) {
        end -= 1;
    }
    (begin, end)
}

/// Without blanks around, one pair of quotes, and blanks within that.
fn bare(line: &[u8], begin: usize, end: usize) -> (usize, usize) {
    let (begin, end) = trim(line, begin, end);
    let quote = |at: usize| line.get(at) == Some(&b'"');
    if end >= begin + 2 && quote(begin) && quote(end - 1) {
        return trim(line, begin + 1, end - 1);
    }
    (begin, end)
}

/// The number in a cell, correctly rounded, or none. `decimal` turns from open to what the cell has, if it has any.
pub fn number(cell: &[u8], decimal: &mut Decimal, scratch: &mut String) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    if *decimal == Decimal::Open
        && let Some(at) = memchr::memchr2(b'.', b',', cell)
    {
        let met = match cell.get(at) {
            Some(b',') => Decimal::Comma,
            _ => Decimal::Point,
        };
        let value = fixed(text, met, scratch)?;
        *decimal = met;
        return Some(value);
    }
    fixed(text, *decimal, scratch)
}

fn fixed(text: &str, decimal: Decimal, scratch: &mut String) -> Option<f64> {
    if decimal != Decimal::Comma {
        return text.parse().ok();
    }
    let Some((whole, fraction)) = text.split_once(',') else {
        // A point would be a thousands separator here.
        return (!text.contains('.')).then(|| text.parse().ok())?;
    };
    // `1,` is the remains of a list more often than a number.
    if whole.contains('.') || !fraction.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    scratch.clear();
    scratch.extend([whole, ".", fraction]);
    scratch.parse().ok()
}

/// A cell as a person reads it: UTF-8, else Latin-1; doubled quotes are one.
pub fn text(cell: &[u8]) -> String {
    let text = match std::str::from_utf8(cell) {
        Ok(text) => text.to_owned(),
        Err(_) => cell.iter().map(|&byte| char::from(byte)).collect(),
    };
    text.replace("\"\"", "\"")
}

/// The cells of a line as a person reads them. Fails on a quote that does not end.
pub fn texts(line: &[u8], separator: Separator) -> Result<Vec<String>, &'static str> {
    let mut cells = Vec::new();
    split(line, separator, &mut cells)?;
    let cells = cells.iter();
    Ok(cells
        .map(|&(begin, end)| text(line.get(begin..end).unwrap_or_default()))
        .collect())
}

/// [`text`], shortened for a message.
pub fn excerpt(cell: &[u8]) -> String {
    let text = text(cell);
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{:?}...", text.get(..end).unwrap_or_default()),
        None => format!("{text:?}"),
    }
}
