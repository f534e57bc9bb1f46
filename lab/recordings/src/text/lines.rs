//! A file as lines, through gzip if it is that.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use crate::error::{Error, Place, Result};

/// Longest line, bytes; also the size of the buffer.
pub const LINE: usize = 1 << 20;

/// First bytes of a compressed file.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Lines of a file, numbered from 1, without their terminators.
pub struct Lines {
    path: PathBuf,
    input: Box<dyn Read + Send>,
    gzip: bool,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    /// Number of the line handed out last.
    line: u64,
    terminator: u8,
    ended: bool,
    /// Whether the line handed out last ends with the file, not with a terminator.
    unterminated: bool,
}

/// What stands behind the last line's end of a file that is not compressed.
///
/// # Errors
/// [`Error::Io`].
pub fn fragment(path: &Path) -> Result<Option<Vec<u8>>> {
    let io = |source| Error::io(path, source);
    let mut file = File::open(path).map_err(io)?;
    let mut magic = Vec::new();
    (&file).take(2).read_to_end(&mut magic).map_err(io)?;
    if magic == GZIP {
        return Ok(None);
    }
    let length = file.metadata().map_err(io)?.len();
    let mut tail = Vec::new();
    file.seek(SeekFrom::Start(length.saturating_sub(LINE as u64)))
        .and_then(|_| file.read_to_end(&mut tail))
        .map_err(io)?;
    let ends = memchr::memrchr2(b'\n', b'\r', &tail);
    let last = ends.and_then(|end| tail.get(end + 1..));
    Ok(last.filter(|last| !last.is_empty()).map(<[u8]>::to_vec))
}

impl Lines {
    /// Opens a file and skips its byte order mark.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Unsupported`] for UTF-16, [`Error::Malformed`] for what is not text.
    pub fn open(path: &Path) -> Result<Self> {
        let io = |source| Error::io(path, source);
        let mut file = File::open(path).map_err(io)?;
        let mut magic = Vec::new();
        (&file).take(2).read_to_end(&mut magic).map_err(io)?;
        file.seek(SeekFrom::Start(0)).map_err(io)?;
        let gzip = magic == GZIP;
        let input: Box<dyn Read + Send> = if gzip {
            Box::new(MultiGzDecoder::new(BufReader::with_capacity(1 << 16, file)))
        } else {
            Box::new(file)
        };
        let mut lines = Self {
            path: path.to_owned(),
            input,
            gzip,
            buffer: vec![0; LINE],
            start: 0,
            end: 0,
            line: 0,
            terminator: b'\n',
            ended: false,
            unterminated: false,
        };
        lines.begin()?;
        Ok(lines)
    }

    /// Whether the file is compressed.
    pub fn is_gzip(&self) -> bool {
        self.gzip
    }

    /// Whether the line handed out last has no terminator.
    pub fn is_unterminated(&self) -> bool {
        self.unterminated
    }

    /// The next line with its number; a last line without terminator counts.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Malformed`] for a line that is too long or a damaged gzip stream.
    pub fn next(&mut self) -> Result<Option<(u64, &[u8])>> {
        let Some(range) = self.advance()? else {
            return Ok(None);
        };
        let line = self.buffer.get(range).unwrap_or_default();
        Ok(Some((self.line, line.strip_suffix(b"\r").unwrap_or(line))))
    }

    fn advance(&mut self) -> Result<Option<Range<usize>>> {
        let mut seen = 0;
        loop {
            let waiting = self.buffer.get(self.start..self.end).unwrap_or_default();
            let unseen = waiting.get(seen..).unwrap_or_default();
            if let Some(at) = memchr::memchr(self.terminator, unseen) {
                let begin = self.start;
                self.start = begin + seen + at + 1;
                self.line += 1;
                return Ok(Some(begin..self.start - 1));
            }
            if self.ended {
                if waiting.is_empty() {
                    return Ok(None);
                }
                let begin = self.start;
                self.start = self.end;
                self.line += 1;
                self.unterminated = true;
                return Ok(Some(begin..self.end));
            }
            seen = waiting.len();
            self.fill()?;
        }
    }

    /// Reads more behind what is waiting.
    fn fill(&mut self) -> Result<()> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let room = self.buffer.get_mut(self.end..).unwrap_or_default();
        if room.is_empty() {
            return Err(Error::malformed(
                &self.path,
                Place::Line(self.line + 1),
                format!("this line is longer than {LINE} bytes; is it a file of text?"),
            ));
        }
        loop {
            match self.input.read(room) {
                Ok(0) => self.ended = true,
                Ok(count) => self.end += count,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                Err(e) => return Err(self.failed(e)),
            }
            return Ok(());
        }
    }

    fn failed(&self, source: io::Error) -> Error {
        use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
        if self.gzip && matches!(source.kind(), InvalidData | InvalidInput | UnexpectedEof) {
            let place = Place::Line(self.line + 1);
            let cause = format!("the gzip stream is damaged or ends too early ({source})");
            return Error::malformed(&self.path, place, cause);
        }
        Error::io(&self.path, source)
    }

    /// Looks at the first bytes: byte order mark, terminator, text or not.
    fn begin(&mut self) -> Result<()> {
        // A pipe or a decoder may hand out little at a time; 64 KiB tell enough.
        while !self.ended && self.end < 1 << 16 {
            self.fill()?;
        }
        let head = self.buffer.get(..self.end).unwrap_or_default();
        if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
            return Err(Error::unsupported(
                &self.path,
                "text in UTF-16",
                "save it as UTF-8 (Excel: \"CSV UTF-8\")",
            ));
        }
        if let Some(at) = memchr::memchr(0, head) {
            return Err(Error::malformed(
                &self.path,
                Place::Byte(at as u64),
                "a zero byte: this is not a file of text",
            ));
        }
        if memchr::memchr(b'\n', head).is_none() && memchr::memchr(b'\r', head).is_some() {
            self.terminator = b'\r';
        }
        if head.starts_with(b"\xef\xbb\xbf") {
            self.start = 3;
        }
        Ok(())
    }
}
