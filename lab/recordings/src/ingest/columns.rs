//! Blocks of columns in SI units, with their time stamps: every command's loop over a recording.

use std::path::{Path, PathBuf};

use super::clock::{Clock, Stamps};
use super::find::Column;
use crate::block::Block;
use crate::error::{Error, Result};
use crate::source::Source;

/// Samples read at a time.
pub const BLOCK: usize = 1 << 16;

/// An open recording of which some channels are read.
pub struct Columns {
    path: PathBuf,
    source: Box<dyn Source>,
    wanted: Vec<Column>,
    /// The channel of the time stamps, the rate that they are held against, and their clock.
    time: Option<(Column, Option<f64>, Clock)>,
    block: Block,
    /// A part of a block, as the source hands it out.
    piece: Block,
    /// Samples read before the block, and in it.
    before: u64,
    rows: usize,
    /// Samples of each selected channel before the last of them begins; they are not read.
    skipped: Vec<u64>,
}

impl Columns {
    /// Selects channels and, if there are any, time stamps, which are held against a rate where one is known. Channels that
    /// begin at different times are read from the last beginning on.
    ///
    /// # Errors
    /// Those of [`Source::select`].
    pub fn new(
        path: &Path,
        source: Box<dyn Source>,
        wanted: Vec<Column>,
        time: Option<Column>,
        rate_hz: Option<f64>,
    ) -> Result<Self> {
        let mut columns = Self {
            path: path.to_owned(),
            source,
            wanted: Vec::new(),
            time: None,
            block: Block::default(),
            piece: Block::default(),
            before: 0,
            rows: 0,
            skipped: Vec::new(),
        };
        columns.select(wanted, time, rate_hz)?;
        Ok(columns)
    }

    /// Selects other channels of the same file, from their first sample on.
    ///
    /// # Errors
    /// Those of [`Source::select`].
    pub fn select(
        &mut self,
        wanted: Vec<Column>,
        time: Option<Column>,
        rate_hz: Option<f64>,
    ) -> Result<()> {
        self.wanted = wanted;
        self.time = time.map(|time| {
            let clock = Clock::new(&time, rate_hz);
            (time, rate_hz, clock)
        });
        self.rewind()
    }

    /// Starts again at the first sample.
    ///
    /// # Errors
    /// Those of [`Source::select`]; [`Error::Malformed`] for channels that cannot be aligned.
    pub fn rewind(&mut self) -> Result<()> {
        let mut selection: Vec<usize> = self.wanted.iter().map(|c| c.index).collect();
        if let Some((time, rate_hz, clock)) = &mut self.time {
            selection.push(time.index);
            *clock = Clock::new(time, *rate_hz);
        }
        self.skipped = self.source.layout().alignment(&self.path, &selection)?;
        self.source.select_from(&selection, &self.skipped)?;
        self.block.clear(selection.len());
        (self.before, self.rows) = (0, 0);
        Ok(())
    }

    /// Replaces the columns with the next `limit` samples, or fewer at the end, and returns their number.
    ///
    /// # Errors
    /// Those of [`Source::read`]; [`Error::Sample`] for a time stamp that is not finite, does not advance or follows a gap.
    pub fn read(&mut self, limit: usize) -> Result<usize> {
        let rows = self.read_as_it_is(limit)?;
        if let Some((time, _, clock)) = &mut self.time {
            if rows < limit {
                clock.settle();
            }
            if let Some(fault) = clock.fault() {
                return Err(Error::Sample {
                    path: self.path.clone(),
                    channel: time.name.clone(),
                    sample: fault.sample,
                    line: self.source.line(fault.sample),
                    cause: fault.cause,
                });
            }
        }
        Ok(rows)
    }

    /// As [`Self::read`], but whatever is wrong with the time stamps stands in [`Self::stamps`] alone.
    ///
    /// # Errors
    /// Those of [`Source::read`].
    pub fn read_as_it_is(&mut self, limit: usize) -> Result<usize> {
        self.before += self.rows as u64;
        self.rows = 0;
        self.block.clear(self.block.columns.len());
        while self.block.rows() < limit {
            let room = limit - self.block.rows();
            if self.source.read(&mut self.piece, room)? == 0 {
                break;
            }
            if self.block.rows() == 0 {
                std::mem::swap(&mut self.block, &mut self.piece);
                continue;
            }
            for (all, some) in self.block.columns.iter_mut().zip(&self.piece.columns) {
                all.extend_from_slice(some);
            }
        }
        let times = self.time.as_ref().map(|(time, ..)| time);
        let wanted = self.wanted.iter().chain(times);
        for (column, wanted) in self.block.columns.iter_mut().zip(wanted) {
            if wanted.size_si != 1.0 {
                column.iter_mut().for_each(|value| *value *= wanted.size_si);
            }
        }
        if let (Some((_, _, clock)), Some(stamps_s)) = (&mut self.time, self.block.columns.last()) {
            clock.extend(stamps_s);
        }
        self.rows = self.block.rows();
        Ok(self.rows)
    }

    /// The last block's columns, without the time stamps, in SI units.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.block.columns[..self.wanted.len()]
    }

    /// The last block's samples of a channel, by its place in the selection, in SI units.
    pub fn column(&self, k: usize) -> &[f64] {
        &self.block.columns[k]
    }

    /// Replaces `into` with [`Self::column`] without copying it. It can be had once a block.
    pub fn take(&mut self, k: usize, into: &mut Vec<f64>) {
        into.clear();
        std::mem::swap(&mut self.block.columns[k], into);
    }

    /// The last block's time stamps, s.
    pub fn stamps_s(&self) -> Option<&[f64]> {
        self.time.as_ref()?;
        self.block.columns.last().map(Vec::as_slice)
    }

    /// Refuses a channel's first sample of the last block that is not finite.
    ///
    /// # Errors
    /// [`Error::Sample`].
    pub fn check_finite(&self, k: usize) -> Result<()> {
        let column = self.column(k);
        // All at once first: a loop without an exit goes by vector registers.
        let finite = |all: bool, x: &f64| all & x.is_finite();
        if column.iter().fold(true, finite) {
            return Ok(());
        }
        match column.iter().position(|x| !x.is_finite()) {
            None => Ok(()),
            Some(at) => Err(Error::Sample {
                path: self.path.clone(),
                channel: self.wanted[k].name.clone(),
                sample: self.skipped[k] + self.before + at as u64,
                line: self.source.line(self.before + at as u64),
                cause: format!(
                    "{} is not a finite number; cut the recording there or mend it",
                    column[at]
                ),
            }),
        }
    }

    /// As [`Source::line`].
    pub fn line(&self, sample: u64) -> Option<u64> {
        self.source.line(sample)
    }

    /// Usual step of the time stamps so far, s.
    pub fn usual_step_s(&mut self) -> Option<f64> {
        self.time
            .as_mut()
            .and_then(|(.., clock)| clock.usual_step_s())
    }

    /// Statistics of the time stamps read so far.
    pub fn stamps(&self) -> Option<Stamps> {
        self.time
            .as_ref()
            .map(|(_, _, clock)| clock.clone().finish())
    }
}

/// Statistics of the time stamps of a whole recording, which is read for that alone.
///
/// # Errors
/// Those of [`Columns::new`] and [`Columns::read`].
pub fn stamps(path: &Path, time: &Column, rate_hz: Option<f64>) -> Result<Option<Stamps>> {
    let source = crate::open(path)?;
    let mut columns = Columns::new(path, source, Vec::new(), Some(time.clone()), rate_hz)?;
    while columns.read(BLOCK)? > 0 {}
    Ok(columns.stamps())
}
