//! One motion from a file: named columns in SI units, on an even clock.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, ensure};
use sixaxis_recordings::ingest::clock::stated_rate_hz;
use sixaxis_recordings::ingest::columns::{self, BLOCK};
use sixaxis_recordings::ingest::find;
use sixaxis_recordings::motion::{MOTION_CHANNELS, SENSOR_CHANNELS};

pub use sixaxis_recordings::ingest::find::ACCELERATIONS;

/// Columns of a motion.
pub const COLUMNS: usize = MOTION_CHANNELS.len();
/// One motion's values at one instant, NaN where the file has no such column or the attitude is not known.
pub type Motion = [f64; COLUMNS];

/// Whether the attitude is not known there: `decouple` leaves all ground axes NaN then.
pub fn is_unknown(motion: &Motion) -> bool {
    motion[..ACCELERATIONS].iter().all(|a| a.is_nan())
}

/// Largest departure of a stamp from an even clock, samples.
const UNEVEN_SAMPLES: f64 = 0.1;

/// Values from which on something else than a motion was recorded: their squares would no longer be numbers.
const LARGEST: f64 = 1e100;

/// An open motion.
pub struct Track {
    /// Its file.
    pub path: PathBuf,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Time of its first sample, s.
    pub start_s: f64,
    /// How its file was cut short, if it was.
    pub cut: Option<String>,
    /// Whether the file has each column.
    present: [bool; COLUMNS],
    columns: columns::Columns,
    /// Next row of the block.
    row: usize,
}

impl Track {
    /// Opens a motion: columns `ax` to `alpha_z`, and rates and attitude if it has them. Time stamps are read once beforehand.
    ///
    /// # Errors
    /// A file that cannot be read, a column that is missing or in an unknown unit, a rate that nobody says, time stamps that are
    /// not even.
    pub fn open(path: &Path) -> Result<Self> {
        let place = path.display();
        let source = sixaxis_recordings::open(path)?;
        let layout = source.layout();
        let in_sensor_axes = || {
            layout
                .channels
                .iter()
                .any(|c| c.name == SENSOR_CHANNELS[0].0)
        };
        let motion = find::motion(path, layout).map_err(|error| {
            let hint = match in_sensor_axes() {
                true => "; motions are compared in ground axes: decouple with --frame both",
                false => "",
            };
            anyhow!("{error}{hint}")
        })?;
        let present = motion.each_ref().map(Option::is_some);
        let wanted: Vec<find::Column> = motion.into_iter().flatten().collect();
        let first = &wanted[..1];
        let mut rate = stated_rate_hz(layout, first, None).map_err(|cause| anyhow!(cause))?;
        let mut start_s = layout.start_s(&wanted.iter().map(|c| c.index).collect::<Vec<_>>());
        let cut = layout.cut.clone();
        let time = find::time(path, layout, None)?;
        if let Some(time) = &time {
            if rate.is_none() {
                rate = columns::stamps(path, time, None)?.and_then(|stamps| stamps.mean_rate_hz);
            }
            if let Some(rate) = rate
                && let Some(stamps) = columns::stamps(path, time, Some(rate))?
            {
                ensure!(
                    stamps.largest_departure_s * rate <= UNEVEN_SAMPLES,
                    "{place}: its time stamps depart from an even clock of {rate} Hz by up to {:.1e} s, which leaves nothing to compare sample by sample",
                    stamps.largest_departure_s
                );
                start_s = stamps.first_s.unwrap_or(start_s);
            }
        }
        let sample_rate_hz = rate.ok_or_else(|| {
            anyhow!("{place}: neither a sample rate nor a time column says how fast it was sampled")
        })?;
        Ok(Self {
            path: path.to_owned(),
            sample_rate_hz,
            start_s,
            cut,
            present,
            columns: columns::Columns::new(path, source, wanted, None, None)?,
            row: 0,
        })
    }

    /// Whether these columns are there.
    pub fn has(&self, columns: core::ops::Range<usize>) -> bool {
        columns.into_iter().all(|c| self.present[c])
    }

    /// Back to the first sample.
    ///
    /// # Errors
    /// Those of reading.
    pub fn rewind(&mut self) -> Result<()> {
        self.row = 0;
        Ok(self.columns.rewind()?)
    }

    /// The sample that comes `skip` samples after the next one; none if the file ends before.
    ///
    /// # Errors
    /// Those of reading; a value that is not a finite number, unless all ground axes are NaN.
    pub fn next(&mut self, skip: u64) -> Result<Option<Motion>> {
        let mut left = skip;
        loop {
            let here = (self.columns.column(0).len() - self.row) as u64;
            if left < here {
                break;
            }
            left -= here;
            self.row = 0;
            if self.columns.read(BLOCK)? == 0 {
                return Ok(None);
            }
        }
        self.row += left as usize;
        let mut motion = [f64::NAN; COLUMNS];
        let there = motion.iter_mut().zip(self.present).filter(|(_, p)| *p);
        for (k, (value, _)) in there.enumerate() {
            *value = self.columns.column(k)[self.row];
        }
        if !is_unknown(&motion) {
            let there = motion.iter().zip(self.present).filter(|(_, p)| *p);
            for (k, (value, _)) in there.enumerate() {
                if !value.is_finite() {
                    self.columns.check_finite(k)?;
                }
                ensure!(
                    value.abs() < LARGEST,
                    "{}: {value:e} in SI units is no motion's: check the units, or what wrote the file",
                    self.path.display()
                );
            }
        }
        self.row += 1;
        Ok(Some(motion))
    }
}
