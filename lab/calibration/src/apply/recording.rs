//! Nine voltages on one clock from a file, block by block.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_recordings::ingest::clock::stated_rate_hz;
use sixaxis_recordings::ingest::columns::{Columns, stamps};
use sixaxis_recordings::ingest::find::{self, Column};
use sixaxis_recordings::inspect::listing::brief;
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::{BEGAN, Layout};

use super::CHUNK;
use super::at_limit::{AtLimit, NEAR};
use super::flat_crests::FlatCrests;
use super::frozen::Frozen;
use super::voltages::Voltages;

/// Rates of recorders that see a motion: below, no run of a rig has enough samples, beyond, no converter of nine channels.
const PLAUSIBLE_HZ: core::ops::RangeInclusive<f64> = 20.0..=5e6;
/// Voltages over the converter's range from which it is at its end: with twelve bits and more the last step below it is none.
pub(super) const AT_LIMIT: f64 = 1.0 - 1.0 / 2048.0;
/// Voltages over the converter's range that did not come from it as volts.
pub(super) const BEYOND: f64 = 1.2;

/// An open recording of nine limbs.
pub struct Recording {
    /// Its file.
    pub path: PathBuf,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Samples, where the file says so before it is read.
    pub samples: Option<u64>,
    /// When it began, where the file says so: a TDMS file's `wf_start_time`.
    pub began: Option<String>,
    /// Names of the nine channels in the file.
    pub names: [String; LIMBS],
    /// What has been seen of it so far.
    pub seen: Seen,
    /// Where in `columns` each limb is; nowhere if its channel is not looked at.
    places: [Option<usize>; LIMBS],
    /// Whether NaN is passed on to the fault monitor, to which it is a failed channel, instead of being refused.
    pub watched: bool,
    columns: Columns,
    frozen: Frozen,
    at_limit: AtLimit,
    flat_crests: FlatCrests,
    /// Where it is watched, the samples after those that were handed over.
    ahead: Option<Batch>,
    start_s: f64,
    /// How the file was cut short, if it was.
    cut: Option<String>,
    full_scale_v: f64,
}

/// Names are the session's or the calibration's, and the file may have others.
fn with_option(mut error: sixaxis_recordings::Error) -> sixaxis_recordings::Error {
    if let sixaxis_recordings::Error::NoSuchChannel { available, .. } = &mut error {
        *available += "; --channels states what its nine limbs are called";
    }
    error
}

/// What a recording has shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seen {
    /// Samples read.
    pub samples: u64,
    /// Samples of each limb at the converter's limit or beyond.
    pub clipped: [u64; LIMBS],
    /// Largest voltage of those, V.
    pub largest_v: f64,
}

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// Voltages.
    pub voltage_v: Voltages,
    /// Time stamps, s; as many as samples.
    pub times_s: Vec<f64>,
}

impl Recording {
    /// Opens a recording and finds in it a rate and nine limbs, but for the excluded ones, whose channels need not be there. Where only
    /// the time stamps say the rate, they are read once beforehand.
    ///
    /// # Errors
    /// A file that cannot be read, a channel that is missing or no voltage, a rate that nobody says or that is said twice,
    /// differently.
    pub fn open(
        path: &Path,
        channels: &Channels,
        excluded: LimbSet,
        stated_hz: Option<f64>,
        full_scale_v: f64,
    ) -> Result<Self> {
        let source = sixaxis_recordings::open(path)?;
        let layout = source.layout();
        let (mut limbs, mut places) = (Vec::new(), [None; LIMBS]);
        for limb in (0..LIMBS).filter(|limb| !excluded.contains(*limb)) {
            places[limb] = Some(limbs.len());
            limbs.push(find::limb(path, layout, channels, limb).map_err(with_option)?);
        }
        let indices: Vec<usize> = limbs.iter().map(|limb| limb.index).collect();
        // A rate that is stated stands in for stamps that are not there, whatever the calibration's recordings called theirs.
        let named = channels.time.as_deref();
        let is_there = |name: &&str| layout.channels.iter().any(|c| c.name == *name);
        let named = named.filter(|name| stated_hz.is_none() || is_there(name));
        let time = find::time(path, layout, named)?;
        let sample_rate_hz = rate_hz(path, layout, &limbs, time.as_ref(), stated_hz)?;
        Ok(Self {
            path: path.to_owned(),
            sample_rate_hz,
            samples: layout.channels[limbs[0].index].samples,
            start_s: layout.start_s(&indices),
            cut: layout.cut.clone(),
            began: layout.properties.get(BEGAN).cloned(),
            names: core::array::from_fn(|limb| match places[limb] {
                Some(place) => limbs[place].name.clone(),
                None => channels.limbs[limb].clone(),
            }),
            seen: Seen::default(),
            places,
            watched: false,
            columns: Columns::new(path, source, limbs, time, Some(sample_rate_hz))?,
            frozen: Frozen::default(),
            at_limit: AtLimit::default(),
            flat_crests: FlatCrests::default(),
            ahead: None,
            full_scale_v,
        })
    }

    /// Replaces the contents of `batch` with the next samples; false at the end.
    ///
    /// # Errors
    /// A file that breaks off; a value that is not a finite number, named by file, channel and sample; time stamps that do not
    /// advance, leave a gap or, by the end, contradict the rate.
    pub fn read(&mut self, batch: &mut Batch) -> Result<bool> {
        if !self.watched {
            return self.read_next(batch);
        }
        // Whether a channel at the end of the converter's range has failed is told by what the others do before and after that.
        const { assert!(NEAR <= CHUNK as u64) };
        let mut ahead = match self.ahead.take() {
            Some(ahead) => ahead,
            None => {
                let mut first = Batch::default();
                self.read_next(&mut first)?;
                first
            }
        };
        std::mem::swap(batch, &mut ahead);
        let count = batch.voltage_v.samples() as u64;
        if count == 0 {
            return Ok(false);
        }
        let first = self.seen.samples - count;
        self.read_next(&mut ahead)?;
        self.ahead = Some(ahead);
        self.at_limit.blind(first, &mut batch.voltage_v);
        Ok(true)
    }

    fn read_next(&mut self, batch: &mut Batch) -> Result<bool> {
        let count = self.columns.read(CHUNK)?;
        for (limb, column) in batch.voltage_v.columns.iter_mut().enumerate() {
            let Some(place) = self.places[limb] else {
                column.clear();
                column.resize(count, 0.0);
                continue;
            };
            if !self.watched {
                self.columns.check_finite(place)?;
            }
            let limit_v = self.limit_v();
            let read = self.columns.column(place).iter().enumerate();
            for (at, voltage_v) in read.filter(|(_, voltage_v)| voltage_v.abs() >= limit_v) {
                self.seen.clipped[limb] += 1;
                self.seen.largest_v = self.seen.largest_v.max(voltage_v.abs());
                if self.watched {
                    self.at_limit.push(limb, self.seen.samples + at as u64);
                }
            }
            self.columns.take(place, column);
        }
        batch.times_s.clear();
        match self.columns.stamps_s() {
            Some(stamps_s) => batch.times_s.extend_from_slice(stamps_s),
            None => {
                let time_s = |sample| self.start_s + sample as f64 / self.sample_rate_hz;
                let first = self.seen.samples;
                batch
                    .times_s
                    .extend((first..first + count as u64).map(time_s));
            }
        }
        let columns = batch.voltage_v.columns.iter().zip(self.places);
        let read: Vec<&[f64]> = columns
            .filter_map(|(column, place)| place.map(|_| &column[..]))
            .collect();
        self.frozen.look(&read);
        self.flat_crests.look(&batch.voltage_v);
        self.seen.samples += count as u64;
        if count == 0
            && let Some(stamps) = self.columns.stamps()
        {
            stamps
                .check_rate(self.sample_rate_hz)
                .map_err(|cause| anyhow!("{}: the rate is {cause}", self.path.display()))?;
        }
        Ok(count > 0)
    }

    /// Voltages from which a channel is at the end of the converter's range.
    pub(super) fn limit_v(&self) -> f64 {
        AT_LIMIT * self.full_scale_v
    }

    /// Whether there were voltages that no converter of the stated range gives.
    pub fn is_beyond_converter(&self) -> bool {
        self.seen.largest_v > BEYOND * self.full_scale_v
    }

    /// What a person should know of what was read, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        let cut = self.cut.iter();
        let mut warnings: Vec<String> = cut
            .map(|cut| format!("{}: {cut}", self.path.display()))
            .collect();
        let clipped: Vec<String> = self
            .seen
            .clipped
            .iter()
            .zip(&self.names)
            .filter(|(count, _)| **count > 0)
            .map(|(count, name)| format!("{count} of {name}"))
            .collect();
        if self.is_beyond_converter() {
            warnings.push(format!(
                "{}: voltages up to {:.1} V, which a converter of {} V does not give; are they millivolts (--unit mV)? {}",
                self.path.display(),
                self.seen.largest_v,
                self.full_scale_v,
                clipped.join(", ")
            ));
        } else if !clipped.is_empty() {
            warnings.push(format!(
                "{}: samples at the converter's limit of {} V, where the accelerations are wrong: {}",
                self.path.display(),
                self.full_scale_v,
                clipped.join(", ")
            ));
        }
        let flat = (self.flat_crests).told(&self.names, |limb| self.seen.clipped[limb] == 0);
        if !flat.is_empty() {
            warnings.push(format!(
                "{}: crests are cut off, as by an amplifier at the end of its range, and the accelerations are wrong there: {}",
                self.path.display(),
                flat.join(", ")
            ));
        }
        if !PLAUSIBLE_HZ.contains(&self.sample_rate_hz) {
            warnings.push(format!(
                "{}: sampled at {} Hz, by what the file or --rate says: is that the unit of its time stamps, or of its rate?",
                self.path.display(),
                brief(self.sample_rate_hz, 3)
            ));
        }
        warnings.extend(self.frozen.warning(&self.path, self.sample_rate_hz));
        if let Some(stamps) = self.columns.stamps()
            && stamps.uneven(self.sample_rate_hz)
        {
            warnings.push(format!(
                "{}: the time stamps are uneven, the clock departs from {} Hz by up to {:.1e} s; samples are taken as evenly spaced, rows keep their stamps",
                self.path.display(),
                self.sample_rate_hz,
                stamps.largest_departure_s
            ));
        }
        warnings
    }
}

/// Samples per second: as a user, the file or its time stamps say.
///
/// # Errors
/// A rate that nobody says or that is said twice, differently.
pub fn rate_hz(
    path: &Path,
    layout: &Layout,
    limbs: &[Column],
    time: Option<&Column>,
    stated_hz: Option<f64>,
) -> Result<f64> {
    let mut rate = stated_rate_hz(layout, limbs, stated_hz)
        .map_err(|cause| anyhow!("{}: the rate is {cause}", path.display()))?;
    if rate.is_none()
        && let Some(time) = time
    {
        rate = stamps(path, time, None)?.and_then(|stamps| stamps.mean_rate_hz);
    }
    rate.with_context(|| {
        let samples = limbs
            .first()
            .and_then(|limb| layout.channels[limb.index].samples);
        let why = match (samples, time) {
            (Some(0), _) => "no samples are in it, and it",
            (_, Some(_)) => "fewer than two samples are in it, and it",
            (_, None) => "the file",
        };
        format!(
            "{}: {why}{} does not say how fast it was sampled; give --rate",
            path.display(),
            layout.unread_clock()
        )
    })
}
