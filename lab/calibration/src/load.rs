//! From files to trials: names to channels, units to SI, everything on the clock of the nine limbs.

use std::path::Path;

use sixaxis_core::LIMBS;
use sixaxis_core::dsp::delay::delayed;
use sixaxis_core::dsp::resample::CubicSpline;
use sixaxis_core::recording::check_time_stamps;
use sixaxis_recordings::{Block, Channel, Layout, Source};

use crate::averaged::Averaged;
use crate::error::{Error, Result};
use crate::trial::{Readings, Trial};
use sixaxis_recordings::session::{Channels, Entry, Role, SessionFile};
use sixaxis_recordings::unit::{self, STANDARD_GRAVITY_M_S2, Unit};

/// Samples read at a time.
pub const BLOCK: usize = 1 << 16;

/// Relative difference between two statements of one sample rate that is put down to rounding.
const RATE_TOLERANCE: f64 = 1e-6;

/// Loads one recording of a session.
///
/// # Errors
/// [`Error::Recording`] for a file that cannot be read or lacks a channel; [`Error::Unit`] for a channel without a unit that
/// fits; [`Error::Session`] for a sample rate that nobody states or that is stated twice, differently; [`Error::Trial`] for
/// values that are not finite and time stamps that do not advance.
pub fn trial(file: &SessionFile, index: usize) -> Result<Trial> {
    let entry = &file.session.recording[index];
    let reader = Reader { file, entry, index };
    match entry.role {
        Role::Static => reader.at_rest(),
        _ => reader.moving(),
    }
}

/// Finds the nine limbs in a file: their indices and what one of their units is worth in volts.
///
/// # Errors
/// [`sixaxis_recordings::Error::NoSuchChannel`], [`Error::Unit`].
pub fn limbs(
    path: &Path,
    layout: &Layout,
    channels: &Channels,
) -> Result<([usize; LIMBS], [f64; LIMBS])> {
    let mut indices = [0; LIMBS];
    let mut volts = [0.0; LIMBS];
    for limb in 0..LIMBS {
        let index = position(path, layout, &channels.limbs[limb])?;
        indices[limb] = index;
        let channel = &layout.channels[index];
        volts[limb] = match unit_of(path, channel, channels.limbs_unit.as_deref())? {
            Unit::Voltage(volts) => volts,
            _ => {
                return Err(Error::Recording(sixaxis_recordings::Error::Unit {
                    file: path.display().to_string(),
                    channel: channel.name.clone(),
                    cause: format!(
                        "a limb's channel is a voltage, not {:?}",
                        channel.unit.as_deref().unwrap_or_default()
                    ),
                }));
            }
        };
    }
    Ok((indices, volts))
}

fn position(path: &Path, layout: &Layout, name: &str) -> Result<usize> {
    // A TDMS channel may be named without its group if only one group has it.
    layout
        .position(name)
        .or_else(|| {
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
        .ok_or_else(|| Error::Recording(layout.no_such_channel(path, name)))
}

fn unit_of(path: &Path, channel: &Channel, declared: Option<&str>) -> Result<Unit> {
    let refuse = |cause: String| {
        Err(Error::Recording(sixaxis_recordings::Error::Unit {
            file: path.display().to_string(),
            channel: channel.name.clone(),
            cause,
        }))
    };
    match (channel.unit.as_deref(), declared) {
        (Some(name), declared) => match (unit::named(name), declared.and_then(unit::named)) {
            (Some(unit), None) => Ok(unit),
            (Some(unit), Some(stated)) if unit == stated => Ok(unit),
            (Some(_), Some(_)) => refuse(format!(
                "the file says {name:?}, the session says {:?}",
                declared.unwrap_or_default()
            )),
            (None, Some(unit)) => Ok(unit),
            (None, None) => refuse(format!(
                "unit {name:?} is not known; give the session a *_unit for it"
            )),
        },
        (None, Some(name)) => match unit::named(name) {
            Some(unit) => Ok(unit),
            None => refuse(format!("unit {name:?} is not known")),
        },
        (None, None) => refuse(
            "neither the file nor the session says its unit; set limbs_unit, accelerometer_unit or gyroscope_unit in [channels]"
                .to_owned(),
        ),
    }
}

/// Sample rate of a file's limbs: what the file, the session and the time stamps say, which must agree.
///
/// # Errors
/// A sentence for the caller to give a place to.
pub fn sample_rate(
    layout: &Layout,
    indices: &[usize],
    stated: Option<f64>,
) -> std::result::Result<Option<f64>, String> {
    let mut rate = stated;
    for &index in indices {
        let channel = &layout.channels[index];
        match (rate, channel.sample_rate_hz) {
            (Some(a), Some(b)) if (a - b).abs() > RATE_TOLERANCE * a => {
                return Err(format!(
                    "{a} Hz here, but the file says {b} Hz for channel {:?}",
                    channel.name
                ));
            }
            (None, Some(b)) => rate = Some(b),
            _ => {}
        }
    }
    Ok(rate)
}

struct Reader<'a> {
    file: &'a SessionFile,
    entry: &'a Entry,
    index: usize,
}

/// Columns in SI, with their own clock.
struct Columns {
    series: Vec<Vec<f64>>,
    sample_rate_hz: f64,
}

impl Reader<'_> {
    fn channels(&self) -> &Channels {
        self.entry
            .channels
            .as_ref()
            .unwrap_or(&self.file.session.channels)
    }

    fn key(&self, name: &str) -> String {
        format!("recording[{}].{name}", self.index)
    }

    fn core_error(&self, source: sixaxis_core::Error) -> Error {
        Error::Trial {
            file: self.entry.file.display().to_string(),
            source: Box::new(source),
        }
    }

    /// The time column, if there is one: the one that is named, or one that is called so.
    fn time_index(&self, path: &Path, layout: &Layout) -> Result<Option<usize>> {
        match &self.channels().time {
            Some(name) => position(path, layout, name).map(Some),
            None => Ok(layout.time),
        }
    }

    fn columns(
        &self,
        path: &Path,
        source: &mut dyn Source,
        mut wanted: Vec<(usize, f64)>,
        stated_rate: Option<f64>,
        rate_key: &str,
    ) -> Result<Columns> {
        let layout = source.layout().clone();
        let time = self.time_index(path, &layout)?;
        let indices: Vec<usize> = wanted.iter().map(|(index, _)| *index).collect();
        let mut rate = sample_rate(&layout, &indices, stated_rate)
            .map_err(|cause| self.file.refuse(&self.key(rate_key), cause))?;
        if let Some(index) = time {
            let seconds = match layout.channels[index].unit.as_deref().map(unit::named) {
                Some(Some(Unit::Time(seconds))) => seconds,
                _ => 1.0,
            };
            wanted.push((index, seconds));
        }
        let selection: Vec<usize> = wanted.iter().map(|(index, _)| *index).collect();
        source.select(&selection)?;
        let mut series = vec![Vec::new(); wanted.len()];
        let mut block = Block::new(wanted.len());
        while source.read(&mut block, BLOCK)? > 0 {
            for ((column, scale), all) in block
                .columns
                .iter()
                .zip(wanted.iter().map(|w| w.1))
                .zip(&mut series)
            {
                all.extend(column.iter().map(|x| x * scale));
            }
        }
        for (channel, column) in series.iter().enumerate() {
            if let Some(sample) = column.iter().position(|x| !x.is_finite()) {
                return Err(self.core_error(sixaxis_core::Error::NotFinite {
                    channel: channel + 1,
                    sample,
                    value: column[sample],
                }));
            }
        }
        if time.is_some()
            && let Some(stamps) = series.pop()
        {
            let steps = stamps.len().saturating_sub(1);
            let (Some(first), Some(last), true) = (stamps.first(), stamps.last(), steps > 0) else {
                return Err(self.core_error(sixaxis_core::Error::TooFewSamples {
                    what: "recording",
                    needed: 2,
                    got: stamps.len(),
                }));
            };
            let mean_rate = steps as f64 / (last - first);
            let rate = *rate.get_or_insert(mean_rate);
            if (mean_rate / rate - 1.0).abs() > STAMPS_TOLERANCE {
                let cause = format!(
                    "{rate} Hz, but by its time stamps the recording has {mean_rate:.3} Hz"
                );
                return Err(self.file.refuse(&self.key(rate_key), cause).into());
            }
            if check_time_stamps(&stamps, rate).is_err() {
                // Jitter is put right, a gap is not: it would be filled with invention.
                let largest = stamps.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
                if largest > GAP_STEPS / rate {
                    check_time_stamps(&stamps, rate).map_err(|e| self.core_error(e))?;
                }
                for column in &mut series {
                    let spline =
                        CubicSpline::through(&stamps, column).map_err(|e| self.core_error(e))?;
                    *column = (0..=steps)
                        .map(|i| spline.at((first + i as f64 / rate).min(*last)))
                        .collect::<sixaxis_core::Result<_>>()
                        .map_err(|e| self.core_error(e))?;
                }
            }
        }
        let sample_rate_hz = rate.ok_or_else(|| {
            self.file.refuse(
                &self.key(rate_key),
                "missing: neither the file nor the session says how fast it was sampled",
            )
        })?;
        Ok(Columns {
            series,
            sample_rate_hz,
        })
    }

    fn moving(&self) -> Result<Trial> {
        let path = self.file.resolve(&self.entry.file);
        let mut source = sixaxis_recordings::open(&path)?;
        let layout = source.layout().clone();
        let (indices, volts) = limbs(&path, &layout, self.channels())?;
        let mut wanted: Vec<(usize, f64)> = indices.into_iter().zip(volts).collect();
        // A tap has no standards.
        let struck = self.entry.role == Role::Tap;
        let own_reference = self.entry.reference_file.is_some() && !struck;
        if !own_reference && !struck {
            wanted.extend(self.instruments(&path, &layout)?);
        }
        let mut columns = self.columns(
            &path,
            source.as_mut(),
            wanted,
            self.entry.sample_rate_hz,
            "sample_rate_hz",
        )?;
        let rate = columns.sample_rate_hz;
        let mut instruments = columns.series.split_off(LIMBS);
        if let Some(reference) = &self.entry.reference_file
            && own_reference
        {
            let (read, first, last) = self.foreign_reference(reference, rate, &columns)?;
            instruments = read;
            for column in &mut columns.series {
                column.truncate(last);
                column.drain(..first);
            }
        }
        if let Some(lags) = self.channels().limbs_lag_us {
            for (column, lag_us) in columns.series.iter_mut().zip(lags.each()) {
                // What is filed under t shows t - lag: what t showed is filed under t + lag.
                let (moved, _) =
                    delayed(column, -lag_us * 1e-6, rate).map_err(|e| self.core_error(e))?;
                *column = moved;
            }
        }
        let samples = columns.series[0].len();
        if samples < FEWEST_SAMPLES {
            return Err(self.core_error(sixaxis_core::Error::TooFewSamples {
                what: if own_reference {
                    "recording, as far as the reference file covers it,"
                } else {
                    "recording"
                },
                needed: FEWEST_SAMPLES,
                got: samples,
            }));
        }
        let voltage_v = (0..samples)
            .map(|row| core::array::from_fn(|limb| columns.series[limb][row]))
            .collect();
        let gyroscope_rad_s = instruments.pop().unwrap_or_default();
        let accelerometer_m_s2 = instruments.pop().unwrap_or_default();
        let readings = Readings {
            sample_rate_hz: rate,
            voltage_v,
            accelerometer_m_s2,
            gyroscope_rad_s,
        };
        Ok(Trial::of(&self.file.session, self.entry, readings))
    }

    /// Indices of the two instruments and what one of their units is worth in SI.
    fn instruments(&self, path: &Path, layout: &Layout) -> Result<[(usize, f64); 2]> {
        let channels = self.channels();
        let session = &self.file.session;
        let wrong = |channel: &Channel, cause: &str| {
            Err(Error::Recording(sixaxis_recordings::Error::Unit {
                file: path.display().to_string(),
                channel: channel.name.clone(),
                cause: cause.to_owned(),
            }))
        };
        let index = position(path, layout, &channels.accelerometer)?;
        let channel = &layout.channels[index];
        let accelerometer = match unit_of(path, channel, channels.accelerometer_unit.as_deref())? {
            Unit::Acceleration(si) => si,
            Unit::Voltage(volts) => match session.accelerometer.sensitivity_mv_per_g {
                Some(mv_per_g) => volts / (mv_per_g * 1e-3) * STANDARD_GRAVITY_M_S2,
                None => {
                    return wrong(
                        channel,
                        "in volts; accelerometer.sensitivity_mv_per_g is missing",
                    );
                }
            },
            _ => return wrong(channel, "neither an acceleration nor a voltage"),
        };
        let accelerometer = (index, accelerometer);
        let index = position(path, layout, &channels.gyroscope)?;
        let channel = &layout.channels[index];
        let gyroscope = match unit_of(path, channel, channels.gyroscope_unit.as_deref())? {
            Unit::Rate(si) => si,
            Unit::Voltage(volts) => match session.gyroscope.sensitivity_mv_per_deg_s {
                Some(mv) => volts / (mv * 1e-3) * core::f64::consts::PI / 180.0,
                None => {
                    return wrong(
                        channel,
                        "in volts; gyroscope.sensitivity_mv_per_deg_s is missing",
                    );
                }
            },
            _ => return wrong(channel, "neither a rate nor a voltage"),
        };
        Ok([accelerometer, (index, gyroscope)])
    }

    /// Instruments from a file of their own, brought to the limbs' clock, with the first and the end of the limbs' samples that
    /// they cover.
    fn foreign_reference(
        &self,
        reference: &Path,
        rate: f64,
        limbs: &Columns,
    ) -> Result<(Vec<Vec<f64>>, usize, usize)> {
        let path = self.file.resolve(reference);
        let mut source = sixaxis_recordings::open(&path)?;
        let wanted = self.instruments(&path, source.layout())?.to_vec();
        let columns = self.columns(
            &path,
            source.as_mut(),
            wanted,
            self.entry.reference_sample_rate_hz,
            "reference_sample_rate_hz",
        )?;
        let start_s = self.entry.reference_start_s.unwrap_or(0.0);
        let end_s =
            start_s + (columns.series[0].len().saturating_sub(1)) as f64 / columns.sample_rate_hz;
        let samples = limbs.series[0].len();
        let first = (0..samples)
            .find(|i| *i as f64 / rate >= start_s)
            .unwrap_or(samples);
        let last = (first..samples)
            .find(|i| *i as f64 / rate > end_s)
            .unwrap_or(samples);
        let resampled = columns
            .series
            .iter()
            .map(|column| {
                let spline = CubicSpline::even(column, columns.sample_rate_hz)?;
                (first..last)
                    .map(|i| spline.at(i as f64 / rate - start_s))
                    .collect()
            })
            .collect::<sixaxis_core::Result<Vec<Vec<f64>>>>()
            .map_err(|e| self.core_error(e))?;
        Ok((resampled, first, last))
    }

    fn at_rest(&self) -> Result<Trial> {
        let path = self.file.resolve(&self.entry.file);
        let mut source = sixaxis_recordings::open(&path)?;
        let layout = source.layout().clone();
        let (indices, volts) = limbs(&path, &layout, self.channels())?;
        let rate = sample_rate(&layout, &indices, self.entry.sample_rate_hz)
            .map_err(|cause| self.file.refuse(&self.key("sample_rate_hz"), cause))?
            .unwrap_or(1.0);
        source.select(&indices)?;
        let mut averaged = Averaged::default();
        let mut read = 0;
        let mut block = Block::new(LIMBS);
        while source.read(&mut block, BLOCK)? > 0 {
            for row in 0..block.rows() {
                let voltage_v: [f64; LIMBS] =
                    core::array::from_fn(|limb| block.columns[limb][row] * volts[limb]);
                if let Some(limb) = voltage_v.iter().position(|u| !u.is_finite()) {
                    return Err(self.core_error(sixaxis_core::Error::NotFinite {
                        channel: limb + 1,
                        sample: read + row,
                        value: voltage_v[limb],
                    }));
                }
                averaged.push(&voltage_v);
            }
            read += block.rows();
        }
        let readings = averaged.finish(rate);
        Ok(Trial::of(&self.file.session, self.entry, readings))
    }
}

/// Relative difference between a stated rate and the mean of the time stamps: two clocks of a part in a thousand are two
/// statements.
const STAMPS_TOLERANCE: f64 = 1e-3;
/// Samples below which no run of the rig can be.
const FEWEST_SAMPLES: usize = 32;
/// Steps that may be missing between two stamps before it is a gap rather than jitter.
const GAP_STEPS: f64 = 2.5;
