//! One recording of a session, whole: SI units, one column for each channel, everything on the clock of the nine limbs.

use std::path::Path;

use sixaxis_core::dsp::delay::delayed;
use sixaxis_core::dsp::resample::CubicSpline;

use super::averaged::Averaged;
use super::clock::{OWN_RATE, REFERENCE_RATE, stated_rate_hz, stated_rate_within};
use super::columns::{BLOCK, Columns, stamps};
use super::even::evenly;
use super::find::{self, Column};
use crate::began::Began;
use crate::error::{Error, Result};
use crate::layout::Layout;
use crate::open;
use crate::session::{Channels, Entry, LIMBS, Role, SessionFile};
use crate::source::Source;

/// Share of its rate up to which a series that was read between its samples has their noise: halfway between samples a spline is flat to one per cent
/// there, the polynomial of a delay to one and a half.
const FLAT: f64 = 0.2;
/// Times the limbs' rate from which on a clock is so fast that its samples' noise, read between them, is white again.
const MUCH_FASTER: f64 = 2.0;
/// Samples below which no run of the rig can be.
const FEWEST_SAMPLES: usize = 32;

/// What one recording holds, in SI units and on one clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Voltage of each limb, V.
    pub voltage_v: [Vec<f64>; LIMBS],
    /// Standard accelerometer along the travel, m/s^2; empty for a static record and a tap.
    pub accelerometer_m_s2: Vec<f64>,
    /// Standard gyroscope about the pinion's axis, rad/s; empty for a static record and a tap.
    pub gyroscope_rad_s: Vec<f64>,
    /// Frequency up to which noise of the limbs is white, Hz: infinite unless they were read between their samples.
    pub limbs_band_hz: f64,
    /// The same of the standards: infinite, too, where they were resampled from a much faster clock.
    pub standards_band_hz: f64,
    /// How the file, or that of the standards, was cut short, if it was.
    pub cut: Option<String>,
}

/// Reads one recording of a session. Jittering time stamps are resampled to an even clock; a static record is averaged
/// ([`Averaged`]) and its time stamps are not looked at.
///
/// # Errors
/// Those of opening and reading; [`Error::NoSuchChannel`] and [`Error::Unit`] for channels that cannot be told;
/// [`Error::Session`] for a sample rate that nobody states or that is stated twice, differently; [`Error::Sample`] for values
/// that are not finite, time stamps that do not advance and gaps; [`Error::TooShort`].
pub fn read(file: &SessionFile, index: usize) -> Result<Readings> {
    read_faster(file, index, 0.0)
}

/// The same where standards in a file of their own are sampled faster than stated by this share of their rate, as the recordings showed.
///
/// # Errors
/// Those of [`read`].
pub fn read_faster(file: &SessionFile, index: usize, reference_faster: f64) -> Result<Readings> {
    let entry = &file.session.recording[index];
    let reader = Reader {
        file,
        entry,
        index,
        reference_faster,
    };
    match entry.role {
        Role::Static => reader.at_rest(),
        _ => reader.moving(),
    }
}

struct Reader<'a> {
    file: &'a SessionFile,
    entry: &'a Entry,
    index: usize,
    /// Share by which the rate of the reference file is more than stated.
    reference_faster: f64,
}

/// Whole columns with their clock.
struct Series {
    columns: Vec<Vec<f64>>,
    sample_rate_hz: f64,
    /// Frequency up to which its noise is white, Hz.
    band_hz: f64,
    /// Date and time of the first sample, where the file says so.
    began: Option<Began>,
}

/// The clock that a recording's standards are read on.
struct LimbsClock {
    rate_hz: f64,
    samples: usize,
    /// As [`Series::began`].
    began: Option<Began>,
}

impl Reader<'_> {
    fn channels(&self) -> &Channels {
        self.entry
            .channels
            .as_ref()
            .unwrap_or(&self.file.session.channels)
    }

    /// A refusal of the statement at one of the recording's keys.
    fn refuse(&self, key: &str, cause: impl Into<String>) -> Error {
        let key = format!("recording[{}].{key}", self.index);
        self.file.refuse(&key, cause)
    }

    /// A whole recording on an even clock; `rate_key` is where the session states its rate, and
    /// `tolerance` by how much that may differ from the file's own, relative.
    fn series(
        &self,
        path: &Path,
        source: Box<dyn Source>,
        wanted: Vec<Column>,
        stated_hz: Option<f64>,
        (rate_key, tolerance): (&str, f64),
    ) -> Result<Series> {
        let layout = source.layout();
        let stated_hz = stated_rate_within(tolerance, layout, &wanted, stated_hz)
            .map_err(|cause| self.refuse(rate_key, cause))?;
        let no_rate = format!(
            "missing: neither the file{} nor the session says how fast it was sampled",
            layout.unread_clock()
        );
        let time = find::time(path, layout, self.channels().time.as_deref())?;
        let selected: Vec<usize> = wanted.iter().map(|column| column.index).collect();
        let mut began = layout.began(time.as_ref().map(|time| time.index), &selected);
        let mut series = vec![Vec::new(); wanted.len()];
        let mut stamps_s = Vec::new();
        let mut columns = Columns::new(path, source, wanted, time, stated_hz)?;
        while columns.read(BLOCK)? > 0 {
            for (k, all) in series.iter_mut().enumerate() {
                columns.check_finite(k)?;
                all.extend_from_slice(columns.column(k));
            }
            stamps_s.extend_from_slice(columns.stamps_s().unwrap_or_default());
        }
        if let Some(first_s) = stamps_s.first() {
            began = began.map(|began| began.later(*first_s));
        }
        let stamps = columns.stamps();
        let sample_rate_hz = match (stated_hz, stamps.as_ref().map(|s| s.mean_rate_hz)) {
            (Some(rate), _) | (None, Some(Some(rate))) => rate,
            (None, Some(None)) => return Err(too_short(path, 2, stamps_s.len(), "")),
            (None, None) => {
                return Err(self.refuse(rate_key, no_rate));
            }
        };
        let mut band_hz = f64::INFINITY;
        if let Some(stamps) = stamps {
            stamps
                .check_rate(sample_rate_hz)
                .map_err(|cause| self.refuse(rate_key, cause))?;
            if stamps.uneven(sample_rate_hz) {
                band_hz = FLAT * sample_rate_hz;
                for column in &mut series {
                    *column =
                        evenly(&stamps_s, column, sample_rate_hz).map_err(resampling(path))?;
                }
            }
        }
        Ok(Series {
            columns: series,
            sample_rate_hz,
            band_hz,
            began,
        })
    }

    fn moving(&self) -> Result<Readings> {
        let path = self.file.resolve(&self.entry.file);
        let source = open(&path)?;
        let mut cut = source.layout().cut.clone();
        let mut wanted = find::limbs(&path, source.layout(), self.channels())?.to_vec();
        let reference = match self.entry.role {
            // A tap has no standards.
            Role::Tap => None,
            _ => self.entry.reference_file.as_deref(),
        };
        if reference.is_none() && self.entry.role != Role::Tap {
            wanted.extend(self.standards(&path, source.layout())?);
        }
        let stated_hz = self.entry.sample_rate_hz;
        let Series {
            mut columns,
            sample_rate_hz,
            band_hz: mut limbs_band_hz,
            began,
        } = self.series(&path, source, wanted, stated_hz, OWN_RATE)?;
        let mut standards = columns.split_off(LIMBS);
        let mut standards_band_hz = limbs_band_hz;
        if let Some(reference) = reference {
            let limbs = LimbsClock {
                rate_hz: sample_rate_hz,
                samples: columns[0].len(),
                began,
            };
            let (read, covered) = self.reference(reference, &limbs, &mut cut)?;
            standards_band_hz = read.band_hz;
            standards = read.columns;
            for column in &mut columns {
                column.truncate(covered.end);
                column.drain(..covered.start);
            }
        }
        if let Some(lags) = self.channels().limbs_lag_us {
            limbs_band_hz = limbs_band_hz.min(FLAT * sample_rate_hz);
            for (column, lag_us) in columns.iter_mut().zip(lags.each()) {
                // A value filed under t is that of t - lag: the value of t is filed under t + lag.
                let (moved, _) =
                    delayed(column, -lag_us * 1e-6, sample_rate_hz).map_err(resampling(&path))?;
                *column = moved;
            }
        }
        if self.undo_delays(&path, &mut standards, sample_rate_hz)? {
            standards_band_hz = standards_band_hz.min(FLAT * sample_rate_hz);
            for column in &mut columns {
                column.truncate(standards[0].len());
            }
        }
        let samples = columns[0].len();
        if samples < FEWEST_SAMPLES {
            let covered = reference.map_or("", |_| " that the reference file covers");
            return Err(too_short(&path, FEWEST_SAMPLES, samples, covered));
        }
        let gyroscope_rad_s = standards.pop().unwrap_or_default();
        let accelerometer_m_s2 = standards.pop().unwrap_or_default();
        Ok(Readings {
            sample_rate_hz,
            voltage_v: nine(columns),
            accelerometer_m_s2,
            gyroscope_rad_s,
            limbs_band_hz,
            standards_band_hz,
            cut,
        })
    }

    /// Brings standards with a stated delay forward, and drops the samples that would then lie beyond the record. Whether there are any.
    fn undo_delays(&self, path: &Path, standards: &mut [Vec<f64>], rate_hz: f64) -> Result<bool> {
        let session = &self.file.session;
        let delays_ms = [session.accelerometer.delay_ms, session.gyroscope.delay_ms];
        let mut covered = usize::MAX;
        for (standard, delay_ms) in standards.iter_mut().zip(delays_ms) {
            let Some(delay_ms) = delay_ms else {
                continue;
            };
            let (moved, held) =
                delayed(standard, -1e-3 * delay_ms, rate_hz).map_err(resampling(path))?;
            covered = covered.min(moved.len() - held);
            *standard = moved;
        }
        for standard in standards.iter_mut() {
            standard.truncate(covered);
        }
        Ok(covered < usize::MAX)
    }

    fn standards(&self, path: &Path, layout: &Layout) -> Result<[Column; 2]> {
        find::standards(path, layout, self.channels(), &self.file.session)
    }

    /// Standards from a file of their own, of that file's rate, on the clock of the limbs, and those samples that they cover. When they
    /// begin the session says, or else the dates of both files' time stamps; where neither does they begin together.
    fn reference(
        &self,
        reference: &Path,
        limbs: &LimbsClock,
        cut: &mut Option<String>,
    ) -> Result<(Series, core::ops::Range<usize>)> {
        let LimbsClock {
            rate_hz, samples, ..
        } = *limbs;
        let path = self.file.resolve(reference);
        let source = open(&path)?;
        if let Some(own) = &source.layout().cut {
            *cut = Some(format!("{}: {own}", reference.display()));
        }
        let wanted = self.standards(&path, source.layout())?.to_vec();
        let stated_hz = self.entry.reference_sample_rate_hz;
        let mut own = self.series(&path, source, wanted, stated_hz, REFERENCE_RATE)?;
        own.sample_rate_hz *= 1.0 + self.reference_faster;
        let by_dates_s = (own.began.zip(limbs.began)).and_then(|(own, limbs)| own.after(limbs));
        let by_dates_s = by_dates_s.filter(|_| self.entry.reference_start_s.is_none());
        let start_s = by_dates_s.or(self.entry.reference_start_s).unwrap_or(0.0);
        let last = own.columns[0].len().saturating_sub(1);
        let end_s = start_s + last as f64 / own.sample_rate_hz;
        let first = (0..samples)
            .find(|i| *i as f64 / rate_hz >= start_s)
            .unwrap_or(samples);
        let end = (first..samples)
            .find(|i| *i as f64 / rate_hz > end_s)
            .unwrap_or(samples);
        if by_dates_s.is_some() && end - first < FEWEST_SAMPLES {
            let cause = format!(
                "missing: by the dates of both files the standards are recorded from {start_s} to {end_s} s after the recording's first sample, and it ends after {} s",
                samples as f64 / rate_hz
            );
            return Err(self.refuse("reference_start_s", cause));
        }
        let resampled = own
            .columns
            .iter()
            .map(|column| {
                let spline = CubicSpline::even(column, own.sample_rate_hz)?;
                (first..end)
                    .map(|i| spline.at(i as f64 / rate_hz - start_s))
                    .collect()
            })
            .collect::<sixaxis_core::Result<_>>()
            .map_err(resampling(&path))?;
        // Of a much faster clock what is read is white again. Two quartzes of one rate leave it to chance which is faster.
        let faster = own.sample_rate_hz > MUCH_FASTER * rate_hz;
        let resampled = Series {
            columns: resampled,
            began: None,
            sample_rate_hz: own.sample_rate_hz,
            band_hz: if faster {
                f64::INFINITY
            } else {
                FLAT * own.sample_rate_hz
            },
        };
        Ok((resampled, first..end))
    }

    fn at_rest(&self) -> Result<Readings> {
        let path = self.file.resolve(&self.entry.file);
        let source = open(&path)?;
        let layout = source.layout();
        let limbs = find::limbs(&path, layout, self.channels())?;
        let cut = layout.cut.clone();
        let stated_hz = stated_rate_hz(layout, &limbs, self.entry.sample_rate_hz)
            .map_err(|cause| self.refuse("sample_rate_hz", cause))?;
        let rate = stated_hz.or_else(|| {
            // Only the place of what is odd needs it: a record at rest may have gaps.
            let name = self.channels().time.as_deref();
            let time = find::time(&path, layout, name).ok().flatten()?;
            stamps(&path, &time, None).ok().flatten()?.mean_rate_hz
        });
        let rate = rate.unwrap_or(1.0);
        let mut averaged: [Averaged; LIMBS] = Default::default();
        let mut columns = Columns::new(&path, source, limbs.to_vec(), None, None)?;
        while columns.read(BLOCK)? > 0 {
            for (limb, averaged) in averaged.iter_mut().enumerate() {
                columns.check_finite(limb)?;
                columns
                    .column(limb)
                    .iter()
                    .for_each(|voltage_v| averaged.push(*voltage_v));
            }
        }
        Ok(Readings {
            sample_rate_hz: rate / f64::from(averaged[0].group()),
            voltage_v: averaged.map(Averaged::finish),
            accelerometer_m_s2: Vec::new(),
            gyroscope_rad_s: Vec::new(),
            limbs_band_hz: f64::INFINITY,
            standards_band_hz: f64::INFINITY,
            cut,
        })
    }
}

fn resampling(path: &Path) -> impl Fn(sixaxis_core::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Resampling {
        path: path.clone(),
        source: Box::new(source),
    }
}

fn too_short(path: &Path, needed: usize, samples: usize, which: &'static str) -> Error {
    Error::TooShort {
        path: path.to_owned(),
        needed,
        samples,
        which,
    }
}

fn nine(columns: Vec<Vec<f64>>) -> [Vec<f64>; LIMBS] {
    let mut columns = columns.into_iter();
    core::array::from_fn(|_| columns.next().unwrap_or_default())
}
