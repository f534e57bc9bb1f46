//! Files that are read whole: those that people write, and parts of a known size; never a pipe, never more than a limit.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Result};

/// Bytes of a text file at most: sessions, plans and calibrations have a thousandth of it.
pub const MOST_TEXT: u64 = 64 << 20;

/// Refuses what is no regular file. A pipe holds up whoever opens it until somebody writes, a device may never end, and recordings
/// are read more than once.
///
/// # Errors
/// [`Error::Io`].
pub fn check_regular(path: &Path) -> Result<()> {
    let kind = fs::metadata(path)
        .map_err(|source| Error::io(path, source))?
        .file_type();
    if kind.is_file() {
        return Ok(());
    }
    let cause = if kind.is_dir() {
        "a folder, where a file was expected"
    } else {
        "a pipe or a device, where a file was expected: save what it gives to a file first"
    };
    Err(Error::io(path, io::Error::other(cause)))
}

/// The bytes of a regular file of at most so many.
///
/// # Errors
/// [`Error::Io`] for one that cannot be read, is no regular file, or is longer.
pub fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    check_regular(path)?;
    let io = |source| Error::io(path, source);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(io)?;
    file.take(most + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > most {
        let cause = format!(
            "more than {} MiB, which nothing of its kind has",
            most >> 20
        );
        return Err(io(io::Error::other(cause)));
    }
    Ok(bytes)
}

/// The text of a regular file of at most [`MOST_TEXT`] bytes.
///
/// # Errors
/// Those of [`read_bytes`]; [`Error::Io`] for text that is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    String::from_utf8(read_bytes(path, MOST_TEXT)?).map_err(|error| {
        let byte = error.utf8_error().valid_up_to();
        let before = &error.as_bytes()[..byte];
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        let cause = format!("line {line} is not text in UTF-8: save it as UTF-8");
        Error::io(path, io::Error::new(io::ErrorKind::InvalidData, cause))
    })
}
