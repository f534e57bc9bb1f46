//! The trait of every recording that is being written.

use crate::channel::Block;
use crate::error::Result;

/// A recording being written. Dropped before [`Sink::finish`], it leaves no trace.
pub trait Sink: Send {
    /// Appends the rows of a block, one column per channel of the layout.
    ///
    /// # Errors
    /// [`crate::Error::Io`].
    fn write(&mut self, block: &Block) -> Result<()>;

    /// Completes the file and puts it in its place.
    ///
    /// # Errors
    /// [`crate::Error::Io`]; the old file, if any, is then untouched.
    fn finish(self: Box<Self>) -> Result<()>;
}
