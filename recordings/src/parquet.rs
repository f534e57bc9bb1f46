//! Parquet files.

use std::path::Path;

use crate::channel::Layout;
use crate::error::{Error, Result};
use crate::sink::Sink;
use crate::source::Source;

/// Opens a Parquet file.
///
/// # Errors
/// Those of [`Source`].
pub fn open(path: &Path) -> Result<Box<dyn Source>> {
    Err(Error::unsupported(path, "Parquet", "not yet"))
}

/// Starts a Parquet file.
///
/// # Errors
/// [`Error::Io`].
pub fn create(path: &Path, _layout: &Layout) -> Result<Box<dyn Sink>> {
    Err(Error::unsupported(path, "Parquet", "not yet"))
}
