//! Rows of text to rows of accelerations: each sample is answered as soon as its successor has been read.
//!
//! | file | holds |
//! |---|---|
//! | `places` | where a line has its columns, and what it has there |
//! | `printed` | rows of answers as text on standard output |

mod places;
mod printed;

pub use printed::{Printed, is_closed_pipe};

use std::io::{self, BufRead, Write};

use anyhow::{Result, anyhow, bail};
use places::{PLACE, Places, split};
use printed::{write_headings, write_rows};
use sixaxis_core::LimbSet;
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::{Block, Layout};

use super::conditioning_stream::ConditioningStream;
use super::coordination::Coordination;
use super::decoding::Decoding;
use super::explain;
use super::recording::{AT_LIMIT, BEYOND};
use super::stream_clock::StreamClock;
use super::voltages::Voltages;

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
                        Places::by_name(&cells, &self.channels, self.excluded)
                    } else {
                        Places::by_order(&cells, &self.channels, self.excluded)
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
            if row.iter().any(|u| u.abs() >= AT_LIMIT * self.full_scale_v) {
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
            self.decoding.allow_for(self.conditioning.zero_wander());
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
        self.decoding.allow_for(self.conditioning.zero_wander());
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
