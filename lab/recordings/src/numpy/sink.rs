//! Arrays, out.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

use super::header;
use crate::channel::is_sample_rate;
use crate::draft::folder_of;
use crate::error::Result;
use crate::layout::Layout;
use crate::sink::{self, Encoder, Sink};

/// Bytes of an f64.
const F8: u64 = 8;
/// Memory for samples on their way to the file or the spool, bytes.
const PIECE: usize = 1 << 22;

/// Starts an NPZ file if the name ends with `.npz`, else an NPY file.
///
/// # Errors
/// Those of [`sink::create`].
pub(crate) fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    let channels = layout.channels.len();
    let piece = (PIECE / F8 as usize / channels.max(1)).max(1);
    let is_npz = |extension: &std::ffi::OsStr| extension.eq_ignore_ascii_case("npz");
    if path.extension().is_some_and(is_npz) {
        return sink::create(path, layout, |output| {
            Ok(Npz {
                output,
                layout: layout.clone(),
                spool: tempfile::tempfile_in(folder_of(path))?,
                piece,
                rows: 0,
            })
        });
    }
    sink::create(path, layout, |file| {
        let mut output = BufWriter::with_capacity(1 << 18, file);
        output.write_all(&header::write("<f8", &[0, channels as u64]))?;
        Ok(Npy {
            output,
            columns: channels,
            piece,
            rows: 0,
        })
    })
}

/// An array of two dimensions being written, behind a header of no rows.
struct Npy {
    output: BufWriter<File>,
    columns: usize,
    piece: usize,
    rows: u64,
}

impl Encoder for Npy {
    fn rows(&self) -> usize {
        self.piece
    }

    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        let rows = columns.first().map_or(0, Vec::len);
        for row in 0..rows {
            for column in columns {
                self.output.write_all(&column[row].to_le_bytes())?;
            }
        }
        self.rows += rows as u64;
        Ok(())
    }

    fn finish(self) -> io::Result<File> {
        let mut file = self
            .output
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&header::write("<f8", &[self.rows, self.columns as u64]))?;
        Ok(file)
    }
}

/// A file of one array per channel being written.
struct Npz {
    output: File,
    layout: Layout,
    /// Pieces of `piece` rows, each channel after channel, in a file without a name beside the draft.
    spool: File,
    piece: usize,
    /// Rows in the spool.
    rows: u64,
}

impl Encoder for Npz {
    fn rows(&self) -> usize {
        self.piece
    }

    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        for column in columns {
            let bytes: Vec<u8> = column.iter().flat_map(|x| x.to_le_bytes()).collect();
            self.spool.write_all(&bytes)?;
        }
        self.rows += columns.first().map_or(0, Vec::len) as u64;
        Ok(())
    }

    fn finish(mut self) -> io::Result<File> {
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
            let (spool, piece) = (&mut self.spool, self.piece as u64);
            copy_column(spool, &mut zip, at as u64, channels, self.rows, piece)?;
        }
        // A channel may have the name of the rate.
        let free = !layout.channels.iter().any(|c| is_sample_rate(&c.name));
        if let Some(rate) = layout.common_rate_hz().filter(|_| free) {
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
        zip.finish()?.flush()?;
        Ok(self.output)
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
