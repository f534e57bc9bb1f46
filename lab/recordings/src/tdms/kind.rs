//! Data types, and samples as f64.

use super::value::Timestamp;
use crate::numbers::{self, Number, spread};

/// What a sample is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Nothing; for channels without samples.
    Void,
    Number(numbers::Kind),
    Time,
    Text,
    /// Two f32; its size is known, its samples are not one number.
    Complex32,
    /// Two f64.
    Complex64,
    /// One bit of a byte: a digital line in DAQmx raw data.
    Line(u8),
}

impl Kind {
    /// From the code in the file; none for a type whose size is not known.
    pub fn from_code(code: u32) -> Option<Self> {
        use numbers::Kind;
        Some(Self::Number(match code {
            0 => return Some(Self::Void),
            1 => Kind::I8,
            2 => Kind::I16,
            3 => Kind::I32,
            4 => Kind::I64,
            5 => Kind::U8,
            6 => Kind::U16,
            7 => Kind::U32,
            8 => Kind::U64,
            9 | 0x19 => Kind::F32,
            10 | 0x1A => Kind::F64,
            0x20 => return Some(Self::Text),
            0x21 => Kind::Bool,
            0x44 => return Some(Self::Time),
            0x0008_000C => return Some(Self::Complex32),
            0x0010_000D => return Some(Self::Complex64),
            _ => return None,
        }))
    }

    /// From the other code that DAQmx scalers use.
    pub fn from_daqmx_code(code: u32) -> Option<Self> {
        use numbers::Kind;
        Some(Self::Number(match code {
            0 => Kind::U8,
            1 => Kind::I8,
            2 => Kind::U16,
            3 => Kind::I16,
            4 => Kind::U32,
            5 => Kind::I32,
            6 => Kind::U64,
            7 => Kind::I64,
            8 => Kind::F32,
            9 => Kind::F64,
            _ => return None,
        }))
    }

    /// Bytes per sample, if all samples take the same.
    pub fn size(self) -> Option<u64> {
        Some(match self {
            Self::Void => 0,
            Self::Number(kind) => kind.size() as u64,
            Self::Line(_) => 1,
            Self::Complex32 => 8,
            Self::Time | Self::Complex64 => 16,
            Self::Text => return None,
        })
    }

    /// Appends `count` samples that lie `stride` bytes apart. `bytes` begins with the first and ends with the last of them.
    /// Time stamps become seconds since `origin`.
    pub fn decode(
        self,
        bytes: &[u8],
        stride: usize,
        count: usize,
        big_endian: bool,
        origin: Timestamp,
        out: &mut Vec<f64>,
    ) {
        match self {
            Self::Number(kind) => Number { kind, big_endian }.append(bytes, stride, count, out),
            Self::Line(bit) => spread(bytes, stride, count, out, |[b]| {
                f64::from(b >> (bit & 7) & 1)
            }),
            Self::Time => spread(bytes, stride, count, out, |b| {
                Timestamp::from_bytes(b, big_endian).seconds_since(origin)
            }),
            // Refused when they are selected.
            Self::Void | Self::Text | Self::Complex32 | Self::Complex64 => {
                out.resize(out.len() + count, f64::NAN);
            }
        }
    }
}
