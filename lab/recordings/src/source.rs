//! The trait of every open recording, and what all formats have in common: a selection, and where reading stands.

use std::mem::replace;
use std::path::{Path, PathBuf};

use crate::block::Block;
use crate::error::{Error, Place, Result};
use crate::layout::Layout;

/// An open recording.
pub trait Source: Send {
    /// What is in it.
    fn layout(&self) -> &Layout;

    /// Restricts reading to these channels (indices into [`Layout::channels`]), in this order, and starts again at the first
    /// sample. Without it all channels are read.
    ///
    /// # Errors
    /// [`crate::Error::LengthMismatch`] if they differ in length; [`crate::Error::NoSuchChannel`] for an index that is not there;
    /// [`crate::Error::Unsupported`] for a channel that is not understood; [`crate::Error::Io`].
    fn select(&mut self, channels: &[usize]) -> Result<()> {
        self.select_from(channels, &vec![0; channels.len()])
    }

    /// As [`Self::select`], without the first so many samples of each channel. Channels may then differ in length: reading
    /// stops where the first of them ends.
    ///
    /// # Errors
    /// Those of [`Self::select`]; [`crate::Error::Unsupported`] in a format whose channels cannot be read from different samples on.
    fn select_from(&mut self, channels: &[usize], skipped: &[u64]) -> Result<()>;

    /// Line of a sample, from 1, in a file of text; none in any other, and where it cannot be read again.
    fn line(&self, _sample: u64) -> Option<u64> {
        None
    }

    /// Replaces the contents of `block` with the next samples of the selected channels, at most `limit` of them (a source may
    /// return fewer, but none only at the end), and returns their number. After an error the channels are to be selected anew.
    ///
    /// # Errors
    /// [`crate::Error::Malformed`], [`crate::Error::Io`].
    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize>;
}

/// What a format reads.
pub(crate) trait Decoder: Send + 'static {
    /// Where reading stands.
    type Position: Send;

    /// Refuses a channel that is not understood. Reads nothing.
    fn check(&self, _layout: &Layout, _selected: &[usize]) -> Result<()> {
        Ok(())
    }

    /// Goes to the first sample of the selected channels, which have `samples` each where the layout says how many.
    fn start(
        &mut self,
        layout: &Layout,
        selected: &[usize],
        samples: u64,
    ) -> Result<Self::Position>;

    /// Passes over the first so many samples of each selected channel; false if it cannot. Only asked for if there are any.
    fn skip(&self, _at: &mut Self::Position, _skipped: &[u64]) -> bool {
        false
    }

    /// As [`Source::line`].
    fn line(&self, _sample: u64) -> Option<u64> {
        None
    }

    /// Appends the next samples to the selected channels' columns, which are empty, at least one and at most `limit` unless
    /// none is left. Returns their number.
    fn next(
        &mut self,
        at: &mut Self::Position,
        layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize>;
}

/// An open recording of any format.
struct Reading<D: Decoder> {
    path: PathBuf,
    layout: Layout,
    decoder: D,
    state: State<D::Position>,
}

enum State<Position> {
    /// Nothing was selected: all channels are read.
    Whole,
    /// These channels, without so many samples each, and the samples left of each.
    Selected(Vec<usize>, Vec<u64>, u64),
    /// So many channels, from there on.
    Reading(usize, Position),
    /// A sample could not be read; the channels are out of step.
    Failed,
}

/// A source of what the decoder reads.
pub(crate) fn reading<D: Decoder>(path: &Path, layout: Layout, decoder: D) -> Box<dyn Source> {
    Box::new(Reading {
        path: path.to_owned(),
        layout,
        decoder,
        state: State::Whole,
    })
}

impl<D: Decoder> Source for Reading<D> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn select_from(&mut self, channels: &[usize], skipped: &[u64]) -> Result<()> {
        let samples = self.layout.common_length(&self.path, channels, skipped)?;
        self.decoder.check(&self.layout, channels)?;
        self.state = State::Selected(channels.to_vec(), skipped.to_vec(), samples);
        Ok(())
    }

    fn line(&self, sample: u64) -> Option<u64> {
        self.decoder.line(sample)
    }

    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize> {
        if matches!(self.state, State::Whole) {
            self.select(&Vec::from_iter(0..self.layout.channels.len()))?;
        }
        let (channels, mut at) = match replace(&mut self.state, State::Failed) {
            State::Selected(channels, skipped, samples) => {
                let mut start = self.decoder.start(&self.layout, &channels, samples)?;
                if skipped.iter().any(|skipped| *skipped > 0)
                    && !self.decoder.skip(&mut start, &skipped)
                {
                    return Err(Error::unsupported(
                        &self.path,
                        "a table of channels that begin at different times",
                        "save them aligned, or as TDMS",
                    ));
                }
                (channels.len(), start)
            }
            State::Reading(channels, at) => (channels, at),
            State::Whole | State::Failed => {
                let cause =
                    "an earlier sample could not be read; select the channels again to start anew";
                return Err(Error::malformed(&self.path, Place::Whole, cause));
            }
        };
        block.clear(channels);
        let mut rows = 0;
        if limit > 0 && channels > 0 {
            let columns = &mut block.columns;
            rows = self.decoder.next(&mut at, &self.layout, columns, limit)?;
        }
        self.state = State::Reading(channels, at);
        Ok(rows)
    }
}
