//! Messages of HDF5 object headers: the parts that describe numbers, links and attributes.
//!
//! Each function returns `None` for a message that breaks off or is of an unknown version.

use super::numbers::Kind;

/// A message of an object header.
pub(super) struct Message {
    pub(super) kind: u16,
    /// It stands elsewhere, shared by several objects.
    pub(super) shared: bool,
    pub(super) body: Vec<u8>,
    /// Where it stands in the file.
    pub(super) at: u64,
}

/// Reads little-endian fields one after another.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    /// Unsigned, of so many bytes, at most 8.
    pub(super) fn uint(&mut self, count: usize) -> Option<u64> {
        let bytes = self.take(count)?;
        Some(
            bytes
                .iter()
                .rev()
                .fold(0, |sum, &b| (sum << 8) | u64::from(b)),
        )
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        self.take(1).and_then(|bytes| bytes.first().copied())
    }

    pub(super) fn size(&mut self, count: usize) -> Option<usize> {
        self.uint(count).and_then(|v| usize::try_from(v).ok())
    }

    pub(super) fn align(&mut self, to: usize) {
        self.at = self.at.next_multiple_of(to);
    }
}

/// Bytes up to the first zero.
pub(super) fn text(bytes: &[u8]) -> String {
    let text = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    String::from_utf8_lossy(text).into_owned()
}

/// Dimensions, the slowest first.
pub(super) fn dimensions(body: &[u8]) -> Option<Vec<u64>> {
    let mut fields = Fields::new(body);
    let version = fields.byte()?;
    let rank = fields.byte()?;
    fields.byte()?;
    match version {
        1 => fields.take(5)?,
        2 => fields.take(1)?,
        _ => return None,
    };
    (0..rank).map(|_| fields.uint(8)).collect()
}

/// A number and its byte order; what else it is; or nothing that is known.
pub(super) fn number(body: &[u8]) -> Option<std::result::Result<(Kind, bool), &'static str>> {
    let mut fields = Fields::new(body);
    let class = fields.byte()? & 0x0f;
    let bits = fields.uint(3)?;
    let size = fields.uint(4)?;
    match class {
        0 => {
            let (offset, precision) = (fields.uint(2)?, fields.uint(2)?);
            if offset != 0 || precision != size * 8 {
                return Some(Err("of padded integers"));
            }
            let kind = match (size, bits & 8 != 0) {
                (1, true) => Kind::I8,
                (1, false) => Kind::U8,
                (2, true) => Kind::I16,
                (2, false) => Kind::U16,
                (4, true) => Kind::I32,
                (4, false) => Kind::U32,
                (8, true) => Kind::I64,
                (8, false) => Kind::U64,
                _ => return Some(Err("of integers of unusual size")),
            };
            Some(Ok((kind, bits & 1 != 0)))
        }
        1 => {
            let layout = fields.take(12)?;
            // Offset, precision, exponent place and size, mantissa place and size, bias.
            let single = [0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0];
            let double = [0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0];
            let kind = if layout == single && size == 4 {
                Kind::F32
            } else if layout == double && size == 8 {
                Kind::F64
            } else {
                return Some(Err("of unusual floats"));
            };
            match bits & 0x41 {
                0 => Some(Ok((kind, false))),
                1 => Some(Ok((kind, true))),
                _ => Some(Err("of floats in VAX order")),
            }
        }
        // An enumeration, such as h5py's booleans, is of the type that follows.
        8 => number(body.get(8..)?),
        6 => Some(Err("complex or compound")),
        7 => Some(Err("cell or references")),
        3 | 9 => Some(Err("text")),
        _ => Some(Err("of no numbers")),
    }
}

/// Filters in the order in which they were applied.
pub(super) fn filters(body: &[u8]) -> Option<Vec<u16>> {
    let mut fields = Fields::new(body);
    let version = fields.byte()?;
    let count = fields.byte()?;
    if version == 1 {
        fields.take(6)?;
    }
    let mut ids = Vec::new();
    for _ in 0..count {
        let id = fields.uint(2)? as u16;
        let name = if version == 1 || id >= 256 {
            fields.size(2)?
        } else {
            0
        };
        fields.take(2)?;
        let values = fields.size(2)?;
        fields.take(name)?;
        if version == 1 {
            fields.align(8);
        }
        fields.take(values.checked_mul(4)?)?;
        if version == 1 {
            fields.align(8);
        }
        ids.push(id);
    }
    Some(ids)
}

/// A hard link; `Some(None)` for one of another kind.
pub(super) fn link(fields: &mut Fields<'_>) -> Option<Option<(String, u64)>> {
    let flags = fields.take(2)?.get(1).copied()?;
    let kind = if flags & 8 != 0 { fields.byte()? } else { 0 };
    if flags & 4 != 0 {
        fields.take(8)?;
    }
    if flags & 0x10 != 0 {
        fields.take(1)?;
    }
    let size = fields.size(1 << (flags & 3))?;
    let name = text(fields.take(size)?);
    if kind != 0 {
        return Some(None);
    }
    Some(Some((name, fields.uint(8)?)))
}

/// Name and value of an attribute that is a text of fixed length; other attributes by their name alone.
pub(super) fn attribute(message: &Message) -> Option<(String, Option<String>)> {
    let mut fields = Fields::new(&message.body);
    let version = fields.byte()?;
    fields.byte()?;
    let name = fields.size(2)?;
    let datatype = fields.size(2)?;
    let dataspace = fields.size(2)?;
    if version == 3 {
        fields.byte()?;
    }
    let padding = if version == 1 { 8 } else { 1 };
    let name = text(fields.take(name)?);
    fields.align(padding);
    let kind = fields.take(datatype)?;
    fields.align(padding);
    fields.take(dataspace)?;
    fields.align(padding);
    let mut kind = Fields::new(kind);
    let is_text = kind.byte()? & 0x0f == 3;
    kind.take(3)?;
    let size = kind.size(4)?;
    let value = if is_text {
        fields.take(size).map(text)
    } else {
        None
    };
    Some((name, value))
}
