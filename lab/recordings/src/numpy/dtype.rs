//! Numbers as NumPy lays them out.

use super::literal::Literal;
use crate::numbers::{Kind, Number};

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
            Self::Number(number) => Some(number.kind.size() as u64),
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
        Some('M' | 'm') => {
            "dates or spans; save seconds, (t - t[0]) / numpy.timedelta64(1, 's')".to_owned()
        }
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
        (Some('f'), 2) => Kind::F16,
        (Some('f'), 4) => Kind::F32,
        (Some('f'), 8) => Kind::F64,
        (Some('i'), 1) => Kind::I8,
        (Some('i'), 2) => Kind::I16,
        (Some('i'), 4) => Kind::I32,
        (Some('i'), 8) => Kind::I64,
        (Some('u'), 1) => Kind::U8,
        (Some('u'), 2) => Kind::U16,
        (Some('u'), 4) => Kind::U32,
        (Some('u'), 8) => Kind::U64,
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
    Ok(Element::Number(Number {
        kind,
        big_endian: big,
    }))
}
