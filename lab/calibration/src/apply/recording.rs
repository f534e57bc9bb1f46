//! Nine voltages on one clock from a file, block by block.

use std::path::{Path, PathBuf};

use crate::load;
use anyhow::{Result, anyhow, bail};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::unit::{self, Unit};
use sixaxis_recordings::{Block, Layout, Source};

use super::stamps::Stamps;
use super::{CHUNK, Row};

/// An open recording of nine limbs.
pub struct Recording {
    /// Its file.
    pub path: PathBuf,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Samples, where the file says so before it is read.
    pub samples: Option<u64>,
    /// Names of the nine channels in the file.
    pub names: [String; LIMBS],
    /// What has been seen of it so far.
    pub seen: Seen,
    /// Limbs whose channels are not looked at.
    pub without: LimbSet,
    /// Whether values that are no numbers are handed on to somebody who takes them for what they are, failures.
    pub watched: bool,
    source: Box<dyn Source>,
    /// What one unit of each channel is worth in volts.
    volts: [f64; LIMBS],
    /// What one unit of the time column is worth in seconds, if there is one.
    seconds: Option<f64>,
    start_s: f64,
    full_scale_v: f64,
    block: Block,
}

/// What a recording has shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seen {
    /// Samples read.
    pub samples: u64,
    /// Samples of each limb at the converter's limit or beyond.
    pub clipped: [u64; LIMBS],
    /// Its time stamps, if it has any.
    pub stamps: Stamps,
}

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// Voltages.
    pub rows: Vec<Row>,
    /// Time stamps, s; as many as rows.
    pub times_s: Vec<f64>,
}

impl Recording {
    /// Opens a recording and finds nine limbs and a rate in it. Where only the time stamps say the rate, they are read once
    /// beforehand.
    ///
    /// # Errors
    /// A file that cannot be read, a channel that is missing or no voltage, a rate that nobody says or that is said twice,
    /// differently.
    pub fn open(
        path: &Path,
        channels: &Channels,
        stated_rate_hz: Option<f64>,
        full_scale_v: f64,
    ) -> Result<Self> {
        let mut source = sixaxis_recordings::open(path)?;
        let layout = source.layout().clone();
        let (indices, volts) = load::limbs(path, &layout, channels)?;
        let time = time_index(path, &layout, channels)?;
        let seconds = time.map(|index| seconds_per_unit(&layout, index));
        let mut rate = load::sample_rate(&layout, &indices, stated_rate_hz)
            .map_err(|cause| anyhow!("{}: the rate is {cause}", path.display()))?;
        if rate.is_none()
            && let (Some(index), Some(seconds)) = (time, seconds)
        {
            rate = measured_rate(path, source.as_mut(), index, seconds)?;
        }
        let Some(sample_rate_hz) = rate else {
            bail!(
                "{}: the file does not say how fast it was sampled; give --rate",
                path.display()
            );
        };
        let first = &layout.channels[indices[0]];
        let mut selection = indices.to_vec();
        selection.extend(time);
        source.select(&selection)?;
        Ok(Self {
            path: path.to_owned(),
            sample_rate_hz,
            samples: first.samples,
            names: indices.map(|index| layout.channels[index].name.clone()),
            seen: Seen::default(),
            without: LimbSet::EMPTY,
            watched: false,
            source,
            volts,
            seconds,
            start_s: first.start_offset_s,
            full_scale_v,
            block: Block::new(selection.len()),
        })
    }

    /// Replaces the contents of `batch` with the next samples; false at the end.
    ///
    /// # Errors
    /// A file that breaks off; a value that is not a finite number, named by file, channel and sample; time stamps that do not
    /// advance or leave a gap.
    pub fn read(&mut self, batch: &mut Batch) -> Result<bool> {
        let count = self.source.read(&mut self.block, CHUNK)?;
        batch.rows.clear();
        batch.rows.resize(count, [0.0; LIMBS]);
        for (limb, column) in self.block.columns.iter().take(LIMBS).enumerate() {
            if self.without.contains(limb) {
                continue;
            }
            let volts = self.volts[limb];
            let mut clipped = 0;
            let mut finite = true;
            for (row, value) in batch.rows.iter_mut().zip(column) {
                let voltage = value * volts;
                finite &= voltage.is_finite();
                clipped += u64::from(voltage.abs() >= self.full_scale_v);
                row[limb] = voltage;
            }
            self.seen.clipped[limb] += clipped;
            if !(finite || self.watched)
                && let Some(at) = column.iter().position(|x| !(x * volts).is_finite())
            {
                bail!(
                    "{}: channel {:?} (limb {}), sample {}: {} is not a finite number; cut the recording there or mend it",
                    self.path.display(),
                    self.names[limb],
                    limb + 1,
                    self.seen.samples + at as u64,
                    column[at]
                );
            }
        }
        batch.times_s.clear();
        match (self.seconds, self.block.columns.get(LIMBS)) {
            (Some(seconds), Some(column)) => {
                let step_s = 1.0 / self.sample_rate_hz;
                for value in column {
                    let stamp_s = value * seconds;
                    self.seen
                        .stamps
                        .take(stamp_s, step_s)
                        .map_err(|cause| anyhow!("{}: {cause}", self.path.display()))?;
                    batch.times_s.push(stamp_s);
                }
            }
            _ => {
                let first = self.seen.samples;
                batch.times_s.extend(
                    (0..count as u64)
                        .map(|i| self.start_s + (first + i) as f64 / self.sample_rate_hz),
                );
            }
        }
        self.seen.samples += count as u64;
        Ok(count > 0)
    }

    /// What a person should know of what was read, in sentences.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let clipped: Vec<String> = self
            .seen
            .clipped
            .iter()
            .zip(&self.names)
            .filter(|(count, _)| **count > 0)
            .map(|(count, name)| format!("{count} of {name}"))
            .collect();
        if !clipped.is_empty() {
            warnings.push(format!(
                "{}: samples at the converter's limit of {} V, where the accelerations are wrong: {}",
                self.path.display(),
                self.full_scale_v,
                clipped.join(", ")
            ));
        }
        let stamps = &self.seen.stamps;
        if stamps.uneven > 0 {
            warnings.push(format!(
                "{}: {} time stamps are uneven, the clock departs from {} Hz by up to {:.1e} s; samples are taken as evenly spaced, rows keep their stamps",
                self.path.display(),
                stamps.uneven,
                self.sample_rate_hz,
                stamps.largest_departure_s
            ));
        }
        warnings
    }
}

/// The time column: the one that is named, or one that is called so.
fn time_index(path: &Path, layout: &Layout, channels: &Channels) -> Result<Option<usize>> {
    match &channels.time {
        Some(name) => match layout.position(name) {
            Some(index) => Ok(Some(index)),
            None => bail!("{}: no channel {name:?} for the time", path.display()),
        },
        None => Ok(layout.time),
    }
}

/// What one unit of a channel is worth in seconds; without a unit it is one.
#[must_use]
pub fn seconds_per_unit(layout: &Layout, index: usize) -> f64 {
    match layout.channels[index].unit.as_deref().map(unit::named) {
        Some(Some(Unit::Time(seconds))) => seconds,
        _ => 1.0,
    }
}

fn measured_rate(
    path: &Path,
    source: &mut dyn Source,
    index: usize,
    seconds: f64,
) -> Result<Option<f64>> {
    source.select(&[index])?;
    let mut stamps = Stamps::default();
    let mut block = Block::new(1);
    while source.read(&mut block, CHUNK)? > 0 {
        for value in &block.columns[0] {
            stamps
                .take(value * seconds, f64::INFINITY)
                .map_err(|cause| anyhow!("{}: {cause}", path.display()))?;
        }
    }
    Ok(stamps.mean_rate_hz())
}
