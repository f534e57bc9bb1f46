//! One recording in SI units, all channels on one clock.

use glam::DVec3;
use sixaxis_core::{Gains, Geometry, LIMBS, Scheme, Sensor, Settings};

use sixaxis_recordings::session::{Entry, Role, Session};
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

/// What one recording holds, in SI units and on one clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard accelerometer along the travel, m/s^2; empty for a static record.
    pub accelerometer_m_s2: Vec<f64>,
    /// Standard gyroscope about the pinion's axis, rad/s; empty for a static record.
    pub gyroscope_rad_s: Vec<f64>,
    /// Frequency up to which noise of the limbs is white, Hz: infinite unless they were read between their samples.
    pub limbs_band_hz: f64,
    /// The same of the standards: infinite, too, where they were resampled from a faster clock.
    pub standards_band_hz: f64,
}

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

impl Trial {
    /// A recording with what its session says of it, wherever its readings came from.
    #[must_use]
    pub fn of(session: &Session, entry: &Entry, readings: Readings) -> Self {
        let gains = entry.gain_n_per_v.unwrap_or(session.sensor.gain_n_per_v);
        let (direction_ground, gravity_ground_m_s2, frequency_hz) = match entry.role {
            Role::Static => (DVec3::Z, DVec3::ZERO, 0.0),
            _ => {
                let direction =
                    DVec3::from_array(entry.direction.unwrap_or([0.0, 0.0, 1.0])).normalize();
                let down = entry
                    .down
                    .map_or(-direction, |down| DVec3::from_array(down).normalize());
                let frequency_hz = entry.frequency_hz.unwrap_or_default();
                (direction, down * STANDARD_GRAVITY_M_S2, frequency_hz)
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
            voltage_v: readings.voltage_v,
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
    #[must_use]
    pub fn sensor(&self, geometry: Geometry) -> Sensor {
        Sensor {
            geometry,
            gains: self.gains,
        }
    }

    /// Decoupler settings that go with this trial: from rest, tared, with its gravity.
    #[must_use]
    pub fn settings(&self, scheme: Scheme) -> Settings {
        Settings {
            scheme,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            ..Settings::new(self.sample_rate_hz)
        }
    }

    /// Whether gravity turns in the sensor during rotation about this trial's axis.
    #[must_use]
    pub fn gravity_turns(&self) -> bool {
        self.gravity_ground_m_s2
            .cross(self.direction_ground)
            .length()
            > 1e-6 * self.gravity_ground_m_s2.length()
    }
}
