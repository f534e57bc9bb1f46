//! Bounded reading of metadata, either byte order.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::{Error, Place, Result};

/// A place in the file, and the end of the section that it may not leave.
pub struct Cursor {
    path: PathBuf,
    reader: BufReader<File>,
    at: u64,
    end: u64,
    /// Byte order of the current segment.
    pub big_endian: bool,
}

impl Cursor {
    pub fn new(path: &Path, file: File) -> Self {
        Self {
            path: path.to_owned(),
            reader: BufReader::new(file),
            at: 0,
            end: 0,
            big_endian: false,
        }
    }

    pub fn into_file(self) -> File {
        self.reader.into_inner()
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Goes to the section from `start` to `end`.
    pub fn section(&mut self, start: u64, end: u64) -> Result<()> {
        // Relative, so that what is already buffered is not read again: small segments are many.
        match i64::try_from(i128::from(start) - i128::from(self.at)) {
            Ok(step) => self.reader.seek_relative(step),
            Err(_) => self.reader.seek(SeekFrom::Start(start)).map(|_| ()),
        }
        .map_err(|source| Error::io(&self.path, source))?;
        self.at = start;
        self.end = end;
        Ok(())
    }

    /// Bytes left in the section.
    pub fn left(&self) -> u64 {
        self.end.saturating_sub(self.at)
    }

    /// A broken rule at this place.
    pub fn malformed(&self, cause: impl Into<String>) -> Error {
        Error::malformed(&self.path, Place::Byte(self.at), cause)
    }

    fn claim(&mut self, bytes: u64) -> Result<()> {
        if bytes > self.left() {
            return Err(self.malformed(format!(
                "{bytes} bytes of metadata are announced, {} are left in this section",
                self.left()
            )));
        }
        Ok(())
    }

    pub fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        self.claim(N as u64)?;
        let mut bytes = [0; N];
        self.reader
            .read_exact(&mut bytes)
            .map_err(|source| Error::io(&self.path, source))?;
        self.at += N as u64;
        Ok(bytes)
    }

    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32> {
        let bytes = self.array()?;
        Ok(if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }

    pub fn u64(&mut self) -> Result<u64> {
        let bytes = self.array()?;
        Ok(if self.big_endian {
            u64::from_be_bytes(bytes)
        } else {
            u64::from_le_bytes(bytes)
        })
    }

    pub fn bytes(&mut self, count: u64) -> Result<Vec<u8>> {
        self.claim(count)?;
        let mut bytes = vec![0; count as usize];
        self.reader
            .read_exact(&mut bytes)
            .map_err(|source| Error::io(&self.path, source))?;
        self.at += count;
        Ok(bytes)
    }

    /// A text with its length before it. Bytes that are not UTF-8 become replacement characters.
    pub fn text(&mut self) -> Result<String> {
        let length = self.u32()?;
        let bytes = self.bytes(u64::from(length))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
