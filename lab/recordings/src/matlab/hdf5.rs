//! The part of HDF5 that MATLAB writes: superblock, object headers, groups, B-trees. Addresses and sizes are checked
//! against the file's length before anything is read; groups and continuations that go round in circles are refused.
//!
//! Names of messages and fields are those of the HDF5 file format specification, version 3.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::messages::{Fields, Message, link, text};
use crate::error::{Error, Place, Result};

const SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";
/// Largest piece of description, attributes included. MATLAB's are a few hundred bytes.
const LARGEST_HEADER: u64 = 1 << 24;
/// Address of what is not there.
pub(super) const NOWHERE: u64 = u64::MAX;

const ADVICE: &str = "save it by MATLAB's save with the option -v7.3 or -v7";

/// Where an HDF5 file begins: at 0, 512, 1024, 2048 ... Looked for in the first 64 KiB.
pub(super) fn find(file: &mut File, length: u64) -> io::Result<Option<u64>> {
    let mut at = 0;
    while at + 8 <= length && at <= 1 << 16 {
        let mut signature = [0; 8];
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut signature)?;
        if &signature == SIGNATURE {
            return Ok(Some(at));
        }
        at = if at == 0 { 512 } else { at * 2 };
    }
    Ok(None)
}

/// An HDF5 file. Addresses count from `base`.
#[derive(Debug)]
pub(super) struct Hdf5 {
    pub(super) path: PathBuf,
    file: File,
    length: u64,
    base: u64,
    root: u64,
}

impl Hdf5 {
    /// Opens a file whose superblock stands at `at`.
    pub(super) fn open(path: &Path, file: File, length: u64, at: u64) -> Result<Arc<Self>> {
        let mut hdf5 = Self {
            path: path.to_owned(),
            file,
            length,
            base: 0,
            root: 0,
        };
        let bytes = hdf5.read(at, 104.min(length - at))?;
        let short = || hdf5.malformed(at, "the file ends within its superblock");
        let mut fields = Fields::new(&bytes);
        fields.take(8).ok_or_else(short)?;
        let version = fields.byte().ok_or_else(short)?;
        if version < 2 {
            fields.take(4).ok_or_else(short)?;
        }
        let widths = (fields.byte(), fields.byte());
        if widths != (Some(8), Some(8)) || version > 3 {
            return Err(hdf5.unsupported(&format!(
                "HDF5 superblock {version} with addresses other than of 8 bytes, or newer than 3"
            )));
        }
        let before = match version {
            0 => 9,
            1 => 13,
            _ => 1,
        };
        fields.take(before).ok_or_else(short)?;
        let mut next = || fields.uint(8).ok_or_else(short);
        let base = next()?;
        let _ = next()?;
        let end = next()?;
        let mut root = next()?;
        if version < 2 {
            // The driver's block, then the root's symbol table entry: name, header.
            let _ = next()?;
            root = next()?;
        }
        // The library, too, trusts the place where it finds the superblock more than what that says.
        let end = end.saturating_sub(base).saturating_add(at);
        if end > length {
            return Err(hdf5.malformed(
                length,
                format!("the file ends here, {end} bytes were to come"),
            ));
        }
        (hdf5.base, hdf5.root) = (at, root);
        Ok(Arc::new(hdf5))
    }

    pub(super) fn malformed(&self, at: u64, cause: impl Into<String>) -> Error {
        Error::malformed(&self.path, Place::Byte(at.saturating_add(self.base)), cause)
    }

    pub(super) fn unsupported(&self, feature: &str) -> Error {
        Error::unsupported(&self.path, feature, ADVICE)
    }

    /// Bytes at an address.
    pub(super) fn read(&self, address: u64, count: u64) -> Result<Vec<u8>> {
        let at = address.checked_add(self.base);
        let fits = at
            .and_then(|at| at.checked_add(count))
            .is_some_and(|end| end <= self.length);
        let (Some(at), true, Ok(size)) = (at, fits, usize::try_from(count)) else {
            return Err(self.malformed(
                address,
                format!("{count} bytes are said to be here, beyond the end of the file"),
            ));
        };
        let mut bytes = vec![0; size];
        let mut file = &self.file;
        file.seek(SeekFrom::Start(at))
            .and_then(|_| file.read_exact(&mut bytes))
            .map_err(|source| Error::io(&self.path, source))?;
        Ok(bytes)
    }

    fn read_header(&self, address: u64, count: u64) -> Result<Vec<u8>> {
        if count > LARGEST_HEADER {
            return Err(self.malformed(address, format!("a header of {count} bytes")));
        }
        self.read(address, count)
    }

    /// The messages of an object.
    pub(super) fn object(&self, address: u64) -> Result<Vec<Message>> {
        let start = self.read(
            address,
            16.min(
                self.length
                    .saturating_sub(address.saturating_add(self.base)),
            ),
        )?;
        let broken = || self.malformed(address, "no object header");
        let mut fields = Fields::new(&start);
        let mut blocks = Vec::new();
        let newer = start.starts_with(b"OHDR");
        let mut ordered = false;
        if newer {
            fields.take(4).ok_or_else(broken)?;
            let version = fields.byte().ok_or_else(broken)?;
            let flags = fields.byte().ok_or_else(broken)?;
            if version != 2 {
                return Err(broken());
            }
            ordered = flags & 4 != 0;
            let times = if flags & 0x20 != 0 { 16 } else { 0 };
            let limits = if flags & 0x10 != 0 { 4 } else { 0 };
            let width = 1 << (flags & 3);
            let before = 6 + times + limits;
            let size = self.read(address.saturating_add(before), width)?;
            let size = Fields::new(&size).uint(width as usize).ok_or_else(broken)?;
            blocks.push((address.saturating_add(before + width), size));
        } else {
            if fields.uint(1) != Some(1) {
                return Err(broken());
            }
            fields.take(7).ok_or_else(broken)?;
            let size = fields.uint(4).ok_or_else(broken)?;
            blocks.push((address.saturating_add(16), size));
        }
        let mut messages = Vec::new();
        let mut visited = HashSet::new();
        while let Some((at, size)) = blocks.pop() {
            if !visited.insert(at) {
                return Err(self.malformed(at, "an object header that goes round in circles"));
            }
            let block = self.read_header(at, size)?;
            let mut fields = Fields::new(&block);
            // What is left may be a gap smaller than a message's head.
            while let Some(message) = self.message(&mut fields, at, newer, ordered)? {
                if message.kind == 0x10 {
                    let mut place = Fields::new(&message.body);
                    let (Some(to), Some(count)) = (place.uint(8), place.uint(8)) else {
                        return Err(broken());
                    };
                    // Newer blocks have a signature in front and a checksum behind.
                    let trim = if newer { 4 } else { 0 };
                    blocks.push((to.saturating_add(trim), count.saturating_sub(2 * trim)));
                } else {
                    messages.push(message);
                }
            }
        }
        Ok(messages)
    }

    fn message(
        &self,
        fields: &mut Fields<'_>,
        block: u64,
        newer: bool,
        ordered: bool,
    ) -> Result<Option<Message>> {
        let head = (|| {
            let kind = fields.uint(if newer { 1 } else { 2 })?;
            let size = fields.size(2)?;
            let flags = fields.byte()?;
            fields.take(match (newer, ordered) {
                (false, _) => 3,
                (true, true) => 2,
                (true, false) => 0,
            })?;
            Some((kind as u16, size, flags))
        })();
        let Some((kind, size, flags)) = head else {
            return Ok(None);
        };
        let at = block.saturating_add(fields.at as u64);
        let Some(body) = fields.take(size) else {
            return Err(self.malformed(at, "a message reaches beyond its object header"));
        };
        Ok(Some(Message {
            kind,
            shared: flags & 2 != 0,
            body: body.to_vec(),
            at,
        }))
    }

    /// Names and addresses of what a group holds; nothing if the object is no group. `None` for the root.
    pub(super) fn members(&self, messages: &[Message]) -> Result<Option<Vec<(String, u64)>>> {
        let mut members = Vec::new();
        let mut group = false;
        for message in messages {
            let broken = || self.malformed(message.at, "a broken group");
            let mut fields = Fields::new(&message.body);
            match message.kind {
                // Symbol table: B-tree and heap of names.
                0x11 => {
                    let tree = fields.uint(8).ok_or_else(broken)?;
                    let heap = fields.uint(8).ok_or_else(broken)?;
                    self.symbols(tree, heap, &mut members)?;
                    group = true;
                }
                // Link info: the links may be elsewhere, in a fractal heap.
                0x02 => {
                    let flags = fields
                        .take(2)
                        .and_then(|head| head.get(1))
                        .ok_or_else(broken)?;
                    if flags & 1 != 0 {
                        fields.take(8).ok_or_else(broken)?;
                    }
                    if fields.uint(8).ok_or_else(broken)? != NOWHERE {
                        return Err(self.unsupported("an HDF5 group of the newer, dense kind"));
                    }
                    group = true;
                }
                0x06 => {
                    group = true;
                    members.extend(link(&mut fields).ok_or_else(broken)?);
                }
                _ => {}
            }
        }
        Ok(group.then_some(members))
    }

    pub(super) fn root(&self) -> Result<Vec<Message>> {
        self.object(self.root)
    }

    /// Symbols of a group of the older kind, in the order of the tree, which is that of their names.
    fn symbols(&self, tree: u64, heap: u64, members: &mut Vec<(String, u64)>) -> Result<()> {
        let head = self.read(heap, 32)?;
        let mut fields = Fields::new(&head);
        let names = (|| {
            (fields.take(8)?.starts_with(b"HEAP")).then_some(())?;
            let size = fields.uint(8)?;
            fields.take(8)?;
            Some((fields.uint(8)?, size))
        })();
        let (at, size) = names.ok_or_else(|| self.malformed(heap, "no heap of names"))?;
        let names = self.read_header(at, size)?;
        let leaves = self.tree(tree, 0, 8)?;
        for (_, leaf) in leaves {
            let broken = || self.malformed(leaf, "no symbol table");
            let head = self.read(leaf, 8)?;
            let mut fields = Fields::new(&head);
            let signature = fields.take(6).ok_or_else(broken)?;
            let count = fields.uint(2).ok_or_else(broken)?;
            if !signature.starts_with(b"SNOD") {
                return Err(broken());
            }
            let entries = self.read(leaf.saturating_add(8), count * 40)?;
            for entry in entries.chunks_exact(40) {
                let mut fields = Fields::new(entry);
                let name = fields
                    .size(8)
                    .and_then(|from| names.get(from..))
                    .ok_or_else(broken)?;
                let address = fields.uint(8).ok_or_else(broken)?;
                // Kind 2 is a symbolic link, which has no header.
                if fields.uint(4) != Some(2) {
                    members.push((text(name), address));
                }
            }
        }
        Ok(())
    }

    /// Leaves of a version 1 B-tree: each child with the key before it.
    pub(super) fn tree(&self, root: u64, kind: u8, key: u64) -> Result<Vec<(Vec<u8>, u64)>> {
        let mut leaves = Vec::new();
        let mut visited = HashSet::new();
        let mut open = vec![(root, None)];
        while let Some((node, expected)) = open.pop() {
            let broken = || self.malformed(node, "a broken B-tree");
            if !visited.insert(node) {
                return Err(broken());
            }
            let head = self.read(node, 24)?;
            let mut fields = Fields::new(&head);
            let signature = fields.take(4).ok_or_else(broken)?;
            let node_kind = fields.byte().ok_or_else(broken)?;
            let level = fields.byte().ok_or_else(broken)?;
            let entries = fields.uint(2).ok_or_else(broken)?;
            if signature != b"TREE" || node_kind != kind || expected.is_some_and(|e| e != level) {
                return Err(broken());
            }
            let bytes = self.read(node.saturating_add(24), entries * (key + 8))?;
            let mut fields = Fields::new(&bytes);
            let mut children = Vec::new();
            for _ in 0..entries {
                let key = fields.take(key as usize).ok_or_else(broken)?;
                let child = fields.uint(8).ok_or_else(broken)?;
                if level == 0 {
                    leaves.push((key.to_vec(), child));
                } else {
                    children.push((child, Some(level - 1)));
                }
            }
            // The last one is popped first: reversed, the order of the keys is kept.
            open.extend(children.into_iter().rev());
        }
        Ok(leaves)
    }
}
