//! Stored numbers as f64: the one decoder of all binary formats.

use half::f16;

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    /// IEEE half precision.
    F16,
    F32,
    F64,
    /// A byte: 0, or else 1.
    Bool,
}

impl Kind {
    /// Bytes of one number.
    pub(crate) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// How a number is stored, and in which byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Number {
    pub(crate) kind: Kind,
    /// Most significant byte first.
    pub(crate) big_endian: bool,
}

impl Number {
    /// Appends numbers that lie `stride` bytes apart, the first at the beginning of `bytes`: `count` of them, or as many as
    /// there are. 64-bit integers are rounded to the nearest f64.
    pub(crate) fn append(self, bytes: &[u8], stride: usize, count: usize, out: &mut Vec<f64>) {
        macro_rules! numbers {
            ($type:ty, $value:expr) => {
                if self.big_endian {
                    spread(bytes, stride, count, out, |b| {
                        $value(<$type>::from_be_bytes(b))
                    })
                } else {
                    spread(bytes, stride, count, out, |b| {
                        $value(<$type>::from_le_bytes(b))
                    })
                }
            };
        }
        match self.kind {
            Kind::I8 => numbers!(i8, f64::from),
            Kind::U8 => numbers!(u8, f64::from),
            Kind::I16 => numbers!(i16, f64::from),
            Kind::U16 => numbers!(u16, f64::from),
            Kind::I32 => numbers!(i32, f64::from),
            Kind::U32 => numbers!(u32, f64::from),
            Kind::I64 => numbers!(i64, |v| v as f64),
            Kind::U64 => numbers!(u64, |v| v as f64),
            Kind::F16 => numbers!(f16, f16::to_f64),
            Kind::F32 => numbers!(f32, f64::from),
            Kind::F64 => numbers!(f64, f64::from),
            Kind::Bool => numbers!(u8, |v| f64::from(u8::from(v != 0))),
        }
    }

    /// The first of the numbers that [`Self::append`] would have to round, counted from 0.
    pub(crate) fn first_rounded(self, bytes: &[u8], stride: usize, count: usize) -> Option<usize> {
        if !matches!(self.kind, Kind::I64 | Kind::U64) {
            return None;
        }
        let mut rows = bytes.chunks(stride.max(1)).take(count);
        rows.position(|row| {
            self.integer(row)
                .is_some_and(|exact| exact as f64 as i128 != exact)
        })
    }

    /// The integer at the beginning of `bytes`. None if it is no integer.
    pub(crate) fn integer(self, bytes: &[u8]) -> Option<i128> {
        macro_rules! integer {
            ($type:ty) => {{
                let word = bytes.first_chunk().copied()?;
                Some(i128::from(if self.big_endian {
                    <$type>::from_be_bytes(word)
                } else {
                    <$type>::from_le_bytes(word)
                }))
            }};
        }
        match self.kind {
            Kind::I8 => integer!(i8),
            Kind::U8 => integer!(u8),
            Kind::I16 => integer!(i16),
            Kind::U16 => integer!(u16),
            Kind::I32 => integer!(i32),
            Kind::U32 => integer!(u32),
            Kind::I64 => integer!(i64),
            Kind::U64 => integer!(u64),
            Kind::F16 | Kind::F32 | Kind::F64 | Kind::Bool => None,
        }
    }
}

/// Appends what stands at the beginning of every `stride` bytes, as many as are wanted and there are.
pub(crate) fn spread<const N: usize>(
    bytes: &[u8],
    stride: usize,
    count: usize,
    out: &mut Vec<f64>,
    number: impl Fn([u8; N]) -> f64,
) {
    if stride == N {
        // Known distances are what the compiler can make vector instructions of.
        let (words, _) = bytes.as_chunks::<N>();
        out.extend(words.iter().take(count).map(|word| number(*word)));
    } else {
        let rows = bytes.chunks(stride.max(1)).take(count);
        let words = rows.filter_map(|row| row.first_chunk::<N>());
        out.extend(words.map(|word| number(*word)));
    }
}
