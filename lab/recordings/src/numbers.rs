//! Stored numbers as f64.

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Kind {
    /// Bytes of one number.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Appends every `stride`-th number of `bytes`, from the first on, at most `count` of them.
    pub(crate) fn append(
        self,
        bytes: &[u8],
        big_endian: bool,
        stride: usize,
        count: usize,
        out: &mut Vec<f64>,
    ) {
        macro_rules! numbers {
            ($type:ty, $value:expr) => {{
                let (words, _) = bytes.as_chunks::<{ size_of::<$type>() }>();
                let words = words.iter().step_by(stride.max(1)).take(count);
                if big_endian {
                    out.extend(words.map(|word| $value(<$type>::from_be_bytes(*word))));
                } else {
                    out.extend(words.map(|word| $value(<$type>::from_le_bytes(*word))));
                }
            }};
        }
        match self {
            Self::I8 => numbers!(i8, f64::from),
            Self::U8 => numbers!(u8, f64::from),
            Self::I16 => numbers!(i16, f64::from),
            Self::U16 => numbers!(u16, f64::from),
            Self::I32 => numbers!(i32, f64::from),
            Self::U32 => numbers!(u32, f64::from),
            Self::I64 => numbers!(i64, |v| v as f64),
            Self::U64 => numbers!(u64, |v| v as f64),
            Self::F32 => numbers!(f32, f64::from),
            Self::F64 => numbers!(f64, f64::from),
        }
    }
}
