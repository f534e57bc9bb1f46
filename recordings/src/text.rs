//! CSV files.

use std::path::Path;

use crate::channel::Layout;
use crate::error::{Error, Result};
use crate::sink::Sink;
use crate::source::Source;

/// Opens a CSV file.
///
/// # Errors
/// Those of [`Source`].
pub fn open(path: &Path) -> Result<Box<dyn Source>> {
    Err(Error::unsupported(path, "CSV", "not yet"))
}

/// Starts a CSV file.
///
/// # Errors
/// [`Error::Io`].
pub fn create(path: &Path, _layout: &Layout) -> Result<Box<dyn Sink>> {
    Err(Error::unsupported(path, "CSV", "not yet"))
}
