//! One recording of a session: its file, its role, and what the file does not say of it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channels::Channels;
use super::sensor::PerLimb;

/// What a recording is for.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Step 1: at rest.
    Static,
    /// Step 2: pure linear motion below the threshold frequency.
    Linear,
    /// Step 3: pure angular motion below the threshold frequency.
    Angular,
    /// Step 4: pure linear motion above the threshold frequency.
    HighFrequencyLinear,
    /// Any motion of the rig, compound ones above all: held against the standards, never fitted.
    Validation,
    /// A blow on the shell, held by the rig, at 20 kHz or more: k/m from the modes. No standards, no direction.
    Tap,
}

impl Role {
    /// The word that the session file has for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Linear => "linear",
            Self::Angular => "angular",
            Self::HighFrequencyLinear => "high_frequency_linear",
            Self::Validation => "validation",
            Self::Tap => "tap",
        }
    }
}

/// One recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its file, relative to the session file.
    pub file: PathBuf,
    /// What it is for.
    pub role: Role,
    /// Travel and pinion axis in the sensor's axes at rest, of any length: read off the wedge. Needed but for `static` and
    /// `tap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Where down is in the sensor's axes at rest, of any length. Left out: along the rig's axis, so that gravity does not
    /// turn in the sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<[f64; 3]>,
    /// Crank frequency, Hz. Needed but for `static` and `tap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Samples per second, where the file does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample_rate_hz: Option<f64>,
    /// c_i of this recording's amplifier ranges, N/V.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_n_per_v: Option<PerLimb>,
    /// File of the standard instruments where they have one of their own, with a clock of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_file: Option<PathBuf>,
    /// Time of its first sample after that of `file`, s; without it by the dates of both files' time stamps, or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_start_s: Option<f64>,
    /// Samples per second of the reference file, where it does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_sample_rate_hz: Option<f64>,
    /// Names and units of its channels, where they differ from the session's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channels: Option<Channels>,
}

impl Entry {
    /// A recording of which no more is known.
    pub fn new(file: impl Into<PathBuf>, role: Role) -> Self {
        Self {
            file: file.into(),
            role,
            direction: None,
            down: None,
            frequency_hz: None,
            sample_rate_hz: None,
            gain_n_per_v: None,
            reference_file: None,
            reference_start_s: None,
            reference_sample_rate_hz: None,
            channels: None,
        }
    }
}
