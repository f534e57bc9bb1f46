//! Reading, whatever the format.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::channel::{Block, Layout};
use crate::error::{Error, Result};

/// An open recording.
pub trait Source: Send {
    /// What is in it.
    fn layout(&self) -> &Layout;

    /// Restricts reading to these channels (indices into [`Layout::channels`]), in this order, and starts again at the first
    /// sample. Without it all channels are read.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if they differ in length; [`Error::NoSuchChannel`] for an index that is not there;
    /// [`Error::Io`].
    fn select(&mut self, channels: &[usize]) -> Result<()>;

    /// Replaces the contents of `block` with the next samples of the selected channels, at most `limit` of them (a source may
    /// return fewer, but none only at the end), and returns their number.
    ///
    /// # Errors
    /// [`Error::Malformed`], [`Error::Io`].
    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize>;
}

/// Bytes that are enough to tell the formats apart.
const HEAD: usize = 16;

/// Opens a recording. What it is, its first bytes decide; where they say nothing, its name.
///
/// # Errors
/// [`Error::UnknownFormat`], and those of the format.
pub fn open(path: &Path) -> Result<Box<dyn Source>> {
    let mut head = Vec::with_capacity(HEAD);
    File::open(path)
        .and_then(|file| file.take(HEAD as u64).read_to_end(&mut head))
        .map_err(|source| Error::io(path, source))?;
    let name = path
        .file_name()
        .map(|n| n.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default();
    if head.starts_with(b"TDSm") {
        crate::tdms::open(path)
    } else if head.starts_with(b"PAR1") {
        crate::parquet::open(path)
    } else if head.starts_with(b"\x93NUMPY") {
        crate::numpy::open_npy(path)
    } else if head.starts_with(b"PK\x03\x04") && name.ends_with(".npz") {
        crate::numpy::open_npz(path)
    } else if head.starts_with(b"MATLAB") || name.ends_with(".mat") {
        crate::matlab::open(path)
    } else if head.starts_with(b"\x1f\x8b")
        || [".csv", ".txt", ".tsv", ".dat", ".lvm"]
            .iter()
            .any(|extension| name.ends_with(extension))
    {
        crate::text::open(path)
    } else {
        Err(Error::UnknownFormat {
            path: path.to_owned(),
        })
    }
}
