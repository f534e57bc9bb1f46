//! Samples on a wire: a line that describes them, then rows of text or little-endian numbers.
//!
//! ```text
//! sixaxis rate=10000 format=f64 columns=u1,u2,u3,u4,u5,u6,u7,u8,u9,accelerometer[m/s^2],gyroscope[rad/s]
//! ```
//!
//! `format` is `text` (a row a line, commas, semicolons, tabs or blanks between numbers), `f64` or `f32` (a row is as many
//! little-endian numbers as there are columns, nothing between rows). Names are as in a recording, units in brackets; limbs
//! without a unit are in V. Columns that the instrument does not know are passed over.

use std::path::Path;

use sixaxis_core::LIMBS;
use sixaxis_recordings::ingest::find::{self, Column};
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::unit::{self, Unit};
use sixaxis_recordings::{Channel, Layout};
use thiserror::Error;

use crate::columns::Batch;

/// Longest head, and longest row of text, bytes.
pub const LONGEST_LINE: usize = 4096;
/// Most columns.
const MOST_COLUMNS: usize = 256;
/// Samples per second, from and to.
pub const RATES_HZ: (f64, f64) = (10.0, 100_000.0);
/// Why a line of other bytes is no row.
pub(super) const NO_TEXT: &str = "not text in UTF-8";
/// Place that errors of names and units are about.
const PLACE: &str = "stream";

/// What is refused of a stream.
#[derive(Debug, Error, PartialEq)]
pub enum WireError {
    /// The first line, or a row of text, does not end.
    #[error("line {line} is longer than {LONGEST_LINE} bytes")]
    Endless {
        /// The line, from 1.
        line: u64,
    },
    /// The first line is none that describes samples.
    #[error("the first line: {0}")]
    Head(String),
    /// A row of text is none.
    #[error("line {line}: {cause}")]
    Row {
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        cause: String,
    },
}

/// How rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A row a line.
    Text,
    /// Little-endian 64-bit numbers.
    F64,
    /// Little-endian 32-bit numbers.
    F32,
}

/// What the first line says.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// How rows are written.
    pub format: Format,
    columns: usize,
    limbs: [Column; LIMBS],
    /// Accelerometer and gyroscope.
    standards: Option<[Column; 2]>,
}

impl Head {
    /// Reads a first line; names and units as `channels` has them.
    ///
    /// # Errors
    /// [`WireError::Head`].
    pub fn parse(line: &str, channels: &Channels) -> Result<Self, WireError> {
        let refuse = |cause: &str| WireError::Head(cause.to_owned());
        let mut words = line.split_whitespace();
        if words.next() != Some("sixaxis") {
            return Err(refuse("it does not begin with the word sixaxis"));
        }
        let (mut rate, mut format, mut names) = (None, Format::F64, None);
        for word in words {
            let (key, value) = word
                .split_once('=')
                .ok_or_else(|| refuse("words are KEY=VALUE"))?;
            match key {
                "rate" => rate = value.parse::<f64>().ok(),
                "format" => {
                    format = match value {
                        "text" => Format::Text,
                        "f64" => Format::F64,
                        "f32" => Format::F32,
                        _ => return Err(refuse("format is text, f64 or f32")),
                    }
                }
                "columns" => names = Some(value),
                _ => return Err(refuse("keys are rate, format and columns")),
            }
        }
        let sample_rate_hz = rate
            .filter(|hz| (RATES_HZ.0..=RATES_HZ.1).contains(hz))
            .ok_or_else(|| refuse("rate is a number of samples per second from 10 to 100000"))?;
        let names: Vec<&str> = match names {
            Some(names) => names.split(',').collect(),
            None => channels.limbs.iter().map(String::as_str).collect(),
        };
        if names.len() > MOST_COLUMNS {
            return Err(refuse("more than 256 columns"));
        }
        let channel = |name: &&str| channels.in_volts(Channel::from_heading(name));
        let layout = Layout {
            channels: names.iter().map(channel).collect(),
            ..Layout::default()
        };
        for (index, channel) in layout.channels.iter().enumerate() {
            if layout.position(&channel.name) != Some(index) {
                return Err(refuse(&format!("column {} is there twice", channel.name)));
            }
        }
        let place = Path::new(PLACE);
        let limbs = find::limbs(place, &layout, channels).map_err(|e| refuse(&e.to_string()))?;
        Ok(Self {
            sample_rate_hz,
            format,
            columns: names.len(),
            limbs,
            standards: standards(place, &layout, channels).map_err(|e| refuse(&e.to_string()))?,
        })
    }

    /// Whether rows have readings of the reference instruments.
    pub const fn has_standards(&self) -> bool {
        self.standards.is_some()
    }
}

/// Both reference instruments, where both are there in units of motion; without a unit, in SI.
///
/// # Errors
/// [`sixaxis_recordings::Error::Unit`] for a unit that is not known, where the session states no other.
pub(super) fn standards(
    path: &Path,
    layout: &Layout,
    channels: &Channels,
) -> sixaxis_recordings::Result<Option<[Column; 2]>> {
    let places = [&channels.accelerometer, &channels.gyroscope].map(|name| layout.position(name));
    let [Some(accelerometer), Some(gyroscope)] = places else {
        return Ok(None);
    };
    let column = |index: usize, stated: Option<&String>| {
        let channel = &layout.channels[index];
        let texts = [channel.unit.as_ref(), stated];
        let known = texts
            .into_iter()
            .flatten()
            .find_map(|text| unit::named(text));
        let size_si = match (known, texts) {
            (Some(Unit::Acceleration(size) | Unit::Rate(size)), _) => size,
            (None, [None, None]) => 1.0,
            (Some(_), _) => return Ok(None),
            (None, [own, stated]) => {
                let text = own.or(stated).map_or("", String::as_str);
                return Err(sixaxis_recordings::Error::Unit {
                    file: path.display().to_string(),
                    channel: channel.name.clone(),
                    cause: format!("unit {text:?} is not known; give the session a *_unit for it"),
                });
            }
        };
        Ok(Some(Column::new(layout, index, size_si)))
    };
    let accelerometer = column(accelerometer, channels.accelerometer_unit.as_ref())?;
    let gyroscope = column(gyroscope, channels.gyroscope_unit.as_ref())?;
    Ok(accelerometer.zip(gyroscope).map(<[Column; 2]>::from))
}

/// Takes bytes as they come, in pieces of any size, and hands out samples.
pub struct Wire {
    channels: Channels,
    head: Option<Head>,
    pending: Vec<u8>,
    lines: u64,
    row: Vec<f64>,
    /// Rows of text that were refused; the samples around them are kept.
    pub refused: u64,
}

impl Wire {
    /// Nothing received.
    pub fn new(channels: &Channels) -> Self {
        Self {
            channels: channels.clone(),
            head: None,
            pending: Vec::new(),
            lines: 0,
            row: Vec::new(),
            refused: 0,
        }
    }

    /// What the first line says, once it has come.
    pub const fn head(&self) -> Option<&Head> {
        self.head.as_ref()
    }

    /// Bytes that have come and are no whole row, or no whole first line, yet.
    pub const fn unfinished(&self) -> usize {
        self.pending.len()
    }

    /// Takes the next bytes and appends the samples that they complete. A row of text that is none is counted in
    /// [`Self::refused`] and its error handed to `refuse`.
    ///
    /// # Errors
    /// [`WireError::Head`] and [`WireError::Endless`], after which nothing that follows can be understood.
    pub fn take(
        &mut self,
        bytes: &[u8],
        batch: &mut Batch,
        refuse: &mut dyn FnMut(WireError),
    ) -> Result<(), WireError> {
        self.pending.extend_from_slice(bytes);
        let mut used = 0;
        if self.head.is_none() {
            let Some(line) = self.line(0)? else {
                return Ok(());
            };
            let text = String::from_utf8_lossy(&self.pending[..line]).into_owned();
            self.head = Some(Head::parse(text.trim(), &self.channels)?);
            used = line + 1;
            self.lines = 1;
        }
        let Some(head) = self.head.clone() else {
            return Ok(());
        };
        match head.format {
            Format::F64 => used += self.binary::<8>(used, &head, f64::from_le_bytes, batch),
            Format::F32 => {
                let wide = |bytes| f64::from(f32::from_le_bytes(bytes));
                used += self.binary::<4>(used, &head, wide, batch);
            }
            Format::Text => {
                while let Some(length) = self.line(used)? {
                    self.lines += 1;
                    let line = self.pending[used..used + length].to_vec();
                    used += length + 1;
                    if let Err(cause) = self.text(&line, &head, batch) {
                        self.refused += 1;
                        refuse(WireError::Row {
                            line: self.lines,
                            cause,
                        });
                    }
                }
            }
        }
        self.pending.drain(..used);
        Ok(())
    }

    /// Length of the line that begins at a byte, without its end; none if it has not ended yet.
    fn line(&self, from: usize) -> Result<Option<usize>, WireError> {
        let rest = &self.pending[from..];
        let window = &rest[..rest.len().min(LONGEST_LINE + 1)];
        match window.iter().position(|byte| *byte == b'\n') {
            None if window.len() > LONGEST_LINE => Err(WireError::Endless {
                line: self.lines + 1,
            }),
            found => Ok(found),
        }
    }

    fn binary<const SIZE: usize>(
        &mut self,
        from: usize,
        head: &Head,
        number: impl Fn([u8; SIZE]) -> f64,
        batch: &mut Batch,
    ) -> usize {
        let (numbers, _) = self.pending[from..].as_chunks::<SIZE>();
        let rows = numbers.chunks_exact(head.columns);
        let used = rows.len() * head.columns * SIZE;
        for row in rows {
            append(head, |column| number(row[column]), batch);
        }
        used
    }

    fn text(&mut self, line: &[u8], head: &Head, batch: &mut Batch) -> Result<(), String> {
        if is_remark(line) {
            return Ok(());
        }
        let text = std::str::from_utf8(line).map_err(|_| NO_TEXT.to_owned())?;
        self.row.clear();
        for cell in text
            .trim()
            .split([',', ';', '\t', ' '])
            .filter(|cell| !cell.is_empty())
        {
            self.row.push(number(cell)?);
        }
        if self.row.len() != head.columns {
            return Err(format!(
                "{} numbers, {} were expected",
                self.row.len(),
                head.columns
            ));
        }
        append(head, |column| self.row[column], batch);
        Ok(())
    }
}

/// Whether a line of text is meant to be no row.
pub(super) fn is_remark(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.starts_with(b"#")
}

/// The number of a cell, or why it is none.
pub(super) fn number(cell: &str) -> Result<f64, String> {
    cell.parse().map_err(|_| {
        let shown: String = cell.chars().take(40).collect();
        format!("{shown:?} is not a number")
    })
}

/// Appends one row.
fn append(head: &Head, value: impl Fn(usize) -> f64, batch: &mut Batch) {
    let si = |column: &Column| value(column.index) * column.size_si;
    let row: [f64; LIMBS] = head.limbs.each_ref().map(si);
    batch.voltage_v.push(&row);
    if let Some(standards) = &head.standards {
        for (readings, column) in batch.standard.iter_mut().zip(standards) {
            readings.push(si(column));
        }
    }
}

#[cfg(test)]
mod tests;
