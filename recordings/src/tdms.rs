//! TDMS files.

use std::path::Path;

use crate::channel::Layout;
use crate::error::{Error, Result};
use crate::sink::Sink;
use crate::source::Source;

/// Opens a TDMS file.
///
/// # Errors
/// Those of [`Source`].
pub fn open(path: &Path) -> Result<Box<dyn Source>> {
    Err(Error::unsupported(path, "TDMS", "not yet"))
}

/// Starts a TDMS file.
///
/// # Errors
/// [`Error::Io`].
pub fn create(path: &Path, _layout: &Layout) -> Result<Box<dyn Sink>> {
    Err(Error::unsupported(path, "TDMS", "not yet"))
}
