//! Names, units and lags of a session's channels.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::sensor::{LIMBS, PerLimb};
use crate::channel::Channel;

/// Names and units of the channels in the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Channels {
    /// Limbs 1 to 9.
    pub limbs: [String; LIMBS],
    /// Unit of the limbs' channels where the file does not say: V, mV or uV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limbs_unit: Option<String>,
    /// Standard accelerometer.
    pub accelerometer: String,
    /// Its unit where the file does not say: m/s^2, g, V, mV or uV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accelerometer_unit: Option<String>,
    /// Standard gyroscope.
    pub gyroscope: String,
    /// Its unit where the file does not say: rad/s, deg/s, V, mV or uV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gyroscope_unit: Option<String>,
    /// Time stamps, if the file has any; left out, a channel called `time`, `time_s`, `timestamp`, `zeit`, `seconds`, `elapsed` or `t` is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Lag of each limb's channel, us: a sample filed under a time shows the voltage of so much earlier, as behind a filter.
    /// Negative for a multiplexed converter's later channels, which show what came after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limbs_lag_us: Option<PerLimb>,
}

impl Channels {
    /// Takes over what somebody says of the limbs' channels beside the session.
    pub fn state(&mut self, limbs: Option<&[String; LIMBS]>, unit: Option<&String>) {
        if let Some(limbs) = limbs {
            self.limbs.clone_from(limbs);
        }
        if let Some(unit) = unit {
            self.limbs_unit = Some(unit.clone());
        }
    }

    /// A channel of a stream, which is in volts if it is a limb's and neither its heading nor the session says its unit.
    pub fn in_volts(&self, mut channel: Channel) -> Channel {
        if self.limbs_unit.is_none() && self.limbs.contains(&channel.name) {
            channel.unit.get_or_insert_with(|| "V".to_owned());
        }
        channel
    }
}

impl Default for Channels {
    fn default() -> Self {
        Self {
            limbs: core::array::from_fn(|i| format!("u{}", i + 1)),
            limbs_unit: None,
            accelerometer: "accelerometer".to_owned(),
            accelerometer_unit: None,
            gyroscope: "gyroscope".to_owned(),
            gyroscope_unit: None,
            time: None,
            limbs_lag_us: None,
        }
    }
}
