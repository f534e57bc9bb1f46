//! What an HDF5 file stores as a number, exactly, and its decoding.

use hdf5_reader::{ByteOrder, Datatype, H5Type};

use crate::numbers::{Kind, Number as Stored};

/// An element of a dataset as f64.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number(pub(super) f64);

/// Type and byte order of plain integers and IEEE floats.
fn stored(datatype: &Datatype) -> Option<Stored> {
    let (kind, order) = match datatype {
        Datatype::FixedPoint {
            size,
            signed,
            byte_order,
        } => {
            let kind = match (size, signed) {
                (1, true) => Kind::I8,
                (1, false) => Kind::U8,
                (2, true) => Kind::I16,
                (2, false) => Kind::U16,
                (4, true) => Kind::I32,
                (4, false) => Kind::U32,
                (8, true) => Kind::I64,
                (8, false) => Kind::U64,
                _ => return None,
            };
            (kind, byte_order)
        }
        Datatype::FloatingPoint {
            size: 4,
            byte_order,
        } => (Kind::F32, byte_order),
        Datatype::FloatingPoint {
            size: 8,
            byte_order,
        } => (Kind::F64, byte_order),
        // An enumeration, such as h5py's booleans, is of the type that it is based on.
        Datatype::Enum { base, .. } => return stored(base),
        _ => return None,
    };
    Some(Stored {
        kind,
        big_endian: *order == ByteOrder::BigEndian,
    })
}

/// Whether the stored description, of which [`Datatype`] keeps only a part, is that of a plain integer or IEEE float: all
/// bits used, exponent and mantissa where IEEE 754 has them. Otherwise a word for what it is.
pub(super) fn plain(datatype: &Datatype, description: &[u8]) -> Result<(), &'static str> {
    let description = match datatype {
        Datatype::Enum { .. } => description.get(8..).unwrap_or_default(),
        _ => description,
    };
    let (head, properties) = description.split_at_checked(8).ok_or("of no known type")?;
    let vax = head.get(1).is_some_and(|bits| bits & 0x41 == 0x41);
    // Integers: bit offset, precision. Floats: the same, exponent place and size, mantissa place and size, bias.
    let expected: &[u8] = match stored(datatype).map(|stored| stored.kind) {
        Some(Kind::F32) if !vax => &[0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0],
        Some(Kind::F64) if !vax => &[0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0],
        Some(Kind::F32 | Kind::F64) => return Err("of floats in VAX order"),
        Some(kind) => &[0, 0, 8 * kind.size() as u8, 0],
        None => {
            return Err(match datatype {
                Datatype::Compound { .. } => "complex or compound",
                Datatype::Reference { .. } => "cell or references",
                Datatype::String { .. } | Datatype::VarLen { .. } => "text",
                Datatype::FixedPoint { .. } => "of integers of unusual size",
                Datatype::FloatingPoint { .. } => "of unusual floats",
                _ => "of no numbers",
            });
        }
    };
    if properties.starts_with(expected) {
        Ok(())
    } else {
        Err("of padded integers or unusual floats")
    }
}

impl H5Type for Number {
    fn hdf5_type() -> Datatype {
        Datatype::FloatingPoint {
            size: 8,
            byte_order: ByteOrder::LittleEndian,
        }
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> hdf5_reader::error::Result<Self> {
        let decoded = Self::decode_vec(bytes, datatype, 1).transpose()?;
        let one = decoded.and_then(|values| values.first().copied());
        one.ok_or_else(|| {
            hdf5_reader::error::Error::InvalidData("an element that is no number".to_owned())
        })
    }

    fn element_size(datatype: &Datatype) -> usize {
        stored(datatype).map_or(0, |stored| stored.kind.size())
    }

    fn decode_vec(
        raw: &[u8],
        datatype: &Datatype,
        count: usize,
    ) -> Option<hdf5_reader::error::Result<Vec<Self>>> {
        let stored = stored(datatype)?;
        let mut values = Vec::with_capacity(count);
        stored.append(raw, stored.kind.size(), count, &mut values);
        Some(Ok(values.into_iter().map(Self).collect()))
    }
}
