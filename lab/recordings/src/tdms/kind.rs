//! Data types, and samples as f64.

use super::value::Timestamp;

/// What a sample is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Nothing; for channels without samples.
    Void,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Bool,
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
        Some(match code {
            0 => Self::Void,
            1 => Self::I8,
            2 => Self::I16,
            3 => Self::I32,
            4 => Self::I64,
            5 => Self::U8,
            6 => Self::U16,
            7 => Self::U32,
            8 => Self::U64,
            9 | 0x19 => Self::F32,
            10 | 0x1A => Self::F64,
            0x20 => Self::Text,
            0x21 => Self::Bool,
            0x44 => Self::Time,
            0x0008_000C => Self::Complex32,
            0x0010_000D => Self::Complex64,
            _ => return None,
        })
    }

    /// From the other code that DAQmx scalers use.
    pub fn from_daqmx_code(code: u32) -> Option<Self> {
        Some(match code {
            0 => Self::U8,
            1 => Self::I8,
            2 => Self::U16,
            3 => Self::I16,
            4 => Self::U32,
            5 => Self::I32,
            6 => Self::U64,
            7 => Self::I64,
            8 => Self::F32,
            9 => Self::F64,
            _ => return None,
        })
    }

    /// Bytes per sample, if all samples take the same.
    pub fn size(self) -> Option<u64> {
        Some(match self {
            Self::Void => 0,
            Self::I8 | Self::U8 | Self::Bool | Self::Line(_) => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 | Self::Complex32 => 8,
            Self::Time | Self::Complex64 => 16,
            Self::Text => return None,
        })
    }

    /// Appends `count` samples that lie `stride` bytes apart. `bytes` begins with the first and ends with the last of them;
    /// where it ends earlier, zeros follow. Time stamps become seconds since `origin`.
    pub fn decode(
        self,
        bytes: &[u8],
        stride: usize,
        count: usize,
        big_endian: bool,
        origin: Timestamp,
        out: &mut Vec<f64>,
    ) {
        macro_rules! number {
            ($type:ty) => {
                if big_endian {
                    spread(bytes, stride, count, out, |b| {
                        <$type>::from_be_bytes(b) as f64
                    })
                } else {
                    spread(bytes, stride, count, out, |b| {
                        <$type>::from_le_bytes(b) as f64
                    })
                }
            };
        }
        match self {
            Self::I8 => number!(i8),
            Self::I16 => number!(i16),
            Self::I32 => number!(i32),
            Self::I64 => number!(i64),
            Self::U8 => number!(u8),
            Self::U16 => number!(u16),
            Self::U32 => number!(u32),
            Self::U64 => number!(u64),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
            Self::Bool => spread(bytes, stride, count, out, |[b]| f64::from(u8::from(b != 0))),
            Self::Line(bit) => spread(bytes, stride, count, out, |[b]| {
                f64::from(b >> (bit & 7) & 1)
            }),
            Self::Time => spread(bytes, stride, count, out, |b| {
                let time = if big_endian {
                    i128::from_be_bytes(b)
                } else {
                    i128::from_le_bytes(b)
                };
                Timestamp(time).seconds_since(origin)
            }),
            // Refused when they are selected.
            Self::Void | Self::Text | Self::Complex32 | Self::Complex64 => {
                out.resize(out.len() + count, f64::NAN);
            }
        }
    }
}

fn spread<const N: usize>(
    bytes: &[u8],
    stride: usize,
    count: usize,
    out: &mut Vec<f64>,
    number: impl Fn([u8; N]) -> f64,
) {
    if stride == N {
        out.extend(
            bytes
                .as_chunks::<N>()
                .0
                .iter()
                .take(count)
                .map(|b| number(*b)),
        );
        return;
    }
    let start = out.len();
    out.resize(start + count, 0.0);
    for (slot, row) in out.iter_mut().skip(start).zip(bytes.chunks(stride.max(1))) {
        if let Some(b) = row.first_chunk::<N>() {
            *slot = number(*b);
        }
    }
}
