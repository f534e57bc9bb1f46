//! Comma-separated values, out.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::detect::is_missing;
use super::gzip::Gzip;
use crate::channel::{Channel, is_sample_rate};
use crate::error::Result;
use crate::layout::Layout;
use crate::sink::{self, Encoder, Sink};

/// Rows that are turned into text at once.
const ROWS: usize = 1024;

/// Starts a file of comma-separated values, compressed if its name ends with `.gz`. Properties and the sample rate, if all
/// channels have the same, are comments at the top; headings are `name [unit]`; numbers are the shortest that read back the
/// same.
///
/// # Errors
/// Those of [`sink::create`].
pub(crate) fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    let gzip = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    sink::create(path, layout, |file| {
        let file = BufWriter::with_capacity(1 << 18, file);
        let mut output = if gzip {
            Output::Gzip(Gzip::new(file)?)
        } else {
            Output::Plain(file)
        };
        output.write_all(head(layout).as_bytes())?;
        Ok(output)
    })
}

/// A file being written.
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
}

impl Encoder for Output {
    fn rows(&self) -> usize {
        ROWS
    }

    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        let mut text = Vec::new();
        let mut digits = zmij::Buffer::new();
        for row in 0..columns.first().map_or(0, Vec::len) {
            for (at, column) in columns.iter().enumerate() {
                if at > 0 {
                    text.push(b',');
                }
                let number = match column[row] {
                    value if value.is_nan() => "nan",
                    f64::INFINITY => "inf",
                    f64::NEG_INFINITY => "-inf",
                    value => digits.format_finite(value),
                };
                text.extend_from_slice(number.strip_suffix(".0").unwrap_or(number).as_bytes());
            }
            text.push(b'\n');
        }
        self.write_all(&text)
    }

    fn finish(self) -> io::Result<File> {
        let output = match self {
            Self::Plain(output) => output,
            Self::Gzip(output) => output.finish()?,
        };
        output.into_inner().map_err(io::IntoInnerError::into_error)
    }
}

/// Comments and headings.
fn head(layout: &Layout) -> String {
    let mut head = String::new();
    if let Some(rate) = layout.common_rate_hz() {
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

fn heading(at: usize, channel: &Channel) -> String {
    let mut heading = one_line(&channel.heading());
    if heading.trim().is_empty() {
        heading = format!("column_{}", at + 1);
    }
    // `1` would be read as a number and `-` as a missing one; empty brackets say that there is no unit.
    if channel.unit.is_none() && (heading.parse::<f64>().is_ok() || is_missing(&heading)) {
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
