//! One recording in SI units, all channels on one clock.

use glam::DVec3;
use sixaxis_core::dsp::spectrum::{noise_floor, welch};
use sixaxis_core::{Gains, Geometry, LIMBS, Scheme, Sensor, Settings};

use crate::error::Result;
use crate::series::median;
use sixaxis_recordings::ingest::readings::{self, Readings};
use sixaxis_recordings::session::{Entry, Role, Session, SessionFile};

/// What the analysis sees of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// File name, for messages and the report.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// c_i of the amplifier ranges in use.
    pub gains: Gains,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard accelerometer along the travel, m/s^2; empty for a static record and a tap.
    pub accelerometer_m_s2: Vec<f64>,
    /// Standard gyroscope about the pinion's axis, rad/s; empty for a static record and a tap.
    pub gyroscope_rad_s: Vec<f64>,
    /// Frequency up to which noise of the limbs is white, Hz: infinite unless they were read between their samples.
    pub limbs_band_hz: f64,
    /// The same of the standards: infinite, too, where they were resampled from a faster clock.
    pub standards_band_hz: f64,
    /// Unit vector of travel and axis in the sensor's axes at rest.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Crank frequency, Hz; 0 for a static record and a tap.
    pub frequency_hz: f64,
}

/// Distance of two unit vectors below which they are one wedge's.
const SAME_WEDGE: f64 = 1e-3;

/// Whether two directions, unit vectors, are one wedge's.
pub(crate) fn same_wedge(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < SAME_WEDGE
}

/// Segment of the spectrum that tells noise where differences do not, samples: at least and at most. The median line of few segments is too low.
const SEGMENT: core::ops::RangeInclusive<usize> = 32..=256;
/// Segments in a recording at least, but of the shortest.
const SEGMENTS: usize = 16;
/// Shares of the band in which noise is white between which it is told: motion is slower.
const TOLD_IN: core::ops::RangeInclusive<f64> = 0.5..=1.0;

impl Trial {
    /// White noise of a channel, a standard deviation of one sample as the converter gave it, V. Samples that were read between those have less of it near half
    /// the sample rate: where they were, the density below that tells, in the median line.
    ///
    /// # Errors
    /// Those of [`noise_floor`] and [`welch`]: a recording too short to tell noise from motion.
    pub fn noise_v(&self, limb: usize) -> sixaxis_core::Result<f64> {
        let series: Vec<f64> = self.voltage_v.iter().map(|row| row[limb]).collect();
        if self.limbs_band_hz.is_infinite() {
            return noise_floor(&series);
        }
        let segment = 1 << (series.len() / SEGMENTS).max(1).ilog2();
        let segment = segment.clamp(*SEGMENT.start(), *SEGMENT.end());
        let spectrum = welch(&series, segment, self.sample_rate_hz)?;
        let lines = spectrum.frequencies_hz.iter().zip(spectrum.densities);
        let told = lines.filter(|(hz, _)| TOLD_IN.contains(&(*hz / self.limbs_band_hz)));
        let density = median(told.map(|(_, density)| density));
        density.map_or_else(
            || noise_floor(&series),
            |density| Ok((0.5 * density * self.sample_rate_hz).sqrt()),
        )
    }

    /// Reads one recording of a session, and says how its file was cut short, if it was.
    ///
    /// # Errors
    /// [`crate::Error::Recording`]: those of [`readings::read`].
    pub fn read(file: &SessionFile, index: usize) -> Result<(Self, Option<String>)> {
        Self::read_faster(file, index, 0.0)
    }

    /// The same where standards in a file of their own are sampled faster than stated by this share of their rate.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn read_faster(
        file: &SessionFile,
        index: usize,
        reference_faster: f64,
    ) -> Result<(Self, Option<String>)> {
        let mut readings = readings::read_faster(file, index, reference_faster)?;
        let cut = readings.cut.take();
        let session = &file.session;
        let trial = Self::of(session, &session.recording[index], readings);
        Ok((trial, cut))
    }

    /// A recording with what its session says of it, wherever its readings came from.
    pub fn of(session: &Session, entry: &Entry, readings: Readings) -> Self {
        let gains = entry.gain_n_per_v.unwrap_or(session.sensor.gain_n_per_v);
        let samples = readings.voltage_v[0].len();
        let (direction_ground, gravity_ground_m_s2, frequency_hz) = match entry.role {
            Role::Static => (DVec3::Z, DVec3::ZERO, 0.0),
            _ => {
                let direction =
                    DVec3::from_array(entry.direction.unwrap_or([0.0, 0.0, 1.0])).normalize();
                let down = entry
                    .down
                    .map_or(-direction, |down| DVec3::from_array(down).normalize());
                let frequency_hz = entry.frequency_hz.unwrap_or_default();
                (direction, down * session.gravity_m_s2(), frequency_hz)
            }
        };
        Self {
            name: entry.file.display().to_string(),
            role: entry.role,
            sample_rate_hz: readings.sample_rate_hz,
            gains: Gains {
                gain_n_per_v: gains.each(),
            },
            full_scale_v: session.sensor.full_scale_v,
            voltage_v: (0..samples)
                .map(|sample| core::array::from_fn(|limb| readings.voltage_v[limb][sample]))
                .collect(),
            accelerometer_m_s2: readings.accelerometer_m_s2,
            gyroscope_rad_s: readings.gyroscope_rad_s,
            limbs_band_hz: readings.limbs_band_hz,
            standards_band_hz: readings.standards_band_hz,
            direction_ground,
            gravity_ground_m_s2,
            frequency_hz,
        }
    }

    /// The sensor as this trial's amplifier ranges make it.
    pub fn sensor(&self, geometry: Geometry) -> Sensor {
        Sensor {
            geometry,
            gains: self.gains,
        }
    }

    /// Decoupler settings that go with this trial: from rest, tared, with its gravity.
    pub fn settings(&self, scheme: Scheme) -> Settings {
        Settings {
            scheme,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            ..Settings::new(self.sample_rate_hz)
        }
    }

    /// Whether gravity turns in the sensor during rotation about this trial's axis.
    pub fn gravity_turns(&self) -> bool {
        self.gravity_ground_m_s2
            .cross(self.direction_ground)
            .length()
            > 1e-6 * self.gravity_ground_m_s2.length()
    }
}
