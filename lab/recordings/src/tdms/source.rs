//! Reading.

use std::path::{Path, PathBuf};

use super::chunk::{Chunk, Column};
use super::describe::{Reading, describe};
use super::index::{Index, Run};
use super::kind::Kind;
use super::value::Timestamp;
use super::window::{WINDOW, Window};
use crate::error::{Error, Result};
use crate::layout::Layout;
use crate::source::{Decoder, Source, reading};

/// Samples that follow each other in the file are read on their own from this many bytes on; shorter pieces together with
/// what lies between them.
const OWN_READ: u64 = 1 << 14;
/// Numbers in a block, whatever the limit asked for.
const MAX_NUMBERS: usize = 1 << 23;

/// An open TDMS file.
struct Tdms {
    path: PathBuf,
    index: Index,
    readings: Vec<Reading>,
    window: Window,
}

/// Where a channel is to be read next.
#[derive(Debug, Clone, Copy)]
struct Position {
    /// Index of the channel.
    channel: usize,
    object: u32,
    /// Number of the run, the run, its chunks' size and the channel's column in it; none at the end.
    run: Option<(usize, Run, u64, Column)>,
    chunk: u64,
    /// Sample in the chunk.
    value: u64,
}

/// Opens a TDMS file and indexes it. Its `.tdms_index` neighbour is neither needed nor looked at.
///
/// # Errors
/// [`Error::Io`]; [`Error::Malformed`] where the file breaks the format's rules; [`Error::Unsupported`] for a version or a
/// data type whose size is not known.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let (index, file, length) = Index::read(path)?;
    let (mut layout, readings) = describe(&index);
    let mut tdms = Tdms {
        path: path.to_owned(),
        index,
        readings,
        window: Window::new(file, length),
    };
    for channel in 0..tdms.readings.len() {
        tdms.find_origin(channel, &mut layout)?;
    }
    Ok(reading(path, layout, tdms))
}

impl Tdms {
    /// Reads the first time stamp of a channel.
    fn find_origin(&mut self, channel: usize, layout: &mut Layout) -> Result<()> {
        let reading = &mut self.readings[channel];
        if reading.kind != Kind::Time {
            return Ok(());
        }
        let position = Position::start(&self.index, channel, reading.object);
        if let Some((_, run, ..)) = position.run
            && let Some(chunk) = self.index.layout(run)
        {
            let bytes = self
                .window
                .bytes(position.byte(), 16, 16)
                .map_err(|source| Error::io(&self.path, source))?;
            if let Some(first) = bytes.first_chunk() {
                reading.origin = Timestamp::from_bytes(*first, chunk.big_endian);
                let name = format!("{}/first_timestamp", layout.channels[channel].name);
                layout.properties.insert(name, reading.origin.to_string());
            }
        }
        Ok(())
    }

    /// The next rows of all selected channels, as many as are worth reading together; at least one.
    fn rows_together(&self, positions: &[Position], most: u64) -> u64 {
        let Some(lead) = positions.first() else {
            return 0;
        };
        let start = positions.iter().map(Position::byte).min().unwrap_or(0);
        let end = start.saturating_add(WINDOW);
        let mut rows = 0;
        let mut at = *lead;
        while let Some((number, run, bytes, column)) = at.run {
            let fitting = (end.saturating_sub(run.at) / bytes.max(1)).min(run.chunks);
            if fitting > at.chunk {
                rows += (fitting - at.chunk) * column.values - at.value;
            }
            if fitting < run.chunks || rows >= most {
                break;
            }
            at.enter(&self.index, number + 1);
        }
        if rows == 0 {
            rows = lead.run.map_or(1, |(_, _, _, column)| {
                column.values.saturating_sub(lead.value)
            });
        }
        rows.clamp(1, most.max(1))
    }
}

impl Position {
    fn start(index: &Index, channel: usize, object: u32) -> Self {
        let mut position = Self {
            channel,
            object,
            run: None,
            chunk: 0,
            value: 0,
        };
        position.enter(index, 0);
        position
    }

    /// To the first run from this number on that has the channel.
    fn enter(&mut self, index: &Index, from: usize) {
        self.chunk = 0;
        self.value = 0;
        self.run = index.next_run(self.object, from).and_then(|(at, run)| {
            let layout: &Chunk = index.layout(run)?;
            Some((at, run, layout.bytes, *layout.column(self.object)?))
        });
    }

    /// Passes over samples.
    fn skip(&mut self, index: &Index, mut samples: u64) {
        while let Some((number, run, _, column)) = self.run {
            let left = (run.chunks - self.chunk) * column.values - self.value;
            if samples < left {
                let at = self.value + samples;
                self.chunk += at / column.values;
                self.value = at % column.values;
                return;
            }
            samples -= left;
            self.enter(index, number + 1);
        }
    }

    /// Byte of the next sample.
    fn byte(&self) -> u64 {
        self.run.map_or(u64::MAX, |(_, run, bytes, column)| {
            run.at + self.chunk * bytes + column.offset + self.value * column.stride
        })
    }

    /// Appends the next `rows` samples to `out`, unscaled. Stops early where there are no more.
    fn read(
        &mut self,
        index: &Index,
        window: &mut Window,
        reading: &Reading,
        rows: u64,
        together: bool,
        out: &mut Vec<f64>,
    ) -> std::io::Result<()> {
        let mut rows = rows;
        while rows > 0 {
            let Some((number, run, bytes, column)) = self.run else {
                return Ok(());
            };
            let big_endian = index.layout(run).is_some_and(|layout| layout.big_endian);
            let size = column.kind.size().unwrap_or(0);
            // Single samples repeat with the chunks.
            let single = column.values == 1;
            let (available, stride) = if single {
                (run.chunks - self.chunk, bytes)
            } else {
                (column.values - self.value, column.stride)
            };
            let fitting = WINDOW.saturating_sub(size) / stride.max(1) + 1;
            let count = available.min(rows).min(fitting);
            let span = (count - 1) * stride + size;
            let ahead = match (stride == size, together) {
                (true, _) if span >= OWN_READ => span,
                (_, true) => WINDOW,
                (_, false) => span.max(OWN_READ / 4),
            };
            let raw = window.bytes(self.byte(), span, ahead)?;
            // Both fit: the bytes are in memory.
            column.kind.decode(
                raw,
                stride as usize,
                count as usize,
                big_endian,
                reading.origin,
                out,
            );
            rows -= count;
            if single {
                self.chunk += count;
            } else {
                self.value += count;
                if self.value == column.values {
                    self.value = 0;
                    self.chunk += 1;
                }
            }
            if self.chunk == run.chunks {
                self.enter(index, number + 1);
            }
        }
        Ok(())
    }
}

impl Decoder for Tdms {
    /// Where each selected channel is to be read next, and the rows left.
    type Position = (Vec<Position>, u64);

    /// [`Error::Unsupported`] for a channel whose scale or type is not known.
    fn check(&self, layout: &Layout, selected: &[usize]) -> Result<()> {
        for &channel in selected {
            if let Some(obstacle) = &self.readings[channel].obstacle {
                return Err(Error::unsupported(
                    &self.path,
                    format!("{obstacle} of channel {:?}", layout.channels[channel].name),
                    "select other channels, or save this one as scaled DBL values with LabVIEW or DIAdem",
                ));
            }
        }
        Ok(())
    }

    fn start(
        &mut self,
        _layout: &Layout,
        selected: &[usize],
        samples: u64,
    ) -> Result<Self::Position> {
        let start = |&channel| Position::start(&self.index, channel, self.readings[channel].object);
        Ok((selected.iter().map(start).collect(), samples))
    }

    fn skip(&self, (positions, _): &mut Self::Position, skipped: &[u64]) -> bool {
        for (position, skipped) in positions.iter_mut().zip(skipped) {
            position.skip(&self.index, *skipped);
        }
        true
    }

    fn next(
        &mut self,
        (positions, left): &mut Self::Position,
        _layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize> {
        let most = (MAX_NUMBERS / positions.len()).max(1);
        let rows = (*left).min(limit.min(most) as u64);
        let mut done = 0;
        while done < rows {
            let tile = self.rows_together(positions, rows - done);
            let together = shares(positions);
            let mut order: Vec<usize> = (0..positions.len()).collect();
            order.sort_by_key(|at| positions[*at].byte());
            for at in order {
                let (position, column) = (&mut positions[at], &mut columns[at]);
                let reading = &self.readings[position.channel];
                let start = column.len();
                column.reserve((rows - done) as usize);
                position
                    .read(
                        &self.index,
                        &mut self.window,
                        reading,
                        tile,
                        together,
                        column,
                    )
                    .map_err(|source| Error::io(&self.path, source))?;
                if let Some(scale) = &reading.scale {
                    scale.apply(&mut column[start..]);
                }
            }
            done += tile;
        }
        *left -= rows;
        Ok(rows as usize)
    }
}

/// Whether the selected channels make up enough of the chunk to read what lies between them.
fn shares(positions: &[Position]) -> bool {
    let mut bytes = 0;
    let selected = positions.iter().fold(0_u64, |sum, position| {
        position.run.map_or(sum, |(_, _, chunk, column)| {
            bytes = chunk;
            sum.saturating_add(
                column
                    .values
                    .saturating_mul(column.kind.size().unwrap_or(0)),
            )
        })
    });
    selected >= bytes / 8
}
