//! The header of an NPY file.

use std::io::{self, Read};

use super::dtype::{Element, element};
use super::literal::{Literal, parse};

/// What an array is.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// One element.
    pub element: Element,
    /// Column after column.
    pub fortran: bool,
    /// Length of every dimension.
    pub shape: Vec<u64>,
    /// Where the elements begin, bytes.
    pub begin: u64,
}

/// Why a header is not accepted.
#[derive(Debug)]
pub enum Refusal {
    /// The reader says no, or ends.
    Io(io::Error),
    /// The rules are broken.
    Malformed(String),
    /// Not read, though right.
    Unsupported(String),
}

/// Longest header; that of 4096 fields with long names is shorter.
const HEADER: u64 = 1 << 20;

/// Reads the header of an array that has `total` bytes, header included, and checks that both fit exactly.
pub fn read(input: &mut dyn Read, total: u64) -> Result<Header, Refusal> {
    let short = || Refusal::Malformed("the header ends too early".to_owned());
    let mut exact = |count: u64, at: u64| {
        if at + count > total {
            return Err(short());
        }
        let mut bytes = vec![0; count as usize];
        input.read_exact(&mut bytes).map_err(Refusal::Io)?;
        Ok(bytes)
    };
    let start = exact(8, 0)?;
    let [magic @ .., major, _] = start.as_slice() else {
        return Err(short());
    };
    if magic != b"\x93NUMPY" {
        return Err(Refusal::Malformed("this is not a NumPy array".to_owned()));
    }
    let width = match major {
        1 => 2,
        2 | 3 => 4,
        other => return Err(Refusal::Unsupported(format!("NPY version {other}"))),
    };
    let length = exact(width, 8)?
        .iter()
        .rev()
        .fold(0_u64, |length, byte| length << 8 | u64::from(*byte));
    if length > HEADER {
        let cause = format!("a header of {length} bytes; at most {HEADER} are read");
        return Err(Refusal::Malformed(cause));
    }
    let bytes = exact(length, 8 + width)?;
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        // Before version 3 names are Latin-1.
        Err(e) => e.into_bytes().into_iter().map(char::from).collect(),
    };
    let header = interpret(&text, 8 + width + length)?;
    let size = header
        .element
        .bytes()
        .and_then(|bytes| {
            header
                .shape
                .iter()
                .try_fold(bytes, |n, &d| n.checked_mul(d))
        })
        .and_then(|bytes| bytes.checked_add(header.begin));
    match size {
        Some(size) if size == total => Ok(header),
        Some(size) => Err(Refusal::Malformed(format!(
            "{total} bytes, but the header speaks of {size}; was the file cut, or were several arrays saved to it?"
        ))),
        None => Err(Refusal::Malformed(
            "a shape that no file can have".to_owned(),
        )),
    }
}

fn interpret(text: &str, begin: u64) -> Result<Header, Refusal> {
    let Literal::Dict(entries) = parse(text).map_err(Refusal::Malformed)? else {
        return Err(Refusal::Malformed(
            "the header is not a dictionary".to_owned(),
        ));
    };
    let (mut descr, mut fortran, mut shape) = (None, None, None);
    for (key, value) in entries {
        match (key.as_str(), value) {
            ("descr", value) => descr = Some(value),
            ("fortran_order", Literal::Bool(value)) => fortran = Some(value),
            ("shape", Literal::Sequence(dimensions)) => {
                let dimensions = dimensions.into_iter().map(|d| match d {
                    Literal::Int(length) => Some(length),
                    _ => None,
                });
                shape = dimensions.collect();
            }
            (key, _) => {
                let cause = format!("{key:?} in the header is not understood");
                return Err(Refusal::Malformed(cause));
            }
        }
    }
    match (descr, fortran, shape) {
        (Some(descr), Some(fortran), Some(shape)) => Ok(Header {
            element: element(&descr).map_err(Refusal::Unsupported)?,
            fortran,
            shape,
            begin,
        }),
        _ => Err(Refusal::Malformed(
            "the header lacks descr, fortran_order or shape".to_owned(),
        )),
    }
}

/// The header of an array of this type and shape, C order, padded so that the first dimension can later be any.
pub fn write(descr: &str, shape: &[u64]) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(u64::to_string).collect();
    let shape = match lengths.as_slice() {
        [one] => format!("({one},)"),
        several => format!("({})", several.join(", ")),
    };
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version and length are 10 bytes; readers expect the elements at a multiple of 64.
    while text.len() + 11 < 128 || !(text.len() + 11).is_multiple_of(64) {
        text.push(' ');
    }
    text.push('\n');
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((text.len() as u16).to_le_bytes());
    header.extend(text.bytes());
    header
}
