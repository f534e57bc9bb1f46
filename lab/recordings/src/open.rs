//! Opening and creating files: the format is chosen here.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};
use crate::kind::Kind;
use crate::layout::Layout;
use crate::sink::Sink;
use crate::source::Source;
use crate::whole::check_regular;
use crate::{hdf5, matlab, numpy, parquet, tdms, text};

/// Bytes that are enough to tell the formats apart.
const HEAD: usize = 16;

/// Opens a recording of a format.
type Opener = fn(&Path) -> Result<Box<dyn Source>>;

/// Opens a recording. What it is, its first bytes decide; where they say nothing, its name.
///
/// # Errors
/// [`Error::OtherKind`] for one of the project's other files, [`Error::UnknownFormat`], [`Error::Io`] for what is no regular file, and
/// those of the format.
pub fn open(path: &Path) -> Result<Box<dyn Source>> {
    check_regular(path)?;
    let mut head = Vec::with_capacity(HEAD);
    File::open(path)
        .and_then(|file| file.take(HEAD as u64).read_to_end(&mut head))
        .map_err(|source| Error::io(path, source))?;
    match format_of(path, &head) {
        Some(open) => open(path),
        None => Err(Kind::Recording
            .refuses(path)
            .unwrap_or_else(|| Error::UnknownFormat {
                path: path.to_owned(),
            })),
    }
}

/// How a recording that begins so is opened; none if neither that nor its name says it.
pub(crate) fn format_of(path: &Path, head: &[u8]) -> Option<Opener> {
    let name = file_name(path);
    let named = |extensions: &[&str]| extensions.iter().any(|end| name.ends_with(end));
    Some(if head.starts_with(b"TDSm") {
        tdms::open
    } else if head.starts_with(b"PAR1") {
        parquet::open
    } else if head.starts_with(b"\x93NUMPY") {
        numpy::open_npy
    } else if head.starts_with(b"PK\x03\x04") && name.ends_with(".npz") {
        numpy::open_npz
    } else if head.starts_with(b"\x89HDF\r\n\x1a\n") && !name.ends_with(".mat")
        || named(&[".h5", ".hdf5"])
    {
        hdf5::open
    } else if head.starts_with(b"MATLAB") || name.ends_with(".mat") {
        matlab::open
    } else if head.starts_with(b"\x1f\x8b") || named(&[".csv", ".txt", ".tsv", ".dat", ".lvm"]) {
        text::open
    } else {
        return None;
    })
}

/// Starts a recording in the format that the path's extension names: `.csv`, `.csv.gz`, `.parquet`, `.npy`, `.npz`, `.tdms`.
///
/// # Errors
/// [`Error::Unsupported`] for any other format, [`Error::Io`].
pub fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    let name = file_name(path);
    if name.ends_with(".csv") || name.ends_with(".csv.gz") {
        text::create(path, layout)
    } else if name.ends_with(".parquet") {
        parquet::create(path, layout)
    } else if name.ends_with(".npy") || name.ends_with(".npz") {
        numpy::create(path, layout)
    } else if name.ends_with(".tdms") {
        tdms::create(path, layout)
    } else {
        Err(Error::unsupported(
            path,
            "writing files of this kind",
            "write .csv, .csv.gz, .parquet, .npy, .npz or .tdms",
        ))
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default()
}
