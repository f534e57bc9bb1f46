//! One motion from a file: named columns in SI units, on an even clock.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail, ensure};
use sixaxis_recordings::motion::MOTION_CHANNELS;
use sixaxis_recordings::unit::{self, Unit};
use sixaxis_recordings::{Block, Layout, Source};

use crate::apply::CHUNK;
use crate::apply::recording::seconds_per_unit;
use crate::apply::stamps::Stamps;

/// Columns of a motion.
pub const COLUMNS: usize = MOTION_CHANNELS.len();
/// The first six of them, which no motion can do without.
pub const ACCELERATIONS: usize = 6;

/// One motion's values at one instant, NaN where the file has no such column.
pub type Motion = [f64; COLUMNS];

/// Largest departure of a stamp from an even clock, samples.
const UNEVEN_SAMPLES: f64 = 0.1;

/// An open motion.
pub struct Track {
    /// Its file.
    pub path: PathBuf,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Time of its first sample, s.
    pub start_s: f64,
    source: Box<dyn Source>,
    /// Index in the file and size of the unit in SI, for each column that is there.
    columns: Vec<Option<(usize, f64)>>,
    block: Block,
    /// Next row of the block, and its number in the file.
    row: usize,
    sample: u64,
}

impl Track {
    /// Opens a motion: columns `ax` to `alpha_z`, and rates and attitude if it has them. Time stamps are read once beforehand.
    ///
    /// # Errors
    /// A file that cannot be read, a column that is missing or in an unknown unit, a rate that nobody says, stamps that are not
    /// even.
    pub fn open(path: &Path) -> Result<Self> {
        let place = path.display();
        let mut source = sixaxis_recordings::open(path)?;
        let layout = source.layout().clone();
        let mut columns = Vec::with_capacity(COLUMNS);
        for (index, (name, unit)) in MOTION_CHANNELS.iter().enumerate() {
            let found = position(&layout, name);
            if found.is_none() && index < ACCELERATIONS {
                let names: Vec<&str> = layout.channels.iter().map(|c| c.name.as_str()).collect();
                bail!(
                    "{place}: no channel {name:?}; a motion has ax, ay, az, alpha_x, alpha_y, alpha_z, this file has {}",
                    names.join(", ")
                );
            }
            columns.push(match found {
                Some(at) => {
                    let own = layout.channels[at].unit.as_deref().unwrap_or(unit);
                    let size = size_in_si(own, unit).ok_or_else(|| {
                        anyhow!("{place}: channel {name:?}: {own:?} is not a unit of it; {unit} is")
                    })?;
                    Some((at, size))
                }
                None => None,
            });
        }
        let first = columns[0].map_or(0, |(at, _)| at);
        let mut rate = layout.channels[first].sample_rate_hz;
        let mut start_s = layout.channels[first].start_offset_s;
        if let Some(time) = layout.time {
            let seconds = seconds_per_unit(&layout, time);
            let stamps = stamps(path, source.as_mut(), time, seconds, rate)?;
            rate = rate.or(stamps.mean_rate_hz());
            start_s = stamps.first_s;
            if let Some(rate) = rate {
                ensure!(
                    stamps.largest_departure_s * rate <= UNEVEN_SAMPLES,
                    "{place}: its time stamps depart from an even clock of {rate} Hz by up to {:.1e} s, which leaves nothing to compare sample by sample",
                    stamps.largest_departure_s
                );
            }
        }
        let sample_rate_hz = rate.ok_or_else(|| {
            anyhow!("{place}: neither a sample rate nor a time column says how fast it was sampled")
        })?;
        let mut track = Self {
            path: path.to_owned(),
            sample_rate_hz,
            start_s,
            source,
            columns,
            block: Block::default(),
            row: 0,
            sample: 0,
        };
        track.rewind()?;
        Ok(track)
    }

    /// Whether these columns are there.
    #[must_use]
    pub fn has(&self, columns: core::ops::Range<usize>) -> bool {
        columns.into_iter().all(|c| self.columns[c].is_some())
    }

    /// Back to the first sample.
    ///
    /// # Errors
    /// Those of reading.
    pub fn rewind(&mut self) -> Result<()> {
        let selection: Vec<usize> = self.columns.iter().flatten().map(|c| c.0).collect();
        self.source.select(&selection)?;
        self.block.clear(selection.len());
        (self.row, self.sample) = (0, 0);
        Ok(())
    }

    /// The sample that comes `skip` samples after the next one; none if the file ends before.
    ///
    /// # Errors
    /// Those of reading; a value that is not a finite number.
    pub fn next(&mut self, skip: u64) -> Result<Option<Motion>> {
        let mut left = skip;
        loop {
            let here = (self.block.rows() - self.row) as u64;
            if left < here {
                break;
            }
            left -= here;
            self.sample += here;
            self.row = 0;
            if self.source.read(&mut self.block, CHUNK)? == 0 {
                self.block.clear(0);
                return Ok(None);
            }
        }
        self.row += left as usize;
        self.sample += left;
        let mut motion = [f64::NAN; COLUMNS];
        let mut read = 0;
        for (index, column) in self.columns.iter().enumerate() {
            if let Some((_, size)) = column {
                let value = self.block.columns[read][self.row] * size;
                ensure!(
                    value.is_finite(),
                    "{}: channel {:?}, sample {}: {value} is not a finite number",
                    self.path.display(),
                    MOTION_CHANNELS[index].0,
                    self.sample
                );
                motion[index] = value;
                read += 1;
            }
        }
        self.row += 1;
        self.sample += 1;
        Ok(Some(motion))
    }
}

fn position(layout: &Layout, name: &str) -> Option<usize> {
    layout.position(name).or_else(|| {
        let mut fitting = layout
            .channels
            .iter()
            .enumerate()
            .filter(|(_, c)| c.name.rsplit('/').next() == Some(name));
        match (fitting.next(), fitting.next()) {
            (Some((index, _)), None) => Some(index),
            _ => None,
        }
    })
}

/// What one `unit` is worth in the unit that the column is written in.
fn size_in_si(unit: &str, expected: &str) -> Option<f64> {
    if unit == expected {
        return Some(1.0);
    }
    match expected {
        // Angular accelerations: a rate's unit per second.
        "rad/s^2" => {
            let rate = unit
                .trim()
                .trim_end_matches(['2', '²'])
                .trim_end_matches('^');
            match unit::named(rate) {
                Some(Unit::Rate(size)) if rate.len() < unit.trim().len() => Some(size),
                _ => None,
            }
        }
        _ => match (unit::named(unit)?, expected) {
            (Unit::Acceleration(size), "m/s^2") | (Unit::Rate(size), "rad/s") => Some(size),
            _ => None,
        },
    }
}

fn stamps(
    path: &Path,
    source: &mut dyn Source,
    index: usize,
    seconds: f64,
    rate: Option<f64>,
) -> Result<Stamps> {
    let mut rate = rate;
    loop {
        source.select(&[index])?;
        let step_s = rate.map_or(f64::INFINITY, |rate| 1.0 / rate);
        let mut stamps = Stamps::default();
        let mut block = Block::new(1);
        while source.read(&mut block, CHUNK)? > 0 {
            for value in &block.columns[0] {
                stamps
                    .take(value * seconds, step_s)
                    .map_err(|cause| anyhow!("{}: {cause}", path.display()))?;
            }
        }
        match (rate, stamps.mean_rate_hz()) {
            // Once more, against the rate that the stamps themselves say.
            (None, Some(mean)) => rate = Some(mean),
            _ => return Ok(stamps),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::size_in_si;

    #[test]
    fn units() {
        let degree = core::f64::consts::PI / 180.0;
        assert_eq!(size_in_si("rad/s^2", "rad/s^2"), Some(1.0));
        assert_eq!(size_in_si("deg/s^2", "rad/s^2"), Some(degree));
        assert_eq!(size_in_si("°/s²", "rad/s^2"), Some(degree));
        assert_eq!(size_in_si("deg/s", "rad/s^2"), None);
        assert_eq!(size_in_si("g", "m/s^2"), Some(9.80665));
        assert_eq!(size_in_si("deg/s", "rad/s"), Some(degree));
        assert_eq!(size_in_si("V", "m/s^2"), None);
    }
}
