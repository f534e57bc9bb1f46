//! The reader's errors as this crate's.

use std::path::Path;

use hdf5_reader::error::Error as Hdf5Error;

use crate::error::{Error, Place};

/// What a user can do about a feature of HDF5 that is not read.
const ADVICE: &str =
    "save it with plain or gzip-compressed datasets, or as .mat with the option -v7";

/// Why a file is refused: damage, a feature that is not read, or the system's error.
pub(super) fn refused(path: &Path, error: Hdf5Error) -> Error {
    match error {
        Hdf5Error::Io(source) => Error::io(path, source),
        Hdf5Error::Context { source, .. } => refused(path, *source),
        other if is_unsupported(&other) => {
            Error::unsupported(path, format!("HDF5: {other}"), ADVICE)
        }
        other => Error::malformed(path, Place::Whole, other.to_string()),
    }
}

/// Whether a file is sound as far as is known and uses something that is not read.
pub(super) fn is_unsupported(error: &Hdf5Error) -> bool {
    match error {
        Hdf5Error::Context { source, .. } => is_unsupported(source),
        Hdf5Error::UnsupportedEncoding(_)
        | Hdf5Error::UnsupportedFilter(_)
        | Hdf5Error::UnsupportedDatatypeClass(_)
        | Hdf5Error::UnsupportedLayoutClass(_)
        | Hdf5Error::UnsupportedLayoutVersion(_)
        | Hdf5Error::UnsupportedChunkIndexType(_)
        | Hdf5Error::UnsupportedSuperblockVersion(_)
        | Hdf5Error::UnsupportedOffsetSize(_)
        | Hdf5Error::UnsupportedLengthSize(_)
        | Hdf5Error::ResourceLimit(_) => true,
        _ => false,
    }
}
