//! The whole of a session, and what is asked of a good calibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channels::Channels;
use super::entry::Entry;
use super::preprocessing::Preprocessing;
use super::sensor::SensorCard;
use super::standards::{Accelerometer, Gyroscope, Rig};
use crate::unit::STANDARD_GRAVITY_M_S2;

/// A session: one sensor, two standard instruments, a folder of recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// Free text for the report's headline.
    #[serde(default)]
    pub title: String,
    /// The sensor under calibration.
    pub sensor: SensorCard,
    /// Standard accelerometer on the slider, along the travel.
    pub accelerometer: Accelerometer,
    /// Standard gyroscope about the pinion's axis.
    pub gyroscope: Gyroscope,
    /// What is known of the rig; lets the instruments' own scaling be checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rig: Option<Rig>,
    /// Names and units of the channels; a recording may have its own.
    #[serde(default)]
    pub channels: Channels,
    /// What is done to recordings before anything is computed from them.
    #[serde(default)]
    pub preprocessing: Preprocessing,
    /// What is asked of a good calibration.
    #[serde(default)]
    pub limits: Limits,
    /// The recordings.
    pub recording: Vec<Entry>,
}

impl Session {
    /// Acceleration of free fall, m/s^2, as stated or the standard one.
    pub fn gravity_m_s2(&self) -> f64 {
        self.stated_gravity_m_s2().unwrap_or(STANDARD_GRAVITY_M_S2)
    }

    /// As stated.
    pub fn stated_gravity_m_s2(&self) -> Option<f64> {
        self.rig.as_ref()?.gravity_m_s2
    }
}

/// What is asked of a good calibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Largest error of a decoupled validation run over that axis' peak, %. Left out: 7.5, the largest in the paper's
    /// Tables 4 to 6.
    pub validation_percent: f64,
    /// Largest error with which a fit predicts a trial of steps 2 and 3 that it did not see, %.
    pub hold_out_percent: f64,
    /// Largest half width of the 95 % interval of a scale factor or a moment of inertia, % of it.
    pub interval_percent: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            validation_percent: 7.5,
            hold_out_percent: 2.0,
            interval_percent: 5.0,
        }
    }
}

/// The session file's JSON schema.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Session).to_value()
}
