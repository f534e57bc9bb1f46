//! The trait of every recording that is being written, and what all formats have in common: a draft, and pieces of equal length.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crate::block::Block;
use crate::channel::MOST_CHANNELS;
use crate::draft::Draft;
use crate::error::{Error, Place, Result};
use crate::layout::Layout;

/// A recording being written. Dropped before [`Sink::finish`], it leaves no trace.
pub trait Sink: Send {
    /// Appends the rows of a block, one column per channel of the layout.
    ///
    /// # Errors
    /// [`crate::Error::Io`]; [`crate::Error::Malformed`] for a block of other columns than the layout has channels, or of
    /// columns of different lengths.
    fn write(&mut self, block: &Block) -> Result<()>;

    /// Completes the file and puts it in its place.
    ///
    /// # Errors
    /// [`crate::Error::Io`]; the old file, if any, is then untouched.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// What a format writes.
pub(crate) trait Encoder: Send + Sized {
    /// Rows of a piece.
    fn rows(&self) -> usize;

    /// Writes a piece: columns of [`Self::rows`] rows, of fewer only at the end. None is empty.
    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()>;

    /// Writes what comes behind the last piece, and hands back the file.
    fn finish(self) -> io::Result<File>;
}

/// A recording of any format being written.
struct Writing<E> {
    path: PathBuf,
    draft: Draft,
    encoder: E,
    waiting: Block,
}

/// Starts a recording with the encoder that `start` makes of the open file.
///
/// # Errors
/// [`Error::Io`]; [`Error::Unsupported`] for no channels or more than 4096.
pub(crate) fn create<E: Encoder + 'static>(
    path: &Path,
    layout: &Layout,
    start: impl FnOnce(File) -> io::Result<E>,
) -> Result<Box<dyn Sink>> {
    let channels = layout.channels.len();
    if channels == 0 || channels > MOST_CHANNELS {
        return Err(Error::unsupported(
            path,
            format!("a file of {channels} channels"),
            format!("write 1 to {MOST_CHANNELS}"),
        ));
    }
    let (draft, file) = Draft::create(path)?;
    Ok(Box::new(Writing {
        path: path.to_owned(),
        draft,
        encoder: start(file).map_err(|source| Error::io(path, source))?,
        waiting: Block::new(channels),
    }))
}

impl<E: Encoder> Writing<E> {
    fn flush(&mut self) -> Result<()> {
        if self.waiting.rows() > 0 {
            self.encoder
                .piece(&self.waiting.columns)
                .map_err(|source| Error::io(&self.path, source))?;
            self.waiting.clear(self.waiting.columns.len());
        }
        Ok(())
    }
}

impl<E: Encoder> Sink for Writing<E> {
    fn write(&mut self, block: &Block) -> Result<()> {
        let (rows, columns) = (block.rows(), self.waiting.columns.len());
        if block.columns.len() != columns || block.columns.iter().any(|c| c.len() != rows) {
            let cause = format!("a block to write has not {columns} columns of one length");
            return Err(Error::malformed(&self.path, Place::Whole, cause));
        }
        let mut from = 0;
        while from < rows {
            let to = rows.min(from + self.encoder.rows() - self.waiting.rows());
            for (waiting, column) in self.waiting.columns.iter_mut().zip(&block.columns) {
                waiting.extend_from_slice(&column[from..to]);
            }
            from = to;
            if self.waiting.rows() == self.encoder.rows() {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        self.flush()?;
        let Self {
            path,
            draft,
            encoder,
            ..
        } = *self;
        let file = encoder
            .finish()
            .map_err(|source| Error::io(&path, source))?;
        draft.keep(&file)
    }
}
