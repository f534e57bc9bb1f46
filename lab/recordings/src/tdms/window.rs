//! Buffered reading.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Bytes that are held at once.
pub const WINDOW: u64 = 1 << 18;

/// A piece of the file in memory.
#[derive(Debug)]
pub struct Window {
    file: File,
    length: u64,
    buffer: Vec<u8>,
    /// Where the piece begins, and its bytes.
    at: u64,
    filled: usize,
}

impl Window {
    pub fn new(file: File, length: u64) -> Self {
        Self {
            file,
            length,
            buffer: Vec::new(),
            at: 0,
            filled: 0,
        }
    }

    /// Bytes from `at` on. Where they are not held yet, up to `ahead` bytes are read in the hope that they are asked for next.
    /// No more than [`WINDOW`] can be asked for.
    pub fn bytes(&mut self, at: u64, count: u64, ahead: u64) -> io::Result<&[u8]> {
        let end = self.at + self.filled as u64;
        if at < self.at || at + count > end {
            let wanted = ahead
                .max(count)
                .min(self.length.saturating_sub(at))
                .min(WINDOW);
            if wanted < count {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            // Nothing is held while it is being replaced.
            self.filled = 0;
            let wanted = wanted as usize;
            if self.buffer.len() < wanted {
                self.buffer
                    .resize(wanted.max(WINDOW.min(self.length) as usize), 0);
            }
            self.file.seek(SeekFrom::Start(at))?;
            self.file.read_exact(&mut self.buffer[..wanted])?;
            self.at = at;
            self.filled = wanted;
        }
        let start = (at - self.at) as usize;
        Ok(&self.buffer[start..start + count as usize])
    }
}
