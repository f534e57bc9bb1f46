//! One recording of the laboratory: what an algorithm may see of it and, beside it, the true motion.

use glam::DVec3;
use sixaxis_recordings::session::{Entry, PerLimb, Role};

use crate::geometry::LIMBS;
use crate::motion::TrueMotion;

/// A simulated recording. Everything but `truth` and true gravity is what the laboratory writes down, which a defect may have made wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRecording {
    /// Name of its file, without extension.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Samples per second, all channels on one clock.
    pub sample_rate_hz: f64,
    /// c_i of the amplifier ranges in use, N/V.
    pub gain_n_per_v: [f64; LIMBS],
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Reference accelerometer on the slider, along the travel, m/s^2; empty at rest, for taps and in the field.
    pub accelerometer_m_s2: Vec<f64>,
    /// Reference gyroscope about the pinion's axis, rad/s; empty at rest, for taps and in the field.
    pub gyroscope_rad_s: Vec<f64>,
    /// Travel and axis in the sensor's axes at rest, a unit vector read off the wedge; zero where the rig has no part in it.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2, read off the mounting; zero where nobody writes it down.
    pub gravity_ground_m_s2: DVec3,
    /// Crank frequency, Hz; zero where the rig has no part in it.
    pub frequency_hz: f64,
    /// True gravity in the sensor's axes at rest, m/s^2, which no laboratory writes down; zero at rest.
    pub true_gravity_ground_m_s2: DVec3,
    /// True motion; empty for the static record.
    pub truth: Vec<TrueMotion>,
}

/// Ten digits: what a person would write into a file.
pub(super) fn tidy(value: f64) -> f64 {
    (value * 1e10).round() / 1e10
}

impl SimulatedRecording {
    /// A recording of nothing, to be filled in: gains of 1, no samples, no motion.
    pub fn of_nothing(name: &str, role: Role, sample_rate_hz: f64, full_scale_v: f64) -> Self {
        Self {
            name: name.to_owned(),
            role,
            sample_rate_hz,
            gain_n_per_v: [1.0; LIMBS],
            full_scale_v,
            voltage_v: Vec::new(),
            accelerometer_m_s2: Vec::new(),
            gyroscope_rad_s: Vec::new(),
            direction_ground: DVec3::ZERO,
            gravity_ground_m_s2: DVec3::ZERO,
            frequency_hz: 0.0,
            true_gravity_ground_m_s2: DVec3::ZERO,
            truth: Vec::new(),
        }
    }

    /// What the session file says of it, numbers to ten digits. Gravity along the axis is what a session takes for granted.
    pub fn entry(&self) -> Entry {
        let on_the_rig = self.direction_ground != DVec3::ZERO;
        let (gravity, axis) = (self.gravity_ground_m_s2, self.direction_ground);
        let turns = gravity.cross(axis).length() > 1e-6 * gravity.length();
        let vector = |v: DVec3| v.to_array().map(tidy);
        Entry {
            direction: on_the_rig.then(|| vector(axis)),
            down: turns.then(|| vector(gravity.normalize())),
            frequency_hz: on_the_rig.then(|| tidy(self.frequency_hz)),
            gain_n_per_v: (self.role != Role::Static).then_some(PerLimb::Each(self.gain_n_per_v)),
            ..Entry::new(&self.name, self.role)
        }
    }
}
