//! Writing, whatever the format.

use std::path::Path;

use crate::channel::{Block, Layout};
use crate::error::{Error, Result};

/// A recording being written. Dropped before [`Sink::finish`], it leaves no trace.
pub trait Sink: Send {
    /// Appends the rows of a block, one column per channel of the layout.
    ///
    /// # Errors
    /// [`Error::Io`].
    fn write(&mut self, block: &Block) -> Result<()>;

    /// Completes the file and puts it in its place.
    ///
    /// # Errors
    /// [`Error::Io`]; the old file, if any, is then untouched.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// Starts a recording in the format that the path's extension names: `.csv`, `.csv.gz`, `.parquet`, `.npy`, `.npz`, `.tdms`.
///
/// # Errors
/// [`Error::UnknownFormat`], [`Error::Unsupported`] for a format that is only read, [`Error::Io`].
pub fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    let name = path
        .file_name()
        .map(|n| n.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default();
    if name.ends_with(".csv") || name.ends_with(".csv.gz") {
        crate::text::create(path, layout)
    } else if name.ends_with(".parquet") {
        crate::parquet::create(path, layout)
    } else if name.ends_with(".npy") || name.ends_with(".npz") {
        crate::numpy::create(path, layout)
    } else if name.ends_with(".tdms") {
        crate::tdms::create(path, layout)
    } else if name.ends_with(".mat") {
        Err(Error::unsupported(
            path,
            "writing MATLAB files",
            "write .npz or .csv",
        ))
    } else {
        Err(Error::UnknownFormat {
            path: path.to_owned(),
        })
    }
}
