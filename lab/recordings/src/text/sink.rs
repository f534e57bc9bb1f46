//! Comma-separated values, out.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::detect::is_missing;
use super::gzip::Gzip;
use crate::channel::{Block, Channel, Layout, MOST_CHANNELS, is_sample_rate};
use crate::draft::Draft;
use crate::error::{Error, Place, Result};
use crate::sink::Sink;

/// A file being written.
pub struct TextSink {
    path: PathBuf,
    draft: Draft,
    output: Output,
    columns: usize,
    rows: Vec<u8>,
}

enum Output {
    Plain(BufWriter<File>),
    Gzip(Gzip<BufWriter<File>>),
}

impl Output {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Plain(output) => output.write_all(bytes),
            Self::Gzip(output) => output.write_all(bytes),
        }
    }

    fn finish(self) -> io::Result<File> {
        let output = match self {
            Self::Plain(output) => output,
            Self::Gzip(output) => output.finish()?,
        };
        output.into_inner().map_err(io::IntoInnerError::into_error)
    }
}

impl TextSink {
    /// Opens the draft and writes comments and headings.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Unsupported`].
    pub fn create(path: &Path, layout: &Layout) -> Result<Self> {
        let columns = layout.channels.len();
        if columns == 0 || columns > MOST_CHANNELS {
            return Err(Error::unsupported(
                path,
                format!("a table of {columns} columns"),
                format!("write 1 to {MOST_CHANNELS} channels"),
            ));
        }
        let (draft, file) = Draft::create(path)?;
        let file = BufWriter::with_capacity(1 << 18, file);
        let gzip = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("gz"));
        let mut sink = Self {
            path: path.to_owned(),
            draft,
            output: if gzip {
                Output::Gzip(Gzip::new(file).map_err(|source| Error::io(path, source))?)
            } else {
                Output::Plain(file)
            },
            columns,
            rows: Vec::new(),
        };
        sink.put(head(layout).as_bytes())?;
        Ok(sink)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        let written = self.output.write_all(bytes);
        written.map_err(|source| Error::io(&self.path, source))
    }
}

/// Comments and headings.
fn head(layout: &Layout) -> String {
    let mut head = String::new();
    let rate = common_rate(layout);
    if let Some(rate) = rate {
        head += &format!("# sample_rate_hz = {rate}\n");
    }
    for (key, value) in &layout.properties {
        let key = one_line(key).replace(['=', ':'], "_");
        // A rate in the properties that is not that of the channels would be read as theirs.
        if !is_sample_rate(&key) {
            head += &format!("# {key} = {}\n", one_line(value));
        }
    }
    let named = layout.channels.iter().enumerate();
    let headings: Vec<String> = named.map(|(at, channel)| heading(at, channel)).collect();
    head + &headings.join(",") + "\n"
}

/// The rate of all channels, time stamps aside, if it is the same.
fn common_rate(layout: &Layout) -> Option<f64> {
    let mut rates = layout
        .channels
        .iter()
        .enumerate()
        .filter(|(at, _)| Some(*at) != layout.time)
        .map(|(_, channel)| channel.sample_rate_hz);
    let first = rates.next()??;
    (first.is_finite() && first > 0.0 && rates.all(|rate| rate == Some(first))).then_some(first)
}

fn heading(at: usize, channel: &Channel) -> String {
    let mut heading = one_line(&channel.heading());
    if heading.trim().is_empty() {
        heading = format!("column_{}", at + 1);
    }
    // `f (x)` without a unit would be read as `f` in x, `1` as a number and `-` as a missing one; empty brackets say that
    // there is no unit.
    let mistaken = Channel::from_heading(&heading).unit.is_some()
        || heading.parse::<f64>().is_ok()
        || is_missing(&heading);
    if channel.unit.is_none() && mistaken {
        heading += " []";
    }
    if heading.contains([',', ';', '"', '#', '%']) {
        heading = format!("\"{}\"", heading.replace('"', "\"\""));
    }
    heading
}

fn one_line(text: &str) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

impl Sink for TextSink {
    fn write(&mut self, block: &Block) -> Result<()> {
        let rows = block.rows();
        if block.columns.len() != self.columns || block.columns.iter().any(|c| c.len() != rows) {
            let cause = format!(
                "a block to write has not {} columns of one length",
                self.columns
            );
            return Err(Error::malformed(&self.path, Place::Whole, cause));
        }
        let mut text = std::mem::take(&mut self.rows);
        let mut digits = zmij::Buffer::new();
        for row in 0..rows {
            for (at, value) in block.columns.iter().filter_map(|c| c.get(row)).enumerate() {
                if at > 0 {
                    text.push(b',');
                }
                let number = match *value {
                    value if value.is_nan() => "nan",
                    f64::INFINITY => "inf",
                    f64::NEG_INFINITY => "-inf",
                    value => digits.format_finite(value),
                };
                text.extend_from_slice(number.strip_suffix(".0").unwrap_or(number).as_bytes());
            }
            text.push(b'\n');
            if text.len() > 1 << 16 {
                self.put(&text)?;
                text.clear();
            }
        }
        self.put(&text)?;
        text.clear();
        self.rows = text;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let file = self
            .output
            .finish()
            .map_err(|source| Error::io(&self.path, source))?;
        self.draft.keep(&file)
    }
}
