//! MATLAB files: version 5 to 7 (`save -v6`, `-v7`) and 7.3 (`save -v7.3`, which is [`crate::hdf5`]). They are read, not
//! written.
//!
//! A vector, 1 x N or N x 1, is a channel of the variable's name. A matrix gives one channel for each of its columns, or of
//! its rows where those are longer: `name_1`, `name_2` ... A square matrix could be meant either way and is left out. The
//! fields of a struct are `data.u1`. Scalars and texts become properties; a scalar called `fs`, `fs_hz` or `sample_rate_hz` is
//! the rate of all channels, one in a struct that of the struct's channels. Integers beyond 2^53 are rounded to the nearest
//! f64. Cells, complex numbers, sparse matrices, arrays of structs, objects and tables are no channels; the property
//! [`LEFT_OUT`] names them.
//!
//! Memory: a version 5 file is held whole, unpacked, and refused beyond 2 GiB.

use std::path::Path;

use crate::error::Result;
pub use crate::layout::LEFT_OUT;
use crate::source::Source;

mod v5;

/// Opens a MATLAB file.
///
/// # Errors
/// Those of [`Source`]; [`crate::Error::Unsupported`] for a file of version 4, or one without a numeric vector.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    match crate::hdf5::open_matlab(path)? {
        Some(source) => Ok(source),
        None => v5::open(path),
    }
}
