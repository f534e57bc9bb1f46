//! Reading.

use std::path::{Path, PathBuf};

use super::chunk::{Chunk, Column};
use super::describe::{Reading, describe};
use super::index::{Index, Run};
use super::kind::Kind;
use super::value::Timestamp;
use super::window::{WINDOW, Window};
use crate::channel::{Block, Layout};
use crate::error::{Error, Result};
use crate::source::Source;

/// Samples that follow each other in the file are read on their own from this many bytes on; shorter pieces together with
/// what lies between them.
const OWN_READ: u64 = 1 << 14;
/// Numbers in a block, whatever the limit asked for.
const MAX_NUMBERS: usize = 1 << 23;

/// An open TDMS file.
#[derive(Debug)]
pub struct Reader {
    path: PathBuf,
    index: Index,
    layout: Layout,
    readings: Vec<Reading>,
    window: Window,
    /// Where each selected channel is to be read next; none before the first selection.
    selected: Option<Vec<Position>>,
    left: u64,
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

impl Reader {
    pub fn open(path: &Path) -> Result<Self> {
        let (index, file, length) = Index::read(path)?;
        let (layout, readings) = describe(&index);
        let mut reader = Self {
            path: path.to_owned(),
            index,
            layout,
            readings,
            window: Window::new(file, length),
            selected: None,
            left: 0,
        };
        for channel in 0..reader.readings.len() {
            reader.find_origin(channel)?;
        }
        Ok(reader)
    }

    /// Reads the first time stamp of a channel.
    fn find_origin(&mut self, channel: usize) -> Result<()> {
        let Some(reading) = self
            .readings
            .get_mut(channel)
            .filter(|r| r.kind == Kind::Time)
        else {
            return Ok(());
        };
        let position = Position::start(&self.index, channel, reading.object);
        if let Some((_, run, ..)) = position.run
            && let Some(layout) = self.index.layout(run)
        {
            let bytes = self
                .window
                .bytes(position.byte(), 16, 16)
                .map_err(|source| Error::io(&self.path, source))?;
            if let Some(first) = bytes.first_chunk() {
                reading.origin = Timestamp::from_bytes(*first, layout.big_endian);
                if let Some(channel) = self.layout.channels.get(channel) {
                    let name = format!("{}/first_timestamp", channel.name);
                    self.layout
                        .properties
                        .insert(name, reading.origin.to_string());
                }
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

impl Source for Reader {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Besides the errors of [`Source`]: [`Error::Unsupported`] for a channel whose scale or type is not known.
    fn select(&mut self, channels: &[usize]) -> Result<()> {
        let samples = self.layout.common_length(&self.path, channels)?;
        let mut positions = Vec::with_capacity(channels.len());
        for &channel in channels {
            let (Some(reading), Some(described)) = (
                self.readings.get(channel),
                self.layout.channels.get(channel),
            ) else {
                continue;
            };
            if let Some(obstacle) = &reading.obstacle {
                return Err(Error::unsupported(
                    &self.path,
                    format!("{obstacle} of channel {:?}", described.name),
                    "select other channels, or save this one as scaled DBL values with LabVIEW or DIAdem",
                ));
            }
            positions.push(Position::start(&self.index, channel, reading.object));
        }
        self.selected = Some(positions);
        self.left = samples;
        Ok(())
    }

    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize> {
        if self.selected.is_none() {
            let all: Vec<usize> = (0..self.readings.len()).collect();
            self.select(&all)?;
        }
        // Away while it is being advanced, so that after an error reading starts over.
        let mut positions = self.selected.take().unwrap_or_default();
        block.clear(positions.len());
        let most = MAX_NUMBERS / positions.len().max(1);
        let rows = self.left.min(limit.min(most.max(1)) as u64);
        let mut done = 0;
        while done < rows {
            let tile = self.rows_together(&positions, rows - done);
            let together = shares(&positions);
            let mut order: Vec<usize> = (0..positions.len()).collect();
            order.sort_by_key(|at| positions.get(*at).map(Position::byte));
            for at in order {
                let (Some(position), Some(column)) =
                    (positions.get_mut(at), block.columns.get_mut(at))
                else {
                    continue;
                };
                let Some(reading) = self.readings.get(position.channel) else {
                    continue;
                };
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
                if let (Some(scale), Some(values)) = (&reading.scale, column.get_mut(start..)) {
                    scale.apply(values);
                }
            }
            done += tile;
        }
        self.left -= rows;
        self.selected = Some(positions);
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
