//! The members of an NPZ file: the directory by the crate `zip`, the bytes by [`super::stream`].

use std::path::Path;
use std::sync::PoisonError;

use zip::CompressionMethod;
use zip::read::ZipArchive;
use zip::result::ZipError;

use super::stream::{Body, Shared};
use crate::error::{Error, Place, Result};

/// A member.
pub struct Member {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub body: Body,
}

/// Nothing deflates by more than 1032 to 1.
const DENSEST: u64 = 1040;

/// Reads the directory of a file of `length` bytes.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`] for encryption and other compressions, [`Error::Io`].
pub fn members(path: &Path, file: &Shared, length: u64) -> Result<Vec<Member>> {
    let refused = |error| match error {
        ZipError::Io(source) => super::source::failed(path, None, Place::Whole, source),
        other => Error::malformed(path, Place::Whole, format!("as a zip file: {other}")),
    };
    let guard = file.lock().unwrap_or_else(PoisonError::into_inner);
    let mut archive = ZipArchive::new(&*guard).map_err(refused)?;
    let mut members = Vec::with_capacity(archive.len());
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(refused)?;
        if entry.encrypted() {
            return Err(Error::unsupported(
                path,
                "an encrypted NPZ",
                "decrypt it first",
            ));
        }
        let deflated = match entry.compression() {
            CompressionMethod::Stored => false,
            CompressionMethod::DEFLATE => true,
            other => {
                return Err(Error::unsupported(
                    path,
                    format!("zip compression {other}"),
                    "save with numpy.savez or numpy.savez_compressed",
                ));
            }
        };
        let (packed, bytes) = (entry.compressed_size(), entry.size());
        let possible = match deflated {
            false => packed == bytes,
            true => bytes / DENSEST <= packed,
        };
        let begin = entry.data_start().unwrap_or(length);
        if !possible || begin.checked_add(packed).is_none_or(|end| end > length) {
            return Err(Error::malformed(
                path,
                Place::Byte(entry.header_start()),
                "the sizes of a zip member are impossible",
            ));
        }
        members.push(Member {
            name: String::from_utf8_lossy(entry.name_raw()).into_owned(),
            body: Body {
                file: Shared::clone(file),
                begin,
                packed,
                bytes,
                deflated,
                crc: Some(entry.crc32()),
            },
        });
    }
    Ok(members)
}
