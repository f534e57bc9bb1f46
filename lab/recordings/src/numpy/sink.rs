//! Arrays, out.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

use super::header;
use crate::channel::{Block, Layout, is_sample_rate};
use crate::draft::{Draft, folder_of};
use crate::error::{Error, Place, Result};
use crate::sink::Sink;

/// Bytes of an f64.
const F8: u64 = 8;

fn check(path: &Path, block: &Block, columns: usize) -> Result<()> {
    let rows = block.rows();
    if block.columns.len() == columns && block.columns.iter().all(|c| c.len() == rows) {
        return Ok(());
    }
    let cause = format!("a block to write has not {columns} columns of one length");
    Err(Error::malformed(path, Place::Whole, cause))
}

/// An array of two dimensions being written.
pub struct NpySink {
    path: PathBuf,
    draft: Draft,
    output: BufWriter<File>,
    columns: usize,
    rows: u64,
}

impl NpySink {
    /// Opens the draft and writes a header of no rows.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(path: &Path, layout: &Layout) -> Result<Self> {
        let (draft, file) = Draft::create(path)?;
        let mut output = BufWriter::with_capacity(1 << 18, file);
        let columns = layout.channels.len();
        output
            .write_all(&header::write("<f8", &[0, columns as u64]))
            .map_err(|source| Error::io(path, source))?;
        Ok(Self {
            path: path.to_owned(),
            draft,
            output,
            columns,
            rows: 0,
        })
    }
}

impl Sink for NpySink {
    fn write(&mut self, block: &Block) -> Result<()> {
        check(&self.path, block, self.columns)?;
        for row in 0..block.rows() {
            for value in block.columns.iter().filter_map(|column| column.get(row)) {
                self.output
                    .write_all(&value.to_le_bytes())
                    .map_err(|source| Error::io(&self.path, source))?;
            }
        }
        self.rows += block.rows() as u64;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let header = header::write("<f8", &[self.rows, self.columns as u64]);
        let Self {
            path,
            draft,
            output,
            ..
        } = *self;
        let complete = || -> io::Result<File> {
            let mut file = output
                .into_inner()
                .map_err(io::IntoInnerError::into_error)?;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(&header)?;
            Ok(file)
        };
        let file = complete().map_err(|source| Error::io(&path, source))?;
        draft.keep(&file)
    }
}

/// Memory for samples on their way to the spool, bytes.
const SPOOLED: usize = 1 << 22;

/// A file of one array per channel being written.
pub struct NpzSink {
    path: PathBuf,
    draft: Draft,
    output: File,
    layout: Layout,
    /// Pieces of `piece` rows, each channel after channel, in a file without a name beside the draft.
    spool: File,
    waiting: Block,
    /// Rows of every piece of the spool but the last.
    piece: usize,
    /// Rows in the spool.
    rows: u64,
}

impl NpzSink {
    /// Opens the draft and the spool.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(path: &Path, layout: &Layout) -> Result<Self> {
        let (draft, output) = Draft::create(path)?;
        let columns = layout.channels.len();
        Ok(Self {
            path: path.to_owned(),
            draft,
            output,
            layout: layout.clone(),
            spool: tempfile::tempfile_in(folder_of(path))
                .map_err(|source| Error::io(path, source))?,
            waiting: Block::new(columns),
            piece: (SPOOLED / F8 as usize / columns.max(1)).max(1),
            rows: 0,
        })
    }

    fn spill(&mut self) -> io::Result<()> {
        let rows = self.waiting.rows();
        let mut bytes = Vec::with_capacity(rows * F8 as usize);
        for column in &mut self.waiting.columns {
            bytes.clear();
            bytes.extend(column.iter().flat_map(|value| value.to_le_bytes()));
            self.spool.write_all(&bytes)?;
            column.clear();
        }
        self.rows += rows as u64;
        Ok(())
    }
}

impl Sink for NpzSink {
    fn write(&mut self, block: &Block) -> Result<()> {
        check(&self.path, block, self.waiting.columns.len())?;
        let mut from = 0;
        while from < block.rows() {
            let to = block.rows().min(from + self.piece - self.waiting.rows());
            for (waiting, column) in self.waiting.columns.iter_mut().zip(&block.columns) {
                waiting.extend_from_slice(column.get(from..to).unwrap_or_default());
            }
            from = to;
            if self.waiting.rows() == self.piece {
                self.spill()
                    .map_err(|source| Error::io(&self.path, source))?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let mut complete = || -> io::Result<()> {
            self.spill()?;
            let layout = &self.layout;
            let array = header::write("<f8", &[self.rows]);
            let bytes = array.len() as u64 + self.rows * F8;
            let texts = texts(layout);
            // Directories and scalars take less than the margin.
            let channels = layout.channels.len() as u64;
            let margin = (1 << 16) * (channels + texts.len() as u64) + (1 << 20);
            let long = channels * bytes + margin > u64::from(u32::MAX);
            // Without the time of day (1980-01-01), so that equal recordings give equal files.
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Stored)
                .large_file(long);
            let mut zip = ZipWriter::new(BufWriter::with_capacity(1 << 18, &mut self.output));
            for (at, channel) in layout.channels.iter().enumerate() {
                zip.start_file(format!("{}.npy", channel.name), options)?;
                zip.write_all(&array)?;
                copy_column(
                    &mut self.spool,
                    &mut zip,
                    at as u64,
                    channels,
                    self.rows,
                    self.piece as u64,
                )?;
            }
            if let Some(rate) = common_rate(layout) {
                zip.start_file("sample_rate_hz.npy", options)?;
                zip.write_all(&header::write("<f8", &[]))?;
                zip.write_all(&rate.to_le_bytes())?;
            }
            for (name, text) in texts {
                zip.start_file(format!("{name}.npy"), options)?;
                zip.write_all(&header::write(&format!("<U{}", text.chars().count()), &[]))?;
                for character in text.chars() {
                    zip.write_all(&u32::from(character).to_le_bytes())?;
                }
            }
            zip.finish()?.flush()
        };
        complete().map_err(|source| Error::io(&self.path, source))?;
        self.draft.keep(&self.output)
    }
}

/// One channel out of the spool.
fn copy_column(
    spool: &mut File,
    output: &mut dyn Write,
    column: u64,
    columns: u64,
    rows: u64,
    piece: u64,
) -> io::Result<()> {
    let mut bytes = vec![0; (piece.min(rows) * F8) as usize];
    let mut at = 0;
    while at < rows {
        let count = piece.min(rows - at);
        let bytes = bytes.get_mut(..(count * F8) as usize).unwrap_or_default();
        spool.seek(SeekFrom::Start((at * columns + column * count) * F8))?;
        spool.read_exact(bytes)?;
        output.write_all(bytes)?;
        at += count;
    }
    Ok(())
}

/// The rate of all channels, time stamps aside, unless a channel has its name.
fn common_rate(layout: &Layout) -> Option<f64> {
    let mut rates = layout
        .channels
        .iter()
        .enumerate()
        .filter(|(at, _)| Some(*at) != layout.time)
        .map(|(_, channel)| channel.sample_rate_hz);
    let first = rates.next()??;
    let same = rates.all(|rate| rate == Some(first));
    let free = !layout.channels.iter().any(|c| is_sample_rate(&c.name));
    (first.is_finite() && first > 0.0 && same && free).then_some(first)
}

/// Units and properties, without those whose name is a channel's.
fn texts(layout: &Layout) -> Vec<(String, &str)> {
    let units = layout.channels.iter().filter_map(|channel| {
        let unit = channel.unit.as_deref()?;
        Some((format!("{}.unit", channel.name), unit))
    });
    let properties = layout
        .properties
        .iter()
        .map(|(key, value)| (key.clone(), value.as_str()));
    let mut texts: Vec<(String, &str)> = Vec::new();
    for (name, text) in units.chain(properties) {
        // A zip entry has 16 bits for its name, a string of NumPy no end of its own.
        let fits = !text.is_empty()
            && text.len() < 1 << 14
            && name.len() < 1 << 12
            && !text.ends_with('\0');
        let free =
            layout.channels.iter().all(|c| c.name != name) && texts.iter().all(|t| t.0 != name);
        if fits && free && !is_sample_rate(&name) {
            texts.push((name, text));
        }
    }
    texts
}
