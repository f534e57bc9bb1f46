//! Numbers as NumPy lays them out.

use super::literal::Literal;

/// A number's type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `f2`, IEEE half precision.
    Float2,
    /// `f4`
    Float4,
    /// `f8`
    Float8,
    /// `i1`
    Int1,
    /// `i2`
    Int2,
    /// `i4`
    Int4,
    /// `i8`
    Int8,
    /// `u1`
    Uint1,
    /// `u2`
    Uint2,
    /// `u4`
    Uint4,
    /// `u8`
    Uint8,
    /// `b1`
    Bool,
}

/// A number's type and byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// Type.
    pub kind: Kind,
    /// Most significant byte first.
    pub big: bool,
}

/// What one element of an array is.
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// A number.
    Number(Number),
    /// A string of so many bytes; `U` has four per character.
    Text {
        /// `U`, as against `S`.
        wide: bool,
        /// Most significant byte first.
        big: bool,
        /// Bytes.
        bytes: u64,
    },
    /// Bytes of no meaning, between fields.
    Padding(u64),
    /// Fields with their names and how many elements each has.
    Record(Vec<(String, Element, u64)>),
}

impl Element {
    /// Bytes of one element; none if that overflows.
    pub fn bytes(&self) -> Option<u64> {
        match self {
            Self::Number(number) => Some(number.bytes() as u64),
            Self::Text { bytes, .. } | Self::Padding(bytes) => Some(*bytes),
            Self::Record(fields) => fields.iter().try_fold(0_u64, |sum, (_, element, count)| {
                sum.checked_add(element.bytes()?.checked_mul(*count)?)
            }),
        }
    }
}

/// Reads a `descr`. The error names what is not read.
pub fn element(descr: &Literal) -> Result<Element, String> {
    match descr {
        Literal::Text(code) => simple(code),
        Literal::Sequence(fields) => fields
            .iter()
            .map(field)
            .collect::<Result<_, _>>()
            .map(Element::Record),
        _ => Err("this kind of array".to_owned()),
    }
}

fn field(field: &Literal) -> Result<(String, Element, u64), String> {
    let odd = || "a record of this form".to_owned();
    let Literal::Sequence(parts) = field else {
        return Err(odd());
    };
    let name = match parts.first() {
        Some(Literal::Text(name)) => name.clone(),
        // A title and a name.
        Some(Literal::Sequence(pair)) => match pair.get(1) {
            Some(Literal::Text(name)) => name.clone(),
            _ => return Err(odd()),
        },
        _ => return Err(odd()),
    };
    let Some(Literal::Text(code)) = parts.get(1) else {
        return Err("a record within a record".to_owned());
    };
    let count = match parts.get(2) {
        None => 1,
        Some(Literal::Int(count)) => *count,
        Some(Literal::Sequence(shape)) => match shape.as_slice() {
            [Literal::Int(count)] => *count,
            _ => return Err("an array of several dimensions within a record".to_owned()),
        },
        Some(_) => return Err(odd()),
    };
    Ok((name, simple(code)?, count))
}

fn simple(code: &str) -> Result<Element, String> {
    let refused = || match code.trim_start_matches(['<', '>', '|', '=']).chars().next() {
        Some('O') => "an array of Python objects".to_owned(),
        Some('c') => "an array of complex numbers".to_owned(),
        Some('M' | 'm') => "an array of dates".to_owned(),
        _ => format!("an array of type {code:?}"),
    };
    let mut characters = code.chars();
    let big = match characters.next() {
        Some('<' | '|') => false,
        Some('>') => true,
        _ => return Err(refused()),
    };
    let letter = characters.next();
    let size: u64 = characters.as_str().parse().map_err(|_| refused())?;
    let kind = match (letter, size) {
        (Some('f'), 2) => Kind::Float2,
        (Some('f'), 4) => Kind::Float4,
        (Some('f'), 8) => Kind::Float8,
        (Some('i'), 1) => Kind::Int1,
        (Some('i'), 2) => Kind::Int2,
        (Some('i'), 4) => Kind::Int4,
        (Some('i'), 8) => Kind::Int8,
        (Some('u'), 1) => Kind::Uint1,
        (Some('u'), 2) => Kind::Uint2,
        (Some('u'), 4) => Kind::Uint4,
        (Some('u'), 8) => Kind::Uint8,
        (Some('b'), 1) => Kind::Bool,
        (Some('V'), bytes) => return Ok(Element::Padding(bytes)),
        (Some(letter @ ('U' | 'S')), size) => {
            let wide = letter == 'U';
            let bytes = size
                .checked_mul(if wide { 4 } else { 1 })
                .ok_or_else(refused)?;
            return Ok(Element::Text { wide, big, bytes });
        }
        _ => return Err(refused()),
    };
    Ok(Element::Number(Number { kind, big }))
}

impl Number {
    /// Bytes of one.
    pub fn bytes(self) -> usize {
        match self.kind {
            Kind::Int1 | Kind::Uint1 | Kind::Bool => 1,
            Kind::Float2 | Kind::Int2 | Kind::Uint2 => 2,
            Kind::Float4 | Kind::Int4 | Kind::Uint4 => 4,
            Kind::Float8 | Kind::Int8 | Kind::Uint8 => 8,
        }
    }

    /// Appends the numbers at `offset` of every record. The error is the row, from 0, whose integer f64 cannot hold.
    pub fn decode(
        self,
        bytes: &[u8],
        record: usize,
        offset: usize,
        out: &mut Vec<f64>,
    ) -> Result<(), usize> {
        let records = bytes.chunks_exact(record.max(1));
        macro_rules! decode {
            ($type:ty, $convert:expr) => {{
                const BYTES: usize = size_of::<$type>();
                let convert = $convert;
                for (row, record) in records.enumerate() {
                    let field = record
                        .get(offset..)
                        .and_then(|field| field.first_chunk::<BYTES>());
                    // The layout was checked against the record.
                    let field = field.copied().ok_or(row)?;
                    let value = if self.big {
                        <$type>::from_be_bytes(field)
                    } else {
                        <$type>::from_le_bytes(field)
                    };
                    out.push(convert(value).ok_or(row)?);
                }
            }};
        }
        match self.kind {
            Kind::Float2 => decode!(u16, |v| Some(half(v))),
            Kind::Float4 => decode!(f32, |v| Some(f64::from(v))),
            Kind::Float8 => decode!(f64, Some),
            Kind::Int1 => decode!(i8, |v| Some(f64::from(v))),
            Kind::Int2 => decode!(i16, |v| Some(f64::from(v))),
            Kind::Int4 => decode!(i32, |v| Some(f64::from(v))),
            Kind::Int8 => decode!(i64, |v| exact(i128::from(v))),
            Kind::Uint1 => decode!(u8, |v| Some(f64::from(v))),
            Kind::Uint2 => decode!(u16, |v| Some(f64::from(v))),
            Kind::Uint4 => decode!(u32, |v| Some(f64::from(v))),
            Kind::Uint8 => decode!(u64, |v| exact(i128::from(v))),
            Kind::Bool => decode!(u8, |v| Some(f64::from(u8::from(v != 0)))),
        }
        Ok(())
    }
}

fn exact(value: i128) -> Option<f64> {
    let float = value as f64;
    (float as i128 == value).then_some(float)
}

/// IEEE half precision, exactly.
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let fraction = f64::from(bits & 0x3ff);
    let magnitude = match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    };
    sign * magnitude
}
