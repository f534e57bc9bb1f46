//! The session file: what is in no recording.
//!
//! TOML, units in the names of the keys. README has a complete example, [`schema`] the formal description. Paths are
//! relative to the file. What cannot be is refused with file, line and key before any recording is opened.

mod check;
mod place;
mod preprocessing;

pub use preprocessing::{Detrend, DifferentiatorSettings, LowPass, Outliers, Preprocessing, Stage};

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS, Parameters};

use crate::error::{Error, Result};

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

/// What is known of the sensor without identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorCard {
    /// Serial number or name.
    #[serde(default)]
    pub serial: String,
    /// L, length of an unloaded limb, mm.
    pub limb_length_mm: f64,
    /// n, half edge of the cubic mass, mm.
    pub half_edge_mm: f64,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// c_i, gain of the amplifier, N/V: one number or nine. A recording may have its own.
    pub gain_n_per_v: PerLimb,
    /// Design values: what an identified parameter is compared with, and what k/m is set to if it cannot be determined.
    pub design: Design,
}

/// One number for all limbs or nine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PerLimb {
    /// The same for all.
    All(f64),
    /// Limb 1 to 9.
    Each([f64; LIMBS]),
}

impl PerLimb {
    /// Nine numbers.
    #[must_use]
    pub fn each(&self) -> [f64; LIMBS] {
        match *self {
            Self::All(value) => [value; LIMBS],
            Self::Each(values) => values,
        }
    }
}

/// Design values of the identified parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// s_i/m, 1/kg: one number or nine.
    pub scale_per_mass_per_kg: PerLimb,
    /// I1 to I6 over m, mm^2.
    pub inertia_per_mass_mm2: [f64; 6],
    /// k/m, 1/s^2.
    pub stiffness_per_mass_per_s2: f64,
}

/// Standard accelerometer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Accelerometer {
    /// Sensitivity, mV/g: needed only where its channel is in volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_mv_per_g: Option<f64>,
    /// Largest error that its certificate allows, %.
    pub class_percent: f64,
    /// Largest error of its sensitivity alone, %, where the certificate says so; every value within is as likely. Left out: the
    /// class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_percent: Option<f64>,
    /// First-order bandwidth, Hz, whose lag is undone. Left out: it follows at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bandwidth_hz: Option<f64>,
}

/// Standard gyroscope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gyroscope {
    /// Sensitivity, mV/(deg/s): needed only where its channel is in volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_mv_per_deg_s: Option<f64>,
    /// Largest error that its certificate allows, %.
    pub class_percent: f64,
    /// Largest error of its sensitivity alone, %, where the certificate says so; every value within is as likely. Left out: the
    /// class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_percent: Option<f64>,
    /// First-order bandwidth, Hz, whose lag is undone. Left out: it follows at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bandwidth_hz: Option<f64>,
}

/// What is known of the rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Stroke of the slider, twice its amplitude, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_mm: Option<f64>,
    /// Rotation amplitude of the pinion, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_amplitude_deg: Option<f64>,
    /// Standard deviation of each of the two angles by which a wedge misses its direction, degrees. Left out: 0.1. The joint
    /// estimator finds the angles themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wedge_deg: Option<f64>,
}

/// Names and units of the channels in the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Channels {
    /// Limbs 1 to 9.
    pub limbs: [String; LIMBS],
    /// Unit of the limbs' channels where the file does not say: V or mV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limbs_unit: Option<String>,
    /// Standard accelerometer.
    pub accelerometer: String,
    /// Its unit where the file does not say: m/s^2, g, V or mV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accelerometer_unit: Option<String>,
    /// Standard gyroscope.
    pub gyroscope: String,
    /// Its unit where the file does not say: rad/s, deg/s, V or mV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gyroscope_unit: Option<String>,
    /// Time stamps, if the file has any; left out, a channel called `time` or `t` is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Lag of each limb's channel, us: a sample filed under a time shows the voltage of so much earlier, as behind a filter.
    /// Negative for a multiplexed converter's later channels, which show what came after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limbs_lag_us: Option<PerLimb>,
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
    #[must_use]
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
    /// Time of its first sample after that of `file`, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_start_s: Option<f64>,
    /// Samples per second of the reference file, where it does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_sample_rate_hz: Option<f64>,
    /// Names and units of its channels, where they differ from the session's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channels: Option<Channels>,
}

/// A session file that has been read.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its text, for places of later errors and for provenance.
    pub text: String,
    /// What it says.
    pub session: Session,
}

impl SessionFile {
    /// Reads and checks a session file.
    ///
    /// # Errors
    /// [`Error::Recording`] if it cannot be read; [`Error::Session`] with line and key for text that is no TOML, keys that
    /// are unknown or missing, values that cannot be.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| sixaxis_recordings::Error::io(path, source))?;
        Self::parse(path, text)
    }

    /// The same from text; `path` is where recordings are relative to.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self> {
        let session: Session =
            toml::from_str(&text).map_err(|error| place::refused(path, &text, &error))?;
        let file = Self {
            path: path.to_owned(),
            text,
            session,
        };
        file.check()?;
        Ok(file)
    }

    /// Path of a recording.
    #[must_use]
    pub fn resolve(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).join(file)
    }

    /// An error at a key such as `recording[3].direction`.
    pub(crate) fn refuse(&self, key: &str, cause: impl Into<String>) -> Error {
        Error::Session {
            path: self.path.clone(),
            line: place::line_of(&self.text, key),
            key: key.to_owned(),
            cause: cause.into(),
        }
    }

    /// The sensor's lengths.
    #[must_use]
    pub fn geometry(&self) -> Geometry {
        Geometry {
            limb_length_m: self.session.sensor.limb_length_mm * 1e-3,
            half_edge_m: self.session.sensor.half_edge_mm * 1e-3,
        }
    }

    /// The sensor's design values as parameters, zero drift 0.
    #[must_use]
    pub fn design(&self) -> Parameters {
        let design = &self.session.sensor.design;
        Parameters {
            zero_drift_v: [0.0; LIMBS],
            scale_per_mass_per_kg: design.scale_per_mass_per_kg.each(),
            inertia_per_mass: InertiaPerMass::from_paper_order(
                design.inertia_per_mass_mm2.map(|i| i * 1e-6),
            ),
            stiffness_per_mass_per_s2: design.stiffness_per_mass_per_s2,
        }
    }
}

/// The session file's JSON schema.
#[must_use]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Session).to_value()
}
