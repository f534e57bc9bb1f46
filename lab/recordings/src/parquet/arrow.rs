//! What Arrow's own schema adds to that of Parquet: durations, which Parquet knows only as integers, and units.
//!
//! Arrow's libraries, and with them pandas, put it into the metadata under [`KEY`]: a flatbuffer in base64, whose tables and
//! fields are numbered as in Arrow's `Message.fbs` and `Schema.fbs`.

/// Key of the metadata.
pub(super) const KEY: &str = "ARROW:schema";

/// A column as Arrow has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    /// Ticks per second of a duration.
    pub(super) duration: Option<f64>,
    /// Value of the field's metadata key `unit` or `units`.
    pub(super) unit: Option<String>,
}

/// Type number of a duration.
const DURATION: u8 = 18;
/// Header number of a schema.
const SCHEMA: u8 = 1;

/// The columns, or nothing if this is no such schema.
pub(super) fn fields(encoded: &str) -> Option<Vec<Field>> {
    let bytes = base64(encoded)?;
    // A message has its size in front, in newer versions with a mark before.
    let bytes = bytes.strip_prefix(&[0xff; 4]).unwrap_or(&bytes);
    let buffer = Buffer(bytes.get(4..)?);
    let message = buffer.follow(0)?;
    if buffer.byte(buffer.field(message, 1)?)? != SCHEMA {
        return None;
    }
    let schema = buffer.follow(buffer.field(message, 2)?)?;
    let list = buffer.tables(buffer.field(schema, 1)?)?;
    list.map(|field| {
        let field = field?;
        let name = buffer.text(buffer.field(field, 0)?)?;
        let kind = buffer.field(field, 2).and_then(|at| buffer.byte(at));
        let duration = if kind == Some(DURATION) {
            let kind = buffer.follow(buffer.field(field, 3)?)?;
            // Milliseconds unless it says otherwise.
            let unit = buffer
                .field(kind, 0)
                .map_or(Some(1), |at| buffer.byte(at))?;
            Some(1000f64.powi(i32::from(unit)))
        } else {
            None
        };
        let unit = buffer.field(field, 6).and_then(|pairs| {
            buffer.tables(pairs)?.flatten().find_map(|pair| {
                let key = buffer.text(buffer.field(pair, 0)?)?;
                let value = buffer.text(buffer.field(pair, 1)?)?;
                (matches!(key.as_str(), "unit" | "units") && !value.is_empty()).then_some(value)
            })
        });
        Some(Field {
            name,
            duration,
            unit,
        })
    })
    .collect()
}

/// A flatbuffer; every reading is checked.
#[derive(Clone, Copy)]
struct Buffer<'a>(&'a [u8]);

impl Buffer<'_> {
    fn byte(self, at: usize) -> Option<u8> {
        self.0.get(at).copied()
    }

    fn half(self, at: usize) -> Option<usize> {
        let bytes = self.0.get(at..at.checked_add(2)?)?;
        Some(usize::from(u16::from_le_bytes(bytes.try_into().ok()?)))
    }

    fn word(self, at: usize) -> Option<usize> {
        let bytes = self.0.get(at..at.checked_add(4)?)?;
        usize::try_from(u32::from_le_bytes(bytes.try_into().ok()?)).ok()
    }

    /// Where a reference leads.
    fn follow(self, at: usize) -> Option<usize> {
        at.checked_add(self.word(at)?)
    }

    /// Place of a table's field, if it is set.
    fn field(self, table: usize, number: usize) -> Option<usize> {
        let back = self.word(table)? as u32 as i32;
        let list = i64::try_from(table).ok()?.checked_sub(i64::from(back))?;
        let list = usize::try_from(list).ok()?;
        let entry = 4 + 2 * number;
        if entry + 2 > self.half(list)? {
            return None;
        }
        match self.half(list.checked_add(entry)?)? {
            0 => None,
            offset => table.checked_add(offset),
        }
    }

    fn text(self, at: usize) -> Option<String> {
        let at = self.follow(at)?;
        let from = at.checked_add(4)?;
        let bytes = self.0.get(from..from.checked_add(self.word(at)?)?)?;
        Some(String::from_utf8_lossy(bytes).into_owned())
    }

    /// Tables of a vector.
    fn tables(self, at: usize) -> Option<impl Iterator<Item = Option<usize>>> {
        let at = self.follow(at)?;
        let count = self.word(at)?;
        let first = at.checked_add(4)?;
        // Each takes four bytes, which bounds how many there can be.
        if count > self.0.len().checked_sub(first)? / 4 {
            return None;
        }
        Some((0..count).map(move |index| self.follow(first + 4 * index)))
    }
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for letter in text.trim_end_matches('=').bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = (bits << 6) | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}
