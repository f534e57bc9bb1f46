//! Where the samples of each channel are in a chunk.

use super::kind::Kind;
use super::object::{Object, RawIndex};

/// The samples of one channel in a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Column {
    /// Index of the object.
    pub object: u32,
    pub kind: Kind,
    /// Byte of the first sample in the chunk.
    pub offset: u64,
    /// Samples in the chunk, at least one.
    pub values: u64,
    /// Bytes from one sample to the next.
    pub stride: u64,
}

/// A pattern that raw data repeat. Interleaved data are seen as chunks of one row.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Chunk {
    /// By object.
    pub columns: Vec<Column>,
    pub bytes: u64,
    pub big_endian: bool,
    /// A chunk is a row, so that any number of them may follow.
    pub rows: bool,
}

impl Chunk {
    /// From the objects (by index) that have samples in the segment, in the file's order.
    ///
    /// # Errors
    /// What is wrong.
    pub fn new(
        present: &[u32],
        objects: &[Object],
        interleaved: bool,
        big_endian: bool,
    ) -> Result<Self, String> {
        let indexed: Vec<(u32, &RawIndex)> = present
            .iter()
            .filter_map(|&object| Some((object, objects.get(object as usize)?.raw.as_ref()?)))
            .collect();
        let daqmx = indexed
            .iter()
            .filter(|(_, raw)| raw.daqmx.is_some())
            .count();
        let mut chunk = Self {
            columns: Vec::new(),
            bytes: 0,
            big_endian,
            rows: false,
        };
        if daqmx > 0 {
            if daqmx < indexed.len() {
                return Err("DAQmx raw data and others in one segment".into());
            }
            chunk.add_buffers(&indexed)?;
        } else if interleaved && !(indexed.len() == 1 && indexed[0].1.kind == Kind::Text) {
            chunk.add_row(&indexed)?;
        } else {
            chunk.add_runs(&indexed)?;
        }
        chunk.columns.sort_by_key(|column| column.object);
        Ok(chunk)
    }

    fn add_runs(&mut self, indexed: &[(u32, &RawIndex)]) -> Result<(), String> {
        for &(object, raw) in indexed {
            if raw.values > 0 {
                self.columns.push(Column {
                    object,
                    kind: raw.kind,
                    offset: self.bytes,
                    values: raw.values,
                    stride: raw.kind.size().unwrap_or(0),
                });
            }
            self.bytes = self
                .bytes
                .checked_add(raw.bytes)
                .ok_or("a chunk of more than 2^64 bytes")?;
        }
        Ok(())
    }

    fn add_row(&mut self, indexed: &[(u32, &RawIndex)]) -> Result<(), String> {
        let values = indexed.first().map_or(0, |(_, raw)| raw.values);
        if indexed.iter().any(|(_, raw)| raw.values != values) {
            return Err("interleaved channels of different lengths".into());
        }
        if values == 0 {
            return Ok(());
        }
        for &(object, raw) in indexed {
            let size = raw.kind.size().ok_or("texts in an interleaved segment")?;
            self.columns.push(Column {
                object,
                kind: raw.kind,
                offset: self.bytes,
                values: 1,
                stride: size,
            });
            self.bytes += size;
        }
        self.rows = true;
        Ok(())
    }

    fn add_buffers(&mut self, indexed: &[(u32, &RawIndex)]) -> Result<(), String> {
        let daqmx = || {
            indexed
                .iter()
                .filter_map(|(object, raw)| Some((*object, *raw, raw.daqmx.as_ref()?)))
        };
        let widths = daqmx()
            .next()
            .map(|(_, _, daqmx)| daqmx.widths.clone())
            .unwrap_or_default();
        // Rows of each buffer: those of its longest channel.
        let mut rows = vec![0_u64; widths.len()];
        for (_, raw, daqmx) in daqmx() {
            if daqmx.widths != widths {
                return Err("DAQmx channels that disagree on the widths of the buffers".into());
            }
            for scaler in &daqmx.scalers {
                if let Some(rows) = rows.get_mut(scaler.buffer as usize) {
                    *rows = raw.values.max(*rows);
                }
            }
        }
        let mut starts = Vec::with_capacity(rows.len());
        for (rows, width) in rows.iter().zip(&widths) {
            starts.push(self.bytes);
            self.bytes = rows
                .checked_mul(u64::from(*width))
                .and_then(|bytes| self.bytes.checked_add(bytes))
                .ok_or("a chunk of more than 2^64 bytes")?;
        }
        // One buffer in which all channels have as many rows is an ordinary interleaved table.
        let single = rows.iter().filter(|rows| **rows > 0).count() == 1
            && daqmx().all(|(_, raw, _)| rows.contains(&raw.values) && raw.values > 0);
        for (object, raw, daqmx) in daqmx() {
            let Some(scaler) = daqmx.scalers.first() else {
                continue;
            };
            let at = scaler.buffer as usize;
            let (Some(start), Some(width)) = (starts.get(at), widths.get(at)) else {
                continue;
            };
            if raw.values == 0 {
                continue;
            }
            self.columns.push(Column {
                object,
                kind: scaler.kind,
                offset: start + u64::from(scaler.offset),
                values: if single { 1 } else { raw.values },
                stride: u64::from(*width),
            });
            if single {
                self.bytes = u64::from(*width);
            }
        }
        self.rows = single;
        Ok(())
    }

    /// The column of an object.
    pub fn column(&self, object: u32) -> Option<&Column> {
        self.columns
            .binary_search_by_key(&object, |column| column.object)
            .ok()
            .and_then(|at| self.columns.get(at))
    }

    /// The part of this chunk which fits into `bytes` and which all channels reach; none if it is empty, or if the lengths
    /// of the channels differ anyway.
    pub fn cut(&self, bytes: u64) -> Option<Self> {
        let mut kept = self.common_length()?;
        for column in &self.columns {
            let size = column.kind.size()?;
            let behind_first = bytes.checked_sub(column.offset.checked_add(size)?)?;
            kept = kept.min(behind_first / column.stride.max(1) + 1);
        }
        let mut part = self.clone();
        for column in &mut part.columns {
            column.values = kept;
        }
        part.bytes = bytes;
        Some(part)
    }

    /// This chunk with fewer samples per channel, so that it takes exactly `bytes`; none if that does not come out even.
    pub fn shortened(&self, bytes: u64) -> Option<Self> {
        let length = self.common_length()?;
        if !self.bytes.is_multiple_of(length)
            || self.columns.iter().any(|c| Some(c.stride) != c.kind.size())
        {
            return None;
        }
        let row = self.bytes / length;
        if row == 0 || !bytes.is_multiple_of(row) {
            return None;
        }
        let values = bytes / row;
        let mut part = self.clone();
        for column in &mut part.columns {
            column.offset = column.offset / length * values;
            column.values = values;
        }
        part.bytes = bytes;
        Some(part)
    }

    fn common_length(&self) -> Option<u64> {
        let length = self.columns.first()?.values;
        self.columns
            .iter()
            .all(|c| c.values == length)
            .then_some(length)
    }
}
