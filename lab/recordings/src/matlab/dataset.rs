//! Numbers of an HDF5 dataset, chunk by chunk.

use std::collections::{HashMap, VecDeque};
use std::io::Read;
use std::sync::Arc;

use flate2::read::ZlibDecoder;

use super::hdf5::{Hdf5, NOWHERE};
use super::messages::{Fields, Message, dimensions, filters, number};
use super::numbers::Kind;
use super::variables::Elements;
use crate::error::{Error, Result};

/// Largest chunk that is unpacked.
const LARGEST_CHUNK: u64 = 1 << 28;
/// Unpacked chunks that are kept of one dataset, bytes.
const KEPT: usize = 1 << 26;
/// Elements that are read at once where they are not adjacent.
const PIECE: u64 = 1 << 16;

const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const FLETCHER32: u16 = 3;

/// A dataset of numbers with at most two dimensions.
pub(super) struct Dataset {
    file: Arc<Hdf5>,
    /// Where its description stands.
    at: u64,
    /// Slow and fast dimension as HDF5 has them: MATLAB's columns and rows.
    pub(super) columns: u64,
    pub(super) rows: u64,
    kind: Kind,
    big_endian: bool,
    store: Store,
}

enum Store {
    Compact(Vec<u8>),
    Contiguous(u64),
    Chunked(Chunked),
}

struct Chunked {
    tree: u64,
    /// Dimensions as in the file, 1 or 2 of them.
    rank: usize,
    columns: u64,
    rows: u64,
    filters: Vec<u16>,
    index: Option<HashMap<(u64, u64), Stored>>,
    /// Unpacked ones, the latest first.
    kept: VecDeque<((u64, u64), Vec<u8>)>,
}

#[derive(Clone, Copy)]
struct Stored {
    address: u64,
    size: u64,
    /// Filters that were left out.
    skipped: u64,
}

/// Numbers or something else, by its name.
pub(super) type Described = std::result::Result<Dataset, String>;

/// What the messages of an object say of its numbers.
///
/// # Errors
/// [`Error::Malformed`]; [`Error::Unsupported`] for a storage that MATLAB does not use.
pub(super) fn describe(file: &Arc<Hdf5>, messages: &[Message]) -> Result<Described> {
    let message = |kind: u16| messages.iter().find(|message| message.kind == kind);
    let (Some(space), Some(kind), Some(layout)) = (message(0x01), message(0x03), message(0x08))
    else {
        return Ok(Err("no array".to_owned()));
    };
    let broken =
        |message: &Message, what: &str| file.malformed(message.at, format!("a broken {what}"));
    let Some(dimensions) = dimensions(&space.body) else {
        return Err(broken(space, "dataspace"));
    };
    let (columns, rows) = match *dimensions.as_slice() {
        [] => (1, 1),
        [rows] => (1, rows),
        [columns, rows] => (columns, rows),
        _ => return Ok(Err("of more than two dimensions".to_owned())),
    };
    if kind.shared {
        return Ok(Err("of a named type".to_owned()));
    }
    let (kind, big_endian) = match number(&kind.body) {
        Some(Ok(number)) => number,
        Some(Err(name)) => return Ok(Err(name.to_owned())),
        None => return Err(broken(kind, "datatype")),
    };
    let Some(bytes) = columns
        .checked_mul(rows)
        .and_then(|count| count.checked_mul(kind.size() as u64))
    else {
        return Err(broken(space, "dataspace: more elements than can be"));
    };
    let mut fields = Fields::new(&layout.body);
    let short = || broken(layout, "layout");
    let version = fields.byte().ok_or_else(short)?;
    let class = fields.byte().ok_or_else(short)?;
    let store = match (version, class) {
        (3 | 4, 0) => {
            let size = fields.size(2).ok_or_else(short)?;
            Store::Compact(fields.take(size).ok_or_else(short)?.to_vec())
        }
        (3 | 4, 1) => {
            let address = fields.uint(8).ok_or_else(short)?;
            let size = fields.uint(8).ok_or_else(short)?;
            if bytes > 0 && (address == NOWHERE || size < bytes) {
                return Err(
                    file.malformed(layout.at, "a variable whose numbers were never written")
                );
            }
            Store::Contiguous(address)
        }
        (3, 2) => {
            let rank = usize::from(fields.byte().ok_or_else(short)?);
            let tree = fields.uint(8).ok_or_else(short)?;
            let edges: Option<Vec<_>> = (0..rank).map(|_| fields.uint(4)).collect();
            let edges = edges.ok_or_else(short)?;
            let (columns, rows, size) = match *edges.as_slice() {
                [rows, size] if dimensions.len() == 1 => (1, rows, size),
                [columns, rows, size] if dimensions.len() == 2 => (columns, rows, size),
                _ => return Err(short()),
            };
            let whole = columns.checked_mul(rows).and_then(|n| n.checked_mul(size));
            if columns == 0
                || rows == 0
                || size != kind.size() as u64
                || whole.is_none_or(|n| n > LARGEST_CHUNK)
            {
                return Err(short());
            }
            let filters = match message(0x0b) {
                Some(pipeline) => {
                    filters(&pipeline.body).ok_or_else(|| broken(pipeline, "filter pipeline"))?
                }
                None => Vec::new(),
            };
            if let Some(other) = filters
                .iter()
                .find(|id| !matches!(**id, DEFLATE | SHUFFLE | FLETCHER32))
            {
                return Err(file.unsupported(&format!("HDF5 filter {other}")));
            }
            Store::Chunked(Chunked {
                tree,
                rank: dimensions.len(),
                columns,
                rows,
                filters,
                index: None,
                kept: VecDeque::new(),
            })
        }
        _ => return Err(file.unsupported(&format!("HDF5 layout {version}.{class}"))),
    };
    if let Store::Compact(data) = &store
        && (data.len() as u64) < bytes
    {
        return Err(short());
    }
    Ok(Ok(Dataset {
        file: Arc::clone(file),
        at: layout.at,
        columns,
        rows,
        kind,
        big_endian,
        store,
    }))
}

impl Chunked {
    fn index(&mut self, file: &Hdf5) -> Result<&HashMap<(u64, u64), Stored>> {
        if self.index.is_none() {
            // Key: size, skipped filters, offset in each dimension and within the element.
            let key = 8 + 8 * (self.rank as u64 + 1);
            let mut index = HashMap::new();
            for (key, address) in file.tree(self.tree, 1, key)? {
                let mut fields = Fields::new(&key);
                let entry = (|| {
                    let (size, skipped) = (fields.uint(4)?, fields.uint(4)?);
                    let column = if self.rank == 2 { fields.uint(8)? } else { 0 };
                    let row = fields.uint(8)?;
                    let stored = Stored {
                        address,
                        size,
                        skipped,
                    };
                    Some(((column / self.columns, row / self.rows), stored))
                })();
                index.extend(entry);
            }
            self.index = Some(index);
        }
        Ok(self.index.get_or_insert_default())
    }

    /// Brings a chunk to the front of those kept.
    fn fetch(&mut self, file: &Hdf5, at: u64, which: (u64, u64), element: usize) -> Result<()> {
        if let Some(place) = self.kept.iter().position(|(id, _)| *id == which) {
            if place > 0
                && let Some(chunk) = self.kept.remove(place)
            {
                self.kept.push_front(chunk);
            }
            return Ok(());
        }
        let Some(&stored) = self.index(file)?.get(&which) else {
            return Err(file.malformed(at, "a piece of a variable that was never written"));
        };
        let size = (self.columns * self.rows) as usize * element;
        let bytes = self.unpack(file, stored, size, element)?;
        let mut kept = bytes.len();
        self.kept.retain(|(_, other)| {
            kept += other.len();
            kept <= KEPT
        });
        self.kept.push_front((which, bytes));
        Ok(())
    }

    fn unpack(&self, file: &Hdf5, stored: Stored, size: usize, element: usize) -> Result<Vec<u8>> {
        let broken = |cause: String| file.malformed(stored.address, cause);
        let mut bytes = file.read(stored.address, stored.size)?;
        for (place, filter) in self.filters.iter().enumerate().rev() {
            if stored.skipped >> place.min(63) & 1 != 0 {
                continue;
            }
            match *filter {
                DEFLATE => {
                    let mut unpacked = Vec::new();
                    ZlibDecoder::new(bytes.as_slice())
                        .take(size as u64 + 8)
                        .read_to_end(&mut unpacked)
                        .map_err(|error| broken(format!("a compressed piece: {error}")))?;
                    bytes = unpacked;
                }
                SHUFFLE => bytes = unshuffle(&bytes, element),
                _ => bytes.truncate(bytes.len().saturating_sub(4)),
            }
        }
        if bytes.len() != size {
            return Err(broken(format!(
                "a piece of {} bytes where {size} belong",
                bytes.len()
            )));
        }
        Ok(bytes)
    }
}

/// First all first bytes, then all second ones ... become elements again.
fn unshuffle(bytes: &[u8], element: usize) -> Vec<u8> {
    let count = bytes.len() / element.max(1);
    let mut whole = bytes.to_vec();
    if count > 0 {
        for (place, plane) in bytes.chunks_exact(count).take(element).enumerate() {
            for (to, from) in whole.iter_mut().skip(place).step_by(element).zip(plane) {
                *to = *from;
            }
        }
    }
    whole
}

impl Elements for Dataset {
    fn append(&mut self, first: u64, stride: u64, count: usize, out: &mut Vec<f64>) -> Result<()> {
        let element = self.kind.size();
        let stride = stride.max(1);
        let (mut at, mut left) = (first, count);
        while left > 0 {
            let before = out.len();
            match &mut self.store {
                Store::Compact(data) => {
                    let from = usize::try_from(at)
                        .ok()
                        .and_then(|at| at.checked_mul(element));
                    let bytes = from.and_then(|from| data.get(from..)).unwrap_or_default();
                    let stride = usize::try_from(stride).unwrap_or(usize::MAX);
                    self.kind.append(bytes, self.big_endian, stride, left, out);
                }
                Store::Contiguous(address) => {
                    let taken = (left as u64).min(PIECE.div_ceil(stride));
                    let span = (taken - 1).saturating_mul(stride).saturating_add(1);
                    let from = address.saturating_add(at.saturating_mul(element as u64));
                    let bytes = self.file.read(from, span.saturating_mul(element as u64))?;
                    let stride = usize::try_from(stride).unwrap_or(usize::MAX);
                    self.kind.append(&bytes, self.big_endian, stride, left, out);
                }
                Store::Chunked(chunked) => {
                    let (column, row) = (at / self.rows.max(1), at % self.rows.max(1));
                    let which = (column / chunked.columns, row / chunked.rows);
                    chunked.fetch(&self.file, self.at, which, element)?;
                    let (inner_column, inner_row) = (column % chunked.columns, row % chunked.rows);
                    // As many as the chunk holds along the direction of the channel.
                    let (inside, step) = if stride == 1 {
                        ((chunked.rows - inner_row).min(self.rows - row), 1)
                    } else if stride == self.rows {
                        (chunked.columns - inner_column, chunked.rows as usize)
                    } else {
                        (1, 1)
                    };
                    let from = (inner_column * chunked.rows + inner_row) as usize * element;
                    let bytes = chunked
                        .kept
                        .front()
                        .and_then(|(_, bytes)| bytes.get(from..));
                    let taken = usize::try_from(inside).map_or(left, |inside| inside.min(left));
                    let bytes = bytes.unwrap_or_default();
                    self.kind.append(bytes, self.big_endian, step, taken, out);
                }
            }
            let taken = out.len() - before;
            if taken == 0 {
                return Err(Error::malformed(
                    &self.file.path,
                    crate::error::Place::Byte(self.at),
                    "a variable of fewer numbers than its size says",
                ));
            }
            left -= taken.min(left);
            at = at.saturating_add((taken as u64).saturating_mul(stride));
        }
        Ok(())
    }
}
