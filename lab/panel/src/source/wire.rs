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

use sixaxis_calibration::apply::voltages::Voltages;
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
        let channel = |name: &&str| {
            let mut channel = Channel::from_heading(name);
            if channels.limbs_unit.is_none() && channels.limbs.contains(&channel.name) {
                channel.unit.get_or_insert_with(|| "V".to_owned());
            }
            channel
        };
        let layout = Layout {
            channels: names.iter().map(channel).collect(),
            ..Layout::default()
        };
        let place = Path::new(PLACE);
        let limbs = find::limbs(place, &layout, channels).map_err(|e| refuse(&e.to_string()))?;
        Ok(Self {
            sample_rate_hz,
            format,
            columns: names.len(),
            limbs,
            standards: standards(&layout, channels),
        })
    }

    /// Whether rows have readings of the reference instruments.
    #[must_use]
    pub const fn has_standards(&self) -> bool {
        self.standards.is_some()
    }
}

/// Both reference instruments, where both are there in units of motion; without a unit, in SI.
pub(super) fn standards(layout: &Layout, channels: &Channels) -> Option<[Column; 2]> {
    let find = |name: &str, stated: Option<&String>| {
        let index = layout.position(name)?;
        let size_si = match layout.channels[index].unit.as_ref().or(stated) {
            None => 1.0,
            Some(text) => match unit::named(text)? {
                Unit::Acceleration(size) | Unit::Rate(size) => size,
                _ => return None,
            },
        };
        Some(Column::new(layout, index, size_si))
    };
    Some([
        find(
            &channels.accelerometer,
            channels.accelerometer_unit.as_ref(),
        )?,
        find(&channels.gyroscope, channels.gyroscope_unit.as_ref())?,
    ])
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
    #[must_use]
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
    #[must_use]
    pub const fn head(&self) -> Option<&Head> {
        self.head.as_ref()
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
        let text = std::str::from_utf8(line).map_err(|_| "not text in UTF-8".to_owned())?;
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            return Ok(());
        }
        self.row.clear();
        for cell in text
            .split([',', ';', '\t', ' '])
            .filter(|cell| !cell.is_empty())
        {
            let value = cell.parse().map_err(|_| {
                let shown: String = cell.chars().take(40).collect();
                format!("{shown:?} is not a number")
            })?;
            self.row.push(value);
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

/// Takes the samples out of a batch.
#[must_use]
pub fn taken(batch: &mut Batch) -> Batch {
    Batch {
        voltage_v: std::mem::take::<Voltages>(&mut batch.voltage_v),
        standard: std::mem::take(&mut batch.standard),
        truth: std::mem::take(&mut batch.truth),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

    const HEAD: &str = "sixaxis rate=1000 format=f64\n";

    fn read(bytes: &[u8], piece: usize) -> (Batch, Vec<WireError>, Result<(), WireError>) {
        let mut wire = Wire::new(&Channels::default());
        let (mut batch, mut refused) = (Batch::default(), Vec::new());
        for part in bytes.chunks(piece) {
            if let Err(error) = wire.take(part, &mut batch, &mut |e| refused.push(e)) {
                return (batch, refused, Err(error));
            }
        }
        (batch, refused, Ok(()))
    }

    #[test]
    fn law_pieces_of_any_size_are_the_same_samples() {
        let numbers: Vec<f64> = (0..9 * 50).map(|k| f64::from(k) * 0.1).collect();
        let mut bytes = HEAD.as_bytes().to_vec();
        bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
        let (whole, _, done) = read(&bytes, bytes.len());
        assert_eq!((done, whole.samples()), (Ok(()), 50));
        assert_eq!(whole.voltage_v.row(49)[8], f64::from(449) * 0.1);
        for piece in [1, 7, 72, 100] {
            assert_eq!(read(&bytes, piece).0, whole);
        }
    }

    #[test]
    fn law_units_and_names_are_those_of_recordings() {
        let text = "sixaxis rate=1e3 format=text columns=gyroscope[deg/s],u9[mV],u8,u7,u6,u5,u4,u3,u2,u1,other,accelerometer[g]\n180,1000,2,3,4,5,6,7,8,9,77,1\n";
        let (batch, refused, done) = read(text.as_bytes(), 10);
        assert_eq!((done, refused.len()), (Ok(()), 0));
        assert_eq!(
            batch.voltage_v.row(0),
            [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]
        );
        assert!((batch.standard[1][0] - core::f64::consts::PI).abs() < 1e-12);
        assert!((batch.standard[0][0] - STANDARD_GRAVITY_M_S2).abs() < 1e-12);
    }

    #[test]
    fn law_a_broken_row_of_text_costs_that_row_alone() {
        let text = "sixaxis rate=1000 format=text\n1 2 3 4 5 6 7 8 9\n1 2 3\nx,2,3,4,5,6,7,8,9\n# a remark\n9,8,7,6,5,4,3,2,1\n";
        let (batch, refused, done) = read(text.as_bytes(), 5);
        assert_eq!((done, batch.samples(), refused.len()), (Ok(()), 2, 2));
        assert!(
            matches!(&refused[1], WireError::Row { line: 4, cause } if cause.contains("\"x\""))
        );
    }

    #[test]
    fn law_heads_that_are_none_are_refused() {
        for (head, part) in [
            ("GET / HTTP/1.1\n", "sixaxis"),
            ("sixaxis\n", "rate"),
            ("sixaxis rate=-1\n", "rate"),
            ("sixaxis rate=nan\n", "rate"),
            ("sixaxis rate=1e300\n", "rate"),
            ("sixaxis rate=1000 format=f16\n", "format"),
            ("sixaxis rate=1000 colour=red\n", "keys"),
            ("sixaxis rate=1000 columns=u1,u2\n", "u3"),
            (
                "sixaxis rate=1000 columns=u1[g],u2,u3,u4,u5,u6,u7,u8,u9\n",
                "u1",
            ),
        ] {
            match read(head.as_bytes(), 3).2 {
                Err(WireError::Head(cause)) => assert!(cause.contains(part), "{head}: {cause}"),
                other => panic!("{head}: {other:?}"),
            }
        }
        let endless = vec![b'a'; LONGEST_LINE + 2];
        assert_eq!(read(&endless, 100).2, Err(WireError::Endless { line: 1 }));
    }

    #[test]
    fn prop_no_bytes_make_it_panic() {
        let mut state = 7_u64;
        let mut byte = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as u8
        };
        for round in 0..1_000 {
            let mut bytes = match round % 4 {
                0 => Vec::new(),
                1 => HEAD.as_bytes().to_vec(),
                2 => b"sixaxis rate=1000 format=text\n".to_vec(),
                _ => b"sixaxis rate=1000 format=f32\n".to_vec(),
            };
            bytes.extend((0..usize::from(byte())).map(|_| byte()));
            let _ = read(&bytes, 1 + usize::from(byte()));
        }
    }
}
