//! Rows of text to rows of accelerations: each sample is answered as soon as its successor has been read.

use std::io::{self, BufRead, Write};

use anyhow::{Result, anyhow, bail, ensure};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_recordings::channel::{Layout, time_channel};
use sixaxis_recordings::ingest::find::{self, Column};
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::{Block, Channel};

use super::conditioning_stream::ConditioningStream;
use super::coordination::Coordination;
use super::decoding::Decoding;
use super::recording::BEYOND;
use super::stream_clock::StreamClock;
use super::voltages::Voltages;
use super::{Row, explain};

/// Name of the stream in messages.
const PLACE: &str = "standard input";

/// How a stream ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The input ended.
    Input {
        /// Rows written.
        rows: u64,
    },
    /// Nobody reads the output any more.
    Closed,
}

/// What a stream is decoded with.
pub struct TextStream {
    /// Stages before the decoder.
    pub conditioning: ConditioningStream,
    /// The decoder, with what runs beside it.
    pub decoding: Decoding,
    /// The columns that it answers in.
    pub layout: Layout,
    /// Limbs whose channels are not read.
    pub excluded: LimbSet,
    /// Whether channels may fail.
    pub watched: bool,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Names and units of the channels.
    pub channels: Channels,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
}

/// Where things stand in a line: limbs whose channels are not read nowhere.
struct Places {
    limbs: [Option<Column>; LIMBS],
    names: [String; LIMBS],
    time: Option<Column>,
    columns: usize,
}

impl TextStream {
    /// Decodes lines until the input ends, a line cannot be read or nobody listens. Each answer is flushed.
    ///
    /// The first line may be headings, with units as in `u1 [mV]`; without, a line is nine numbers in the unit that the
    /// calibration has for its channels, or volts. Commas, semicolons, tabs or blanks separate numbers; lines that begin with
    /// `#` and empty ones are passed over. `warn` is told of the first sample at the converter's limit.
    ///
    /// # Errors
    /// The first broken line with its number and cause, once everything before it is out; an input or output that fails.
    pub fn run(
        self,
        input: &mut dyn BufRead,
        output: &mut dyn Write,
        warn: &dyn Fn(String),
    ) -> Result<End> {
        match self.follow(input, output, warn) {
            Err(error)
                if error
                    .downcast_ref::<io::Error>()
                    .is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe) =>
            {
                Ok(End::Closed)
            }
            other => other,
        }
    }

    fn follow(
        mut self,
        input: &mut dyn BufRead,
        output: &mut dyn Write,
        warn: &dyn Fn(String),
    ) -> Result<End> {
        write_headings(output, &self.layout)?;
        let mut places = None;
        let mut clock = StreamClock::default();
        let mut line = Vec::new();
        let (mut number, mut samples, mut clipped) = (0_u64, 0_u64, 0_u64);
        let (mut received, mut ready) = (Voltages::default(), Voltages::default());
        let mut block = Block::default();
        loop {
            line.clear();
            if input.read_until(b'\n', &mut line)? == 0 {
                break;
            }
            number += 1;
            let at_line = |cause: String| anyhow!("{PLACE}, line {number}: {cause}");
            let text = std::str::from_utf8(&line)
                .map_err(|_| at_line("not text in UTF-8".to_owned()))?
                .trim_start_matches('\u{feff}')
                .trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let cells = split(text);
            let places = match &mut places {
                Some(places) => &*places,
                none => {
                    let headings = cells.iter().all(|cell| cell.parse::<f64>().is_err());
                    let found = if headings {
                        self.by_name(&cells)
                    } else {
                        self.by_order(&cells)
                    };
                    let found = none.insert(found.map_err(|e| at_line(format!("{e:#}")))?);
                    if headings {
                        continue;
                    }
                    found
                }
            };
            let row = places.read(&cells, self.watched).map_err(at_line)?;
            let stamp_s = match &places.time {
                Some(time) => {
                    let cell = cells[time.index].trim_matches('"');
                    let stamp_s = clock.read(cell, time.size_si);
                    let none = || at_line(format!("{}: {cell:?} is no time", time.name));
                    Some(stamp_s.ok_or_else(none)?)
                }
                None => None,
            };
            let odd = stamp_s.and_then(|stamp_s| clock.look(stamp_s, self.sample_rate_hz));
            if let Some(odd) = odd {
                warn(format!("{PLACE}, line {number}: {odd}"));
            }
            if row.iter().any(|u| u.abs() >= self.full_scale_v) {
                clipped += 1;
                if clipped == 1 {
                    let most_v = row.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
                    let limit_v = self.full_scale_v;
                    warn(if most_v > BEYOND * limit_v {
                        format!(
                            "{PLACE}, line {number}: {most_v:.1} V, which a converter of {limit_v} V does not give; are the numbers millivolts (--unit mV)?"
                        )
                    } else {
                        format!(
                            "{PLACE}, line {number}: a sample at the converter's limit of {limit_v} V; the accelerations are wrong there"
                        )
                    });
                }
            }
            self.decoding
                .stamps(&[stamp_s.unwrap_or(samples as f64 / self.sample_rate_hz)]);
            samples += 1;
            ready.clear();
            received.push(&row);
            self.conditioning.push(&mut received, &mut ready);
            self.decoding
                .decode(ready.all(), &mut block)
                .map_err(|error| {
                    explain(&error, &format!("{PLACE}, line {number}"), &places.names)
                })?;
            self.decoding.messages().into_iter().for_each(warn);
            let broken = self.decoding.coordination.as_mut();
            if let Some(broken) = broken.and_then(Coordination::verdict_so_far) {
                warn(format!("{PLACE}, line {number}: {broken}"));
            }
            write_rows(output, &block)?;
        }
        // What the stages still hold is answered, too.
        ready.clear();
        self.conditioning.finish(&mut ready)?;
        if let Some(places) = &places {
            self.decoding
                .decode(ready.all(), &mut block)
                .map_err(|error| explain(&error, PLACE, &places.names))?;
            write_rows(output, &block)?;
        }
        self.decoding.finish();
        self.decoding.messages().into_iter().for_each(warn);
        let broken = self.decoding.coordination.as_mut();
        if let Some(broken) = broken.and_then(Coordination::verdict) {
            warn(format!("{PLACE}: {broken}"));
        }
        if clock.odd > 1 {
            warn(format!(
                "{PLACE}: {} time stamps in all are not a step behind the one before",
                clock.odd
            ));
        }
        if clipped > 1 {
            warn(format!(
                "{PLACE}: {clipped} samples at the converter's limit in all"
            ));
        }
        Ok(End::Input {
            rows: self.decoding.rows,
        })
    }

    fn by_name(&self, cells: &[&str]) -> Result<Places> {
        let channels: Vec<Channel> = cells
            .iter()
            .map(|cell| self.in_volts(Channel::from_heading(cell.trim_matches('"'))))
            .collect();
        let time = match &self.channels.time {
            Some(name) => channels.iter().position(|c| c.name == *name),
            None => time_channel(&channels),
        };
        let layout = Layout {
            channels,
            time,
            ..Layout::default()
        };
        let time = find::time(PLACE.as_ref(), &layout, None)?;
        self.places(&layout, time, cells.len())
    }

    fn by_order(&self, cells: &[&str]) -> Result<Places> {
        let columns = cells.len();
        ensure!(
            !cells.iter().any(|cell| cell.contains(';')),
            "numbers have decimal points in a stream, and commas or semicolons between them, not both: is this one with decimal commas?"
        );
        ensure!(
            columns == LIMBS,
            "{columns} numbers, {LIMBS} were expected; where there are more, begin with a line of headings"
        );
        let layout = Layout {
            channels: self
                .channels
                .limbs
                .iter()
                .map(|name| self.in_volts(Channel::new(name.clone(), None)))
                .collect(),
            ..Layout::default()
        };
        self.places(&layout, None, columns)
    }

    fn places(&self, layout: &Layout, time: Option<Column>, columns: usize) -> Result<Places> {
        let mut limbs = [const { None }; LIMBS];
        for (limb, column) in limbs.iter_mut().enumerate() {
            if !self.excluded.contains(limb) {
                *column = Some(find::limb(PLACE.as_ref(), layout, &self.channels, limb)?);
            }
        }
        Ok(Places {
            limbs,
            names: self.channels.limbs.clone(),
            time,
            columns,
        })
    }

    /// Volts, where neither heading nor calibration says a limb's unit.
    fn in_volts(&self, mut channel: Channel) -> Channel {
        if self.channels.limbs_unit.is_none() && self.channels.limbs.contains(&channel.name) {
            channel.unit.get_or_insert_with(|| "V".to_owned());
        }
        channel
    }
}

impl Places {
    /// Voltages of a line. Excluded limbs' cells are not parsed and read 0. With `watched`, a cell that is not a
    /// finite number becomes NaN, which the fault monitor takes for a failure, instead of an error.
    fn read(&self, cells: &[&str], watched: bool) -> Result<Row, String> {
        if cells.len() != self.columns {
            return Err(format!(
                "{} columns, {} were expected",
                cells.len(),
                self.columns
            ));
        }
        let number = |name: &str, index: usize| -> Result<f64, String> {
            match cells[index].parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                Ok(value) => Err(format!("{name}: {value} is not a finite number")),
                Err(_) => {
                    let shown: String = cells[index].chars().take(40).collect();
                    Err(format!("{name}: {shown:?} is not a number"))
                }
            }
        };
        let mut row = [0.0; LIMBS];
        for (value, limb) in row.iter_mut().zip(&self.limbs) {
            let Some(limb) = limb else {
                continue;
            };
            *value = limb.size_si
                * match number(&limb.name, limb.index) {
                    Err(_) if watched => f64::NAN,
                    read => read?,
                };
        }
        Ok(row)
    }
}

fn split(text: &str) -> Vec<&str> {
    for separator in [',', ';', '\t'] {
        if text.contains(separator) {
            return text.split(separator).map(str::trim).collect();
        }
    }
    text.split_whitespace().collect()
}

/// Writes the headings of a table and flushes.
///
/// # Errors
/// Those of the output.
pub fn write_headings(output: &mut dyn Write, layout: &Layout) -> io::Result<()> {
    let headings: Vec<String> = layout.channels.iter().map(Channel::heading).collect();
    writeln!(output, "{}", headings.join(","))?;
    output.flush()
}

/// Writes the rows of a block, each flushed by itself where there is one only.
///
/// # Errors
/// Those of the output.
pub fn write_rows(output: &mut dyn Write, block: &Block) -> io::Result<()> {
    use std::fmt::Write as _;
    let rows = block.rows();
    let mut text = String::new();
    for row in 0..rows {
        for (index, column) in block.columns.iter().enumerate() {
            if index > 0 {
                text.push(',');
            }
            // The shortest digits that read back the same, with a power of ten where zeros would be many.
            let _ = write!(text, "{:?}", column[row]);
        }
        text.push('\n');
    }
    if rows > 0 {
        output.write_all(text.as_bytes())?;
        output.flush()?;
    }
    Ok(())
}

/// Standard output as a sink: rows of comma-separated values.
pub struct Printed<W: Write + Send> {
    output: W,
}

impl<W: Write + Send> Printed<W> {
    /// Writes the headings.
    ///
    /// # Errors
    /// Those of the output.
    pub fn create(mut output: W, layout: &Layout) -> Result<Self> {
        write_headings(&mut output, layout)?;
        Ok(Self { output })
    }
}

impl<W: Write + Send> sixaxis_recordings::Sink for Printed<W> {
    fn write(&mut self, block: &Block) -> sixaxis_recordings::Result<()> {
        write_rows(&mut self.output, block)
            .map_err(|source| sixaxis_recordings::Error::io("standard output".as_ref(), source))
    }

    fn finish(mut self: Box<Self>) -> sixaxis_recordings::Result<()> {
        self.output
            .flush()
            .map_err(|source| sixaxis_recordings::Error::io("standard output".as_ref(), source))
    }
}

/// Whether an error says that nobody reads the output any more.
#[must_use]
pub fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let broken = |e: &io::Error| e.kind() == io::ErrorKind::BrokenPipe;
    match error.downcast_ref::<sixaxis_recordings::Error>() {
        Some(sixaxis_recordings::Error::Io { source, .. }) => broken(source),
        _ => error.downcast_ref::<io::Error>().is_some_and(broken),
    }
}

/// Refuses what a stream cannot do.
///
/// # Errors
/// If anything of it is asked for.
pub fn refuse(asked: &[(bool, &str)]) -> Result<()> {
    for (is_asked, what) in asked {
        if *is_asked {
            bail!("{what} is not for a stream (RECORDING is -)");
        }
    }
    Ok(())
}
