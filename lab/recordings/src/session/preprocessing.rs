//! What a session asks to be done to recordings before anything is computed from them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A stage that can be switched off with `false`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "false, or the settings of this stage")]
pub enum Stage<T> {
    /// `false`: off. `true` is refused, since it says nothing.
    Switch(bool),
    /// On, with these settings.
    On(T),
}

impl<T> Stage<T> {
    /// Its settings if it is on.
    pub fn settings(&self) -> Option<&T> {
        match self {
            Self::Switch(_) => None,
            Self::On(settings) => Some(settings),
        }
    }
}

/// Preprocessing of all recordings, in the order in which it is applied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Preprocessing {
    /// Hampel's rejection of single wild samples; off unless asked for.
    pub outliers: Stage<Outliers>,
    /// Undo a charge amplifier's first-order high-pass with this corner, Hz; off unless asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplifier_high_pass_hz: Option<f64>,
    /// Take off the line through the means of the rests before and after each run; off unless asked for.
    pub detrend: Stage<Detrend>,
    /// Zero-phase Butterworth low-pass on all channels alike.
    pub low_pass: Stage<LowPass>,
    /// Smoothing differentiator of the gyroscope.
    pub differentiator: DifferentiatorSettings,
}

impl Default for Preprocessing {
    fn default() -> Self {
        Self {
            outliers: Stage::Switch(false),
            amplifier_high_pass_hz: None,
            detrend: Stage::Switch(false),
            low_pass: Stage::On(LowPass::default()),
            differentiator: DifferentiatorSettings::default(),
        }
    }
}

/// Hampel's test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Outliers {
    /// Samples on either side that a sample is judged by.
    pub half_width: usize,
    /// Distance from their median, in robust standard deviations, from which a sample is replaced by it.
    pub sigmas: f64,
}

/// Line between rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Detrend {
    /// Rest before and after each run, s.
    pub rest_s: f64,
}

/// Low-pass whose corner follows the drive: `times_drive` times the trial's frequency plus `plus_hz`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LowPass {
    /// Order; run forwards and backwards it attenuates like twice that.
    pub order: usize,
    /// Corner over the drive's frequency.
    pub times_drive: f64,
    /// Added to it, Hz.
    pub plus_hz: f64,
}

impl Default for LowPass {
    /// 12 Hz at 1 Hz. The second harmonic, where w x I w is, loses less than 2e-5, so that step 3 can tell it from the first.
    fn default() -> Self {
        Self {
            order: 4,
            times_drive: 4.0,
            plus_hz: 8.0,
        }
    }
}

/// Smoothing differentiator.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DifferentiatorSettings {
    /// Samples on either side.
    pub half_width: usize,
    /// Order of the polynomial.
    pub order: usize,
}

impl Default for DifferentiatorSettings {
    /// An error of 1e-10 at most at 5 Hz and 10 kHz, and no smoothing to speak of below the low-pass.
    fn default() -> Self {
        Self {
            half_width: 3,
            order: 4,
        }
    }
}
