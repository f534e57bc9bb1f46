//! Bytes of one array, wherever in a file they are, deflated or not.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use flate2::Crc;
use flate2::bufread::DeflateDecoder;

/// A file that several readers share, each with its own position.
pub type Shared = Arc<Mutex<File>>;

/// Part of a file.
pub struct Window {
    file: Shared,
    at: u64,
    end: u64,
}

impl Window {
    /// Bytes `at..end`.
    pub fn new(file: &Shared, at: u64, end: u64) -> Self {
        let file = Arc::clone(file);
        Self { file, at, end }
    }
}

impl Read for Window {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let wanted = left.min(into.len());
        let Some(into) = into.get_mut(..wanted).filter(|into| !into.is_empty()) else {
            return Ok(0);
        };
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.at))?;
        let count = file.read(into)?;
        self.at += count as u64;
        Ok(count)
    }
}

/// Where an array is, header included.
#[derive(Clone)]
pub struct Body {
    /// The file.
    pub file: Shared,
    /// First byte.
    pub begin: u64,
    /// Bytes in the file.
    pub packed: u64,
    /// Bytes of the array.
    pub bytes: u64,
    /// Compressed.
    pub deflated: bool,
    /// What the bytes must sum up to, if the file says so.
    pub crc: Option<u32>,
}

/// Bytes of an array in their order.
pub struct Stream {
    input: Box<dyn Read + Send>,
    crc: Crc,
    expected: Option<u32>,
}

impl Body {
    /// All bytes, to be checked at the end by [`Stream::finish`].
    pub fn open(&self) -> Stream {
        let window = Window::new(
            &self.file,
            self.begin,
            self.begin.saturating_add(self.packed),
        );
        let input: Box<dyn Read + Send> = if self.deflated {
            let window = BufReader::with_capacity(1 << 15, window);
            // No more than the header of the zip file says, whatever the stream holds; one byte shows that it does.
            Box::new(DeflateDecoder::new(window).take(self.bytes.saturating_add(1)))
        } else {
            Box::new(window)
        };
        Stream {
            input,
            crc: Crc::new(),
            expected: self.crc,
        }
    }

    /// The bytes from `from`, not checked.
    pub fn open_at(&self, from: u64) -> io::Result<Stream> {
        let mut stream = self.open();
        stream.expected = None;
        if self.deflated {
            stream.skip(from)?;
        } else {
            let begin = self.begin.saturating_add(from);
            let end = self.begin.saturating_add(self.bytes);
            stream.input = Box::new(Window::new(&self.file, begin, end));
        }
        Ok(stream)
    }
}

impl Stream {
    /// Passes over bytes.
    pub fn skip(&mut self, bytes: u64) -> io::Result<()> {
        let mut piece = vec![0; 1 << 15];
        let mut left = bytes;
        while left > 0 {
            let count = left.min(piece.len() as u64) as usize;
            let piece = piece.get_mut(..count).unwrap_or_default();
            self.read_exact(piece)?;
            left -= count as u64;
        }
        Ok(())
    }

    /// Checks that nothing is left and that the sum is right.
    pub fn finish(&mut self) -> io::Result<()> {
        let Some(expected) = self.expected else {
            return Ok(());
        };
        let cause = if self.read(&mut [0])? != 0 {
            "more bytes than its directory says"
        } else if self.crc.sum() != expected {
            "its checksum is wrong: the file is damaged"
        } else {
            return Ok(());
        };
        Err(io::Error::new(io::ErrorKind::InvalidData, cause))
    }
}

impl Read for Stream {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(into)?;
        if self.expected.is_some() {
            self.crc.update(into.get(..count).unwrap_or_default());
        }
        Ok(count)
    }
}
