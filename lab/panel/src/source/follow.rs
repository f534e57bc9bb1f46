//! A file that another program is writing, followed: rows of text as each ends, segments of TDMS as each is complete.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;
use std::time::Duration;

use anyhow::{Result, bail};
use sixaxis_calibration::apply::recording;
use sixaxis_core::LIMBS;
use sixaxis_recordings::Block;
use sixaxis_recordings::ingest::find::{self, Column};
use sixaxis_recordings::session::Channels;

use super::wire::{NO_TEXT, WireError, is_remark, number, standards};
use super::{Begin, Event, LONGEST_BATCH, Sender, Start, TOLD};
use crate::columns::Batch;

/// Lines that may be headings.
const HEADINGS: u64 = 100;
/// Time between two looks at the file.
const LOOK: Duration = Duration::from_millis(100);

/// What is known of the file from its head.
pub struct Follower {
    start: Start,
    wanted: Vec<Column>,
    channels: usize,
    /// Text with decimal commas; none for TDMS.
    text: Option<bool>,
}

impl Follower {
    /// Reads the head. The rate must be in the file or be given.
    ///
    /// # Errors
    /// A file that is neither text nor TDMS or has no head yet, a missing channel, a rate that nobody says.
    pub fn open(path: &Path, channels: &Channels, rate_hz: Option<f64>) -> Result<Self> {
        let source = sixaxis_recordings::open(path)?;
        let layout = source.layout();
        let text = if layout.format.starts_with("TDMS") {
            None
        } else if layout.format.starts_with("CSV") || layout.format.contains("separated") {
            Some(layout.format.contains("decimal comma"))
        } else {
            bail!(
                "{}: {} cannot be followed; CSV and TDMS can",
                path.display(),
                layout.format
            );
        };
        let limbs = find::limbs(path, layout, channels)?;
        let sample_rate_hz = recording::rate_hz(path, layout, &limbs, None, rate_hz)?;
        let standards = standards(path, layout, channels)?;
        let mut wanted = limbs.to_vec();
        wanted.extend(standards.iter().flatten().cloned());
        Ok(Self {
            start: Start::of_a_file("growing file", path, sample_rate_hz, standards.is_some()),
            wanted,
            channels: layout.channels.len(),
            text,
        })
    }

    /// Follows it until the instrument is shut down or the file cannot be read any more. `begin` is what a session says of it.
    pub fn run(self, path: &Path, begin: Option<Begin>, sender: &Sender) {
        if !super::starts(&self.start, begin, sender) {
            return;
        }
        let done = match self.text {
            Some(decimal_comma) => self.follow_text(path, decimal_comma, sender),
            None => self.follow_tdms(path, sender),
        };
        if let Err(error) = done {
            let _ = sender.send(Event::Note(format!("{}: {error}", self.start.title)));
        }
    }

    fn hand_over(&self, rows: &mut Batch, sender: &Sender) -> bool {
        rows.samples() == 0
            || sender
                .send(Event::Samples(Box::new(std::mem::take(rows))))
                .is_ok()
    }

    fn follow_text(&self, path: &Path, decimal_comma: bool, sender: &Sender) -> Result<()> {
        let mut file = BufReader::new(File::open(path)?);
        let mut batch = Batch::default();
        let mut bytes = Vec::new();
        let (mut at, mut line, mut begun) = (0_u64, 0_u64, false);
        let mut refused = 0_u64;
        loop {
            bytes.clear();
            let got = file.read_until(b'\n', &mut bytes)?;
            if got == 0 || bytes.last() != Some(&b'\n') {
                // The end of a line that is being written comes later.
                file.seek(SeekFrom::Start(at))?;
                if !self.hand_over(&mut batch, sender) {
                    return Ok(());
                }
                if std::fs::metadata(path)?.len() < at {
                    bail!("the file was cut short");
                }
                std::thread::sleep(LOOK);
                continue;
            }
            at += got as u64;
            line += 1;
            match self.row(&bytes, decimal_comma) {
                Ok(row) => {
                    begun = true;
                    self.append(&row, &mut batch);
                }
                // Headings and remarks are no rows of numbers.
                Err(_) if is_remark(&bytes) || (!begun && line <= HEADINGS) => {}
                Err(cause) => {
                    refused += 1;
                    let refusal = WireError::Row { line, cause };
                    let told = format!("{}, {refusal}; the row is passed over", self.start.title);
                    match refused {
                        ..=TOLD => sender.send(Event::Note(told))?,
                        // 10, 100, 1,000 ...
                        _ if 10_u64.pow(refused.ilog10()) == refused => {
                            let told = format!("{told}, the {refused}th that is none");
                            sender.send(Event::Note(told))?;
                        }
                        _ => {}
                    }
                }
            }
            if batch.samples() >= LONGEST_BATCH && !self.hand_over(&mut batch, sender) {
                return Ok(());
            }
        }
    }

    fn row(&self, line: &[u8], decimal_comma: bool) -> Result<Vec<f64>, String> {
        let text = std::str::from_utf8(line).map_err(|_| NO_TEXT.to_owned())?;
        let text = text.trim();
        let separators: &[char] = if decimal_comma {
            &[';', '\t']
        } else {
            &[',', ';', '\t']
        };
        let cells: Vec<&str> = text.split(separators).map(str::trim).collect();
        if cells.len() != self.channels {
            let (have, expected) = (cells.len(), self.channels);
            return Err(format!("{have} cells, {expected} were expected"));
        }
        let wanted = self.wanted.iter().map(|w| {
            let cell = cells[w.index];
            let point = cell.replace(',', ".");
            let value = number(if decimal_comma { &point } else { cell })?;
            Ok(w.size_si * value)
        });
        wanted.collect()
    }

    fn append(&self, row: &[f64], batch: &mut Batch) {
        for (column, value) in batch.voltage_v.columns.iter_mut().zip(row) {
            column.push(*value);
        }
        for (readings, value) in batch.standard.iter_mut().zip(row.iter().skip(LIMBS)) {
            readings.push(*value);
        }
    }

    fn follow_tdms(&self, path: &Path, sender: &Sender) -> Result<()> {
        let selection: Vec<usize> = self.wanted.iter().map(|w| w.index).collect();
        let mut done = 0_u64;
        let mut size = 0;
        loop {
            let now = std::fs::metadata(path)?.len();
            if now != size {
                size = now;
                let mut source = sixaxis_recordings::open(path)?;
                source.select_from(&selection, &vec![done; selection.len()])?;
                let mut block = Block::default();
                while source.read(&mut block, LONGEST_BATCH)? > 0 {
                    done += block.rows() as u64;
                    let mut batch = Batch::default();
                    for row in 0..block.rows() {
                        let values = block.columns.iter().zip(&self.wanted);
                        let row: Vec<f64> = values.map(|(c, w)| c[row] * w.size_si).collect();
                        self.append(&row, &mut batch);
                    }
                    if !self.hand_over(&mut batch, sender) {
                        return Ok(());
                    }
                }
            }
            std::thread::sleep(LOOK);
        }
    }
}
