//! The trait of every open recording, and what all formats have in common: a selection, and where reading stands.

use std::mem::replace;
use std::path::{Path, PathBuf};

use crate::channel::{Block, Layout};
use crate::error::{Error, Place, Result};

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
    fn select(&mut self, channels: &[usize]) -> Result<()>;

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
    /// These channels, of so many samples, from the first sample on.
    Selected(Vec<usize>, u64),
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

    fn select(&mut self, channels: &[usize]) -> Result<()> {
        let samples = self.layout.common_length(&self.path, channels)?;
        self.decoder.check(&self.layout, channels)?;
        self.state = State::Selected(channels.to_vec(), samples);
        Ok(())
    }

    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize> {
        if matches!(self.state, State::Whole) {
            self.select(&Vec::from_iter(0..self.layout.channels.len()))?;
        }
        let (channels, mut at) = match replace(&mut self.state, State::Failed) {
            State::Selected(channels, samples) => {
                let start = self.decoder.start(&self.layout, &channels, samples)?;
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
