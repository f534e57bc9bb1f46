//! One recording in SI units, all channels on one clock.

use glam::DVec3;
use sixaxis_core::{Gains, Geometry, LIMBS, Scheme, Sensor, Settings};

use crate::session::Role;

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
    /// Unit vector of travel and axis in the sensor's axes at rest.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Crank frequency, Hz; 0 for a static record and a tap.
    pub frequency_hz: f64,
}

impl Trial {
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
