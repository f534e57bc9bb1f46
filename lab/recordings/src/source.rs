//! The trait of every open recording.

use crate::channel::{Block, Layout};
use crate::error::Result;

/// An open recording.
pub trait Source: Send {
    /// What is in it.
    fn layout(&self) -> &Layout;

    /// Restricts reading to these channels (indices into [`Layout::channels`]), in this order, and starts again at the first
    /// sample. Without it all channels are read.
    ///
    /// # Errors
    /// [`crate::Error::LengthMismatch`] if they differ in length; [`crate::Error::NoSuchChannel`] for an index that is not there;
    /// [`crate::Error::Io`].
    fn select(&mut self, channels: &[usize]) -> Result<()>;

    /// Replaces the contents of `block` with the next samples of the selected channels, at most `limit` of them (a source may
    /// return fewer, but none only at the end), and returns their number.
    ///
    /// # Errors
    /// [`crate::Error::Malformed`], [`crate::Error::Io`].
    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize>;
}
