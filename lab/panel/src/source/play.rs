//! A recording, played at its own speed or faster.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Result;
use sixaxis_calibration::apply::recording;
use sixaxis_core::LIMBS;
use sixaxis_recordings::ingest::columns::Columns;
use sixaxis_recordings::ingest::find;
use sixaxis_recordings::session::Channels;

use super::wire::standards;
use super::{Begin, Event, Sender, Start};
use crate::columns::Batch;

/// Time between two batches.
const TICK: Duration = Duration::from_millis(10);

/// An open recording, and what it is.
pub struct Player {
    columns: Columns,
    start: Start,
}

impl Player {
    /// Opens a recording; nine limbs are needed, reference instruments are shown where it has them.
    ///
    /// # Errors
    /// A file that cannot be read, a missing channel, a rate that nobody says.
    pub fn open(path: &Path, channels: &Channels, rate_hz: Option<f64>) -> Result<Self> {
        let source = sixaxis_recordings::open(path)?;
        let layout = source.layout();
        let limbs = find::limbs(path, layout, channels)?;
        let time = find::time(path, layout, channels.time.as_deref())?;
        let sample_rate_hz = recording::rate_hz(path, layout, &limbs, time.as_ref(), rate_hz)?;
        let standards = standards(path, layout, channels)?;
        let mut wanted = limbs.to_vec();
        wanted.extend(standards.iter().flatten().cloned());
        Ok(Self {
            start: Start::of_a_file("recording", path, sample_rate_hz, standards.is_some()),
            columns: Columns::new(path, source, wanted, None, Some(sample_rate_hz))?,
        })
    }

    /// Plays it once, so many times as fast as it was recorded; not waiting at all for an infinite speed. `begin` is what a session says
    /// of it.
    pub fn run(mut self, speed: f64, begin: Option<Begin>, sender: &Sender) {
        let rate = self.start.sample_rate_hz;
        let standards = self.start.standards;
        if !super::starts(&self.start, begin, sender) {
            return;
        }
        let piece = ((rate * speed * TICK.as_secs_f64()) as usize).clamp(1, super::LONGEST_BATCH);
        let began = Instant::now();
        let mut played = 0_u64;
        let over = loop {
            match self.columns.read(piece) {
                Ok(0) => break "the recording is over".to_owned(),
                Err(error) => break error.to_string(),
                Ok(rows) => {
                    let mut batch = Batch::default();
                    for limb in 0..LIMBS {
                        batch.voltage_v.columns[limb].extend_from_slice(self.columns.column(limb));
                    }
                    if standards {
                        batch.standard =
                            [LIMBS, LIMBS + 1].map(|k| self.columns.column(k).to_vec());
                    }
                    played += rows as u64;
                    if sender.send(Event::Samples(Box::new(batch))).is_err() {
                        return;
                    }
                }
            }
            if speed.is_finite() {
                let due = Duration::from_secs_f64(played as f64 / (rate * speed));
                std::thread::sleep(due.saturating_sub(began.elapsed()));
            }
        };
        let _ = sender.send(Event::Note(over));
    }
}
