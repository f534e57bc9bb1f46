//! Lead-ins and object lists, segment after segment.

use std::collections::HashMap;
use std::fs::File;

use super::chunk::Chunk;
use super::cursor::Cursor;
use super::daqmx::{DIGITAL_LINE, Daqmx, FORMAT_CHANGING};
use super::index::{Index, Run};
use super::kind::Kind;
use super::object::{Object, RawIndex, split_path};
use super::value::Value;
use crate::error::{Error, Place, Result};

const LEAD_IN: u64 = 28;
const HAS_METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const HAS_RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const NO_RAW_INDEX: u32 = 0xFFFF_FFFF;
const SAME_RAW_INDEX: u32 = 0;
const UNKNOWN_LENGTH: u64 = u64::MAX;

/// Columns in all layouts together. Without a bound a file of a few megabytes could fill the memory.
const MAX_COLUMNS: usize = 4_000_000;
/// Object list entries gone through again because one of them changed, beyond those which the file spells out (at least 8
/// bytes each); bounds the time likewise.
const MAX_REVISITS: u64 = 100_000_000;

/// The state that segments hand on to each other.
pub struct Walk {
    cursor: Cursor,
    length: u64,
    index: Index,
    by_path: HashMap<String, u32>,
    /// Objects of the current list, each with whether it has samples.
    list: Vec<(u32, bool)>,
    /// Place of an object in the list.
    places: HashMap<u32, usize>,
    started: bool,
    /// Layout of the current list under these flags, unless something changed since.
    current: Option<(u32, u32)>,
    /// Chunks of each layout.
    chunks: Vec<u64>,
    columns: usize,
    revisits: u64,
}

impl Walk {
    pub fn new(cursor: Cursor, length: u64) -> Self {
        Self {
            cursor,
            length,
            index: Index::default(),
            by_path: HashMap::new(),
            list: Vec::new(),
            places: HashMap::new(),
            started: false,
            current: None,
            chunks: Vec::new(),
            columns: 0,
            revisits: 0,
        }
    }

    /// All segments, and hands back the file.
    pub fn all(mut self) -> Result<(Index, File)> {
        let mut at = 0;
        while at < self.length {
            match self.segment(at)? {
                Some(next) => at = next,
                None => {
                    self.index.incomplete = true;
                    break;
                }
            }
        }
        for (layout, chunks) in self.index.layouts.iter().zip(&self.chunks) {
            for column in &layout.columns {
                let object = &mut self.index.objects[column.object as usize];
                let samples = column.values.saturating_mul(*chunks);
                object.samples = object.samples.saturating_add(samples);
            }
        }
        Ok((self.index, self.cursor.into_file()))
    }

    /// One segment; the byte where the next begins, or none if it ends within its lead-in or its metadata.
    fn segment(&mut self, at: u64) -> Result<Option<u64>> {
        if self.length - at < LEAD_IN {
            return Ok(None);
        }
        self.cursor.section(at, at + LEAD_IN)?;
        if self.cursor.array()? != *b"TDSm" {
            let cause = "a segment should begin here (TDSm), but does not";
            return Err(Error::malformed(self.cursor.path(), Place::Byte(at), cause));
        }
        // This word alone is always little-endian.
        let flags = u32::from_le_bytes(self.cursor.array()?);
        self.cursor.big_endian = flags & BIG_ENDIAN != 0;
        let version = self.cursor.u32()?;
        if !matches!(version, 4712 | 4713) {
            return Err(Error::unsupported(
                self.cursor.path(),
                format!("TDMS version {version} (segment at byte {at})"),
                "versions 4712 and 4713 are read; convert the file with LabVIEW or DIAdem",
            ));
        }
        let length = self.cursor.u64()?;
        let metadata = self.cursor.u64()?;
        let data = at
            .checked_add(LEAD_IN)
            .and_then(|start| start.checked_add(metadata));
        let (end, cut) = match at.checked_add(LEAD_IN).and_then(|a| a.checked_add(length)) {
            Some(end) if length != UNKNOWN_LENGTH && end <= self.length => (end, false),
            _ => (self.length, true),
        };
        let Some(data) = data.filter(|data| *data <= end) else {
            return if cut {
                Ok(None)
            } else {
                Err(self
                    .cursor
                    .malformed("the metadata are longer than their segment"))
            };
        };
        self.index.incomplete = cut;
        self.cursor.section(at + LEAD_IN, data)?;
        if flags & HAS_METADATA != 0 {
            self.metadata(flags & NEW_OBJECTS != 0)?;
        } else if !self.started {
            return Err(self.cursor.malformed("the first segment has no metadata"));
        }
        self.started = true;
        let bytes = end - data;
        if flags & HAS_RAW_DATA != 0 {
            self.raw_data(data, bytes, cut, flags & (INTERLEAVED | BIG_ENDIAN))?;
        } else if bytes > 0 && !cut {
            return Err(Error::malformed(
                self.cursor.path(),
                Place::Byte(data),
                format!("{bytes} bytes of raw data in a segment that says it has none"),
            ));
        }
        Ok(Some(end))
    }

    /// The object list of a segment.
    fn metadata(&mut self, new_objects: bool) -> Result<()> {
        if new_objects || !self.started {
            self.list.clear();
            self.places.clear();
            self.current = None;
        }
        for _ in 0..self.cursor.u32()? {
            let object = self.object()?;
            let present = self.raw_index(object)?;
            match self
                .places
                .get(&object)
                .and_then(|place| self.list.get_mut(*place))
            {
                Some(entry) => {
                    if entry.1 != present {
                        entry.1 = present;
                        self.current = None;
                    }
                }
                None => {
                    self.places.insert(object, self.list.len());
                    self.list.push((object, present));
                    self.current = None;
                }
            }
            for _ in 0..self.cursor.u32()? {
                let name = self.cursor.text()?;
                let value = Value::read(&mut self.cursor)?;
                if let Some(object) = self.index.objects.get_mut(object as usize) {
                    object.properties.insert(name, value);
                }
            }
        }
        Ok(())
    }

    /// Reads a path; the object's index.
    fn object(&mut self) -> Result<u32> {
        let path = self.cursor.text()?;
        if let Some(object) = self.by_path.get(&path) {
            return Ok(*object);
        }
        let Some(names) = split_path(&path) else {
            return Err(self
                .cursor
                .malformed(format!("{path:?} is not the path of an object")));
        };
        let object = u32::try_from(self.index.objects.len())
            .map_err(|_| self.cursor.malformed("more than 2^32 objects"))?;
        self.index.objects.push(Object {
            names,
            ..Object::default()
        });
        self.by_path.insert(path, object);
        Ok(object)
    }

    /// Reads how an object's samples lie; whether it has some in this segment.
    fn raw_index(&mut self, object: u32) -> Result<bool> {
        let header = self.cursor.u32()?;
        if header == NO_RAW_INDEX {
            return Ok(false);
        }
        if header == SAME_RAW_INDEX {
            return match self.known_index(object) {
                Some(_) => Ok(true),
                None => Err(self.cursor.malformed(
                    "raw data as in the segment before, but none were there for this object",
                )),
            };
        }
        let raw = match header {
            FORMAT_CHANGING | DIGITAL_LINE => Daqmx::read(&mut self.cursor, header)?,
            _ => self.plain_index(header)?,
        };
        let known = self.known_index(object);
        if known == Some(&raw) {
            return Ok(true);
        }
        if known.is_some_and(|known| !known.continues(&raw)) {
            return Err(self
                .cursor
                .malformed("a channel that changes its data type"));
        }
        if let Some(object) = self.index.objects.get_mut(object as usize) {
            object.raw = Some(raw);
        }
        self.current = None;
        Ok(true)
    }

    fn known_index(&self, object: u32) -> Option<&RawIndex> {
        self.index.objects.get(object as usize)?.raw.as_ref()
    }

    fn plain_index(&mut self, header: u32) -> Result<RawIndex> {
        let code = self.cursor.u32()?;
        let Some(kind) = Kind::from_code(code) else {
            return Err(Error::unsupported(
                self.cursor.path(),
                format!("a channel of TDMS data type 0x{code:X}"),
                "write the channel as DBL or SGL, or convert the file with LabVIEW or DIAdem",
            ));
        };
        if header != if kind == Kind::Text { 28 } else { 20 } {
            return Err(self
                .cursor
                .malformed(format!("a raw data index of {header} bytes")));
        }
        if self.cursor.u32()? != 1 {
            return Err(self.cursor.malformed("samples of more than one dimension"));
        }
        let values = self.cursor.u64()?;
        let bytes = match kind.size() {
            None => Some(self.cursor.u64()?),
            Some(0) if values > 0 => None,
            Some(size) => values.checked_mul(size),
        };
        let Some(bytes) = bytes else {
            return Err(self
                .cursor
                .malformed(format!("{values} samples in a chunk")));
        };
        Ok(RawIndex {
            kind,
            values,
            bytes,
            daqmx: None,
        })
    }

    /// Adds the raw data of a segment to the runs.
    fn raw_data(&mut self, at: u64, bytes: u64, cut: bool, flags: u32) -> Result<()> {
        if bytes == 0 {
            return Ok(());
        }
        let id = match self.current {
            Some((known, id)) if known == flags => id,
            _ => {
                self.revisits += self.list.len() as u64;
                if self.revisits > MAX_REVISITS + self.length / 8 {
                    return Err(self.restless());
                }
                let present: Vec<u32> = self
                    .list
                    .iter()
                    .filter(|(_, present)| *present)
                    .map(|(object, _)| *object)
                    .collect();
                let chunk = Chunk::new(
                    &present,
                    &self.index.objects,
                    flags & INTERLEAVED != 0,
                    flags & BIG_ENDIAN != 0,
                )
                .map_err(|cause| Error::malformed(self.cursor.path(), Place::Byte(at), cause))?;
                let id = self.intern(chunk)?;
                self.current = Some((flags, id));
                id
            }
        };
        let Some(chunk) = self.index.layouts.get_index(id as usize) else {
            return Ok(());
        };
        if chunk.bytes == 0 {
            let cause = format!("{bytes} bytes of raw data, but no channel that has any");
            return Err(Error::malformed(self.cursor.path(), Place::Byte(at), cause));
        }
        let (chunks, rest) = (bytes / chunk.bytes, bytes % chunk.bytes);
        let last = match (rest, cut) {
            (0, _) => None,
            (_, true) if chunk.rows => None,
            (_, true) => chunk.cut(rest),
            (_, false) => match chunk.shortened(rest) {
                Some(part) if !chunk.rows => Some(part),
                _ => {
                    let cause = format!(
                        "{bytes} bytes of raw data are no multiple of the {} per chunk",
                        chunk.bytes
                    );
                    return Err(Error::malformed(self.cursor.path(), Place::Byte(at), cause));
                }
            },
        };
        let behind = at + (bytes - rest);
        self.push(Run {
            at,
            chunks,
            layout: id,
        });
        if let Some(part) = last {
            let layout = self.intern(part)?;
            self.push(Run {
                at: behind,
                chunks: 1,
                layout,
            });
        }
        Ok(())
    }

    fn push(&mut self, run: Run) {
        if run.chunks > 0 {
            if let Some(chunks) = self.chunks.get_mut(run.layout as usize) {
                *chunks += run.chunks;
            }
            self.index.runs.push(run);
        }
    }

    /// The number of a layout, an old one if it was there before.
    fn intern(&mut self, chunk: Chunk) -> Result<u32> {
        let columns = chunk.columns.len();
        let (id, new) = self.index.layouts.insert_full(chunk);
        if new {
            self.columns += columns;
            if self.columns > MAX_COLUMNS {
                return Err(self.restless());
            }
            self.chunks.push(0);
        }
        u32::try_from(id).map_err(|_| self.cursor.malformed("more than 2^32 layouts"))
    }

    fn restless(&self) -> Error {
        Error::unsupported(
            self.cursor.path(),
            "a file whose layout changes this often",
            "defragment it with LabVIEW's TDMS Defragment",
        )
    }
}
