//! The part of the zip format that NPZ files need: stored and deflated members, and files over 4 GiB.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use super::stream::{Body, Shared, Window};
use crate::error::{Error, Place, Result};

/// A member.
pub struct Member {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub body: Body,
}

/// Largest directory that is read, bytes.
const DIRECTORY: u64 = 1 << 26;
const END: [u8; 4] = *b"PK\x05\x06";
const END_64: [u8; 4] = *b"PK\x06\x06";
const LOCATOR_64: [u8; 4] = *b"PK\x06\x07";
const ENTRY: [u8; 4] = *b"PK\x01\x02";
const LOCAL: [u8; 4] = *b"PK\x03\x04";
/// A 32-bit field whose value is in the 64-bit extension.
const ELSEWHERE: u64 = 0xffff_ffff;

/// Reads numbers of any width at a place; past the end is none.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn number(&self, at: usize, width: usize) -> Option<u64> {
        let bytes = self.0.get(at..at.checked_add(width)?)?;
        Some(
            bytes
                .iter()
                .rev()
                .fold(0, |n, byte| n << 8 | u64::from(*byte)),
        )
    }
}

/// Reads the directory.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`] for encryption and other compressions, [`Error::Io`].
pub fn members(path: &Path, file: &Shared, length: u64) -> Result<Vec<Member>> {
    let read = |at: u64, count: u64| -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let end = at.saturating_add(count).min(length);
        Window::new(file, at, end)
            .read_to_end(&mut bytes)
            .map_err(|source| Error::io(path, source))?;
        Ok(bytes)
    };
    let broken = |at: u64, cause: &str| Error::malformed(path, Place::Byte(at), cause);
    let no_end = || broken(length, "no zip directory at the end; was the file cut?");

    // The end record is followed by a remark of at most 64 KiB.
    let tail_at = length.saturating_sub(22 + 0xffff);
    let tail = read(tail_at, length)?;
    let found = (0..tail.len().saturating_sub(21))
        .rev()
        .find(|&at| tail.get(at..).is_some_and(|t| t.starts_with(&END)));
    let end_at = found.ok_or_else(no_end)?;
    let end = Bytes(tail.get(end_at..).unwrap_or_default());
    let end_at = tail_at + end_at as u64;
    let field = |bytes: &Bytes, at, width| bytes.number(at, width).ok_or_else(no_end);
    let (mut count, mut size, mut begin) = (
        field(&end, 10, 2)?,
        field(&end, 12, 4)?,
        field(&end, 16, 4)?,
    );
    if count == 0xffff || size == ELSEWHERE || begin == ELSEWHERE {
        let locator = read(end_at.saturating_sub(20), 20)?;
        if locator.starts_with(&LOCATOR_64) {
            let record = read(field(&Bytes(&locator), 8, 8)?, 56)?;
            if !record.starts_with(&END_64) {
                return Err(no_end());
            }
            let record = Bytes(&record);
            (count, size, begin) = (
                field(&record, 32, 8)?,
                field(&record, 40, 8)?,
                field(&record, 48, 8)?,
            );
        }
    }
    if size > DIRECTORY || begin.checked_add(size).is_none_or(|end| end > end_at) {
        return Err(broken(end_at, "the zip directory does not fit the file"));
    }
    let directory = read(begin, size)?;
    let mut rest = directory.as_slice();
    let mut members = Vec::new();
    for _ in 0..count {
        let at = begin + (directory.len() - rest.len()) as u64;
        let (entry, used) =
            entry(rest).ok_or_else(|| broken(at, "a broken entry of the zip directory"))?;
        rest = rest.get(used..).unwrap_or_default();
        if entry.flags & 1 != 0 {
            return Err(Error::unsupported(
                path,
                "an encrypted NPZ",
                "decrypt it first",
            ));
        }
        if entry.method != 0 && entry.method != 8 {
            return Err(Error::unsupported(
                path,
                format!("zip compression {}", entry.method),
                "save with numpy.savez or numpy.savez_compressed",
            ));
        }
        let local = read(entry.offset, 30)?;
        let head = Bytes(&local);
        let sizes = head.number(26, 2).zip(head.number(28, 2));
        let (name, extra) = sizes.filter(|_| local.starts_with(&LOCAL)).ok_or_else(|| {
            broken(
                entry.offset,
                "a zip member does not begin where the directory says",
            )
        })?;
        let data = entry.offset + 30 + name + extra;
        // Nothing deflates by more than 1032 to 1.
        let possible = match entry.method {
            0 => entry.packed == entry.bytes,
            _ => entry.bytes / 1040 <= entry.packed,
        };
        if !possible || data.checked_add(entry.packed).is_none_or(|end| end > begin) {
            return Err(broken(
                entry.offset,
                "the sizes of a zip member are impossible",
            ));
        }
        members.push(Member {
            name: entry.name,
            body: Body {
                file: Shared::clone(file),
                begin: data,
                packed: entry.packed,
                bytes: entry.bytes,
                deflated: entry.method == 8,
                crc: Some(entry.crc),
            },
        });
    }
    Ok(members)
}

struct Entry {
    name: String,
    flags: u64,
    method: u64,
    crc: u32,
    packed: u64,
    bytes: u64,
    offset: u64,
}

/// One entry of the directory and its length.
fn entry(bytes: &[u8]) -> Option<(Entry, usize)> {
    if !bytes.starts_with(&ENTRY) {
        return None;
    }
    let field = |at, width| Bytes(bytes).number(at, width);
    let (name, extra, remark) = (
        field(28, 2)? as usize,
        field(30, 2)? as usize,
        field(32, 2)? as usize,
    );
    let (mut packed, mut size, mut offset) = (field(20, 4)?, field(24, 4)?, field(42, 4)?);
    let mut extras = bytes.get(46 + name..46 + name + extra)?;
    while let (Some(id), Some(length)) = (Bytes(extras).number(0, 2), Bytes(extras).number(2, 2)) {
        let end = 4 + length as usize;
        if id == 1 {
            // Only the fields that did not fit, in this order.
            let long = Bytes(extras.get(4..end)?);
            let mut at = 0;
            for value in [&mut size, &mut packed, &mut offset] {
                if *value == ELSEWHERE {
                    *value = long.number(at, 8)?;
                    at += 8;
                }
            }
        }
        extras = extras.get(end..)?;
    }
    let name_bytes = bytes.get(46..46 + name)?;
    let text = match std::str::from_utf8(name_bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => name_bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    let entry = Entry {
        name: text,
        flags: field(8, 2)?,
        method: field(10, 2)?,
        crc: field(16, 4)? as u32,
        packed,
        bytes: size,
        offset: (offset <= u64::MAX / 2).then_some(offset)?,
    };
    Some((entry, 46 + name + extra + remark))
}

/// A zip file of stored members being written.
pub struct Writer<W> {
    output: W,
    /// With the fields for more than 4 GiB.
    long: bool,
    entries: Vec<(String, u64, u64, u32)>,
    at: u64,
}

impl<W: Write + Seek> Writer<W> {
    /// Starts; `long` if the file will have more than 4 GiB.
    pub fn new(output: W, long: bool) -> Self {
        let entries = Vec::new();
        Self {
            output,
            long,
            entries,
            at: 0,
        }
    }

    /// Writes a member whose bytes `put` hands over, exactly `bytes` of them.
    pub fn member(
        &mut self,
        name: &str,
        bytes: u64,
        put: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        if name.len() > 0xffff {
            return Err(io::Error::other("a name too long for a zip member"));
        }
        let offset = self.at;
        let mut head = LOCAL.to_vec();
        self.common(&mut head, name, bytes, 0);
        head.extend(name.bytes());
        if self.long {
            put_numbers(&mut head, &[(1, 2), (16, 2), (bytes, 8), (bytes, 8)]);
        }
        self.output.write_all(&head)?;
        let mut summed = Summed {
            output: &mut self.output,
            crc: flate2::Crc::new(),
        };
        put(&mut summed)?;
        let (crc, count) = (summed.crc.sum(), u64::from(summed.crc.amount()));
        if count != bytes & ELSEWHERE {
            return Err(io::Error::other("a zip member is not as long as was said"));
        }
        self.at += head.len() as u64 + bytes;
        self.output.seek(SeekFrom::Start(offset + 14))?;
        self.output.write_all(&crc.to_le_bytes())?;
        self.output.seek(SeekFrom::Start(self.at))?;
        self.entries.push((name.to_owned(), offset, bytes, crc));
        Ok(())
    }

    /// The fields that a member's own header and its entry in the directory share.
    fn common(&self, head: &mut Vec<u8>, name: &str, bytes: u64, crc: u32) {
        let size = if self.long { ELSEWHERE } else { bytes };
        let extra = match (self.long, head.starts_with(&ENTRY)) {
            (false, _) => 0,
            (true, false) => 20,
            (true, true) => 28,
        };
        // Version 4.5 for long fields; names in UTF-8; stored; 1980-01-01, so that equal recordings give equal files.
        let version = if self.long { 45 } else { 20 };
        let (name, crc) = (name.len() as u64, u64::from(crc));
        let fields = [
            (version, 2),
            (0x800, 2),
            (0, 2),
            (0, 2),
            (0x21, 2),
            (crc, 4),
            (size, 4),
            (size, 4),
        ];
        put_numbers(head, &fields);
        put_numbers(head, &[(name, 2), (extra, 2)]);
    }

    /// Writes the directory and hands the output back.
    pub fn finish(mut self) -> io::Result<W> {
        let begin = self.at;
        let mut directory = Vec::new();
        for (name, offset, bytes, crc) in &self.entries {
            let mut entry = ENTRY.to_vec();
            put_numbers(&mut entry, &[(if self.long { 45 } else { 20 }, 2)]);
            self.common(&mut entry, name, *bytes, *crc);
            let short = if self.long { ELSEWHERE } else { *offset };
            put_numbers(&mut entry, &[(0, 2), (0, 2), (0, 2), (0, 4), (short, 4)]);
            entry.extend(name.bytes());
            if self.long {
                put_numbers(
                    &mut entry,
                    &[(1, 2), (24, 2), (*bytes, 8), (*bytes, 8), (*offset, 8)],
                );
            }
            directory.extend(entry);
        }
        let (count, size) = (self.entries.len() as u64, directory.len() as u64);
        if self.long {
            directory.extend(END_64);
            let (version, whole) = ((45, 2), (count, 8));
            put_numbers(
                &mut directory,
                &[(44, 8), version, version, (0, 4), (0, 4), whole, whole],
            );
            put_numbers(&mut directory, &[(size, 8), (begin, 8)]);
            directory.extend(LOCATOR_64);
            put_numbers(&mut directory, &[(0, 4), (begin + size, 8), (1, 4)]);
        }
        directory.extend(END);
        let (count, size, begin) = match self.long {
            true => (0xffff, ELSEWHERE, ELSEWHERE),
            false => (count, size, begin),
        };
        put_numbers(
            &mut directory,
            &[
                (0, 2),
                (0, 2),
                (count, 2),
                (count, 2),
                (size, 4),
                (begin, 4),
                (0, 2),
            ],
        );
        self.output.write_all(&directory)?;
        self.output.flush()?;
        Ok(self.output)
    }
}

fn put_numbers(into: &mut Vec<u8>, numbers: &[(u64, usize)]) {
    for (number, width) in numbers {
        into.extend(number.to_le_bytes().iter().take(*width));
    }
}

struct Summed<'a, W> {
    output: &'a mut W,
    crc: flate2::Crc,
}

impl<W: Write> Write for Summed<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.output.write(bytes)?;
        self.crc.update(bytes.get(..count).unwrap_or_default());
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
