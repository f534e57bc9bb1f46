//! NPY files.

use std::path::Path;

use crate::channel::Layout;
use crate::error::{Error, Result};
use crate::sink::Sink;
use crate::source::Source;

/// Opens a NPY file.
///
/// # Errors
/// Those of [`Source`].
pub fn open_npy(path: &Path) -> Result<Box<dyn Source>> {
    Err(Error::unsupported(path, "NPY", "not yet"))
}

/// Starts a NPY file.
///
/// # Errors
/// [`Error::Io`].
pub fn create(path: &Path, _layout: &Layout) -> Result<Box<dyn Sink>> {
    Err(Error::unsupported(path, "NPY", "not yet"))
}

/// Opens an NPZ file.
///
/// # Errors
/// Those of [`Source`].
pub fn open_npz(path: &Path) -> Result<Box<dyn Source>> {
    Err(Error::unsupported(path, "NPZ", "not yet"))
}
