//! The result as a file: `calibration.json`, what `sixaxis decouple` reads and a laboratory keeps.

mod limbs;
mod rust_source;

pub(crate) use limbs::STIFFNESS_SD;
pub use limbs::{CalibratedLimbs, Square};

use sixaxis_core::parameter::{DRIFT, INERTIA, PARAMETERS, SCALE};
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::decouple::uncertainty::{self};
use sixaxis_core::{CrossTalk, Gains, Geometry, InertiaPerMass, LIMBS, Parameters, Sensor};
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::kind::Kind;

use crate::error::{Error, Result};
use crate::finding::Finding;
use crate::report::ParameterReport;
use crate::report::{Estimator, Grade};
use sixaxis_recordings::session::Channels;

/// Name and version of the format; a reader refuses another.
///
/// Version 1 did not say whether the amplifiers have a high-pass: decoupled without undoing the high-pass, slow motion would come out
/// too small without a word. The joint fit's covariance of version 2 left out what zeros and sensitivities are off before and after the trials.
pub const FORMAT: &str = "sixaxis-calibration-3";
/// Earlier versions, and why their files are refused.
const REFUSED: [(&str, &str); 2] = [
    (
        "sixaxis-calibration-1",
        "does not say whether the amplifiers have a high-pass",
    ),
    (
        "sixaxis-calibration-2",
        "leaves out how far zeros and sensitivities are off before and after the trials",
    ),
];

/// A calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// [`FORMAT`].
    pub format: String,
    /// The judgement.
    pub verdict: Grade,
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// The sensor.
    pub sensor: CalibratedSensor,
    /// Which estimator they are by; files that do not say so have the four steps'.
    #[serde(default)]
    pub estimator: Estimator,
    /// The 25 parameters to decouple with.
    pub parameters: CalibratedParameters,
    /// How well each is known.
    pub intervals: Vec<ParameterReport>,
    /// Covariance of the fits, noise alone.
    pub covariance: Covariance,
    /// Limbs and channels beside the 25; none by the four steps, which take limbs for equally stiff and channels for apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limbs: Option<CalibratedLimbs>,
    /// Channel names and units of the session's recordings.
    pub channels: Channels,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// What is fixed of the sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibratedSensor {
    /// Serial number or name.
    pub serial: String,
    /// L, m.
    pub limb_length_m: f64,
    /// n, m.
    pub half_edge_m: f64,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// c_i of the session's default amplifier ranges, N/V.
    pub gain_n_per_v: [f64; LIMBS],
    /// Corner of the amplifiers' first-order high-pass, which conditioning undoes, Hz; `null` for amplifiers that pass a constant.
    /// The key must be there.
    #[serde(deserialize_with = "Option::deserialize")]
    #[schemars(required)]
    pub amplifier_high_pass_hz: Option<f64>,
}

/// One number for each of the 25 parameters, SI.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibratedParameters {
    /// d_i, V.
    pub zero_drift_v: [f64; LIMBS],
    /// s_i/m, 1/kg.
    pub scale_per_mass_per_kg: [f64; LIMBS],
    /// I1 to I6 over m in the paper's order (xx, yy, zz, xy, xz, yz), m^2.
    pub inertia_per_mass_m2: [f64; 6],
    /// k/m, 1/s^2.
    pub stiffness_per_mass_per_s2: f64,
}

impl CalibratedParameters {
    /// In the paper's order.
    pub fn to_paper_order(&self) -> [f64; PARAMETERS] {
        let mut values = [self.stiffness_per_mass_per_s2; PARAMETERS];
        values[DRIFT].copy_from_slice(&self.zero_drift_v);
        values[SCALE].copy_from_slice(&self.scale_per_mass_per_kg);
        values[INERTIA].copy_from_slice(&self.inertia_per_mass_m2);
        values
    }
}

impl From<[f64; PARAMETERS]> for CalibratedParameters {
    /// From numbers in the paper's order.
    fn from(values: [f64; PARAMETERS]) -> Self {
        let at = |start: usize, i: usize| values[start + i];
        Self {
            zero_drift_v: core::array::from_fn(|i| at(DRIFT.start, i)),
            scale_per_mass_per_kg: core::array::from_fn(|i| at(SCALE.start, i)),
            inertia_per_mass_m2: core::array::from_fn(|i| at(INERTIA.start, i)),
            stiffness_per_mass_per_s2: values[PARAMETERS - 1],
        }
    }
}

impl From<Parameters> for CalibratedParameters {
    fn from(parameters: Parameters) -> Self {
        parameters.to_paper_order().into()
    }
}

/// Covariances of the fits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Covariance {
    /// Variances of the zero drifts, V^2.
    pub zero_drift_v2: [f64; LIMBS],
    /// Of the scale factors, 1/kg^2, row by row.
    pub scale_per_mass_per_kg2: Vec<Vec<f64>>,
    /// Of the inertias, m^4, row by row.
    pub inertia_per_mass_m4: Vec<Vec<f64>>,
    /// Of all 25 together; none in files of before there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub propagated: Option<PropagatedCovariance>,
}

/// Covariance of all 25 parameters: rows and columns d_1 to d_9, V; s_1/m to s_9/m, 1/kg;
/// I1 to I6 over m, m^2; and m/k, s^2 (the compliance, which step 4's errors are linear in).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PropagatedCovariance {
    /// Of the noise of the channels and of the standards, propagated through the four steps and made as wide as trials differ, or as the joint
    /// fit has it. That one contains what zeros and sensitivities are off before and after the trials.
    pub noise: Vec<Vec<f64>>,
    /// Of the standards' gains, each an even spread over its class.
    pub standards: Vec<Vec<f64>>,
    /// White noise of one sample of each channel, V: the median over the trials.
    pub channel_noise_v: [f64; LIMBS],
}

impl PropagatedCovariance {
    /// Both causes together; none for a table that is not 25 by 25.
    pub fn total(&self) -> Option<uncertainty::Covariance> {
        let square = |table: &Vec<Vec<f64>>| {
            table.len() == PARAMETERS && table.iter().all(|row| row.len() == PARAMETERS)
        };
        (square(&self.noise) && square(&self.standards)).then(|| {
            uncertainty::Covariance::from_fn(|i, j| self.noise[i][j] + self.standards[i][j])
        })
    }
}

/// Where a calibration comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of this program.
    pub sixaxis_version: String,
    /// Acceleration of free fall that the session states, m/s^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<f64>,
    /// The session file's text, whole.
    pub session: String,
    /// Recordings with their sizes, bytes.
    pub recordings: Vec<(String, u64)>,
}

/// What a file of any version has.
#[derive(Deserialize)]
struct Version {
    format: String,
}

impl Calibration {
    /// Reads a calibration.
    ///
    /// # Errors
    /// [`Error::Recording`] if it cannot be read, and with the line if it is no calibration of this format or
    /// its parameters are no sensor's. A file of an earlier version is refused by its version, another of the project's files by its kind.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path).map_err(|error| match Kind::Calibration.refuses(path) {
            Some(other_kind) => Error::Recording(other_kind),
            None => error,
        })
    }

    fn parse(path: &Path) -> Result<Self> {
        let text = sixaxis_recordings::whole::read_text(path)?;
        let refuse = |line: Option<usize>, key: &str, cause: String| {
            Error::Recording(sixaxis_recordings::Error::Session {
                path: path.to_owned(),
                line,
                key: key.to_owned(),
                cause,
            })
        };
        // The version first: a file of another version has other keys.
        if let Ok(Version { format }) = serde_json::from_str(&text)
            && format != FORMAT
        {
            let cause = match REFUSED.iter().find(|(earlier, _)| *earlier == format) {
                Some((_, lacks)) => {
                    format!("{format:?} {lacks}: calibrate again from the session file")
                }
                None => format!("{format:?} is not {FORMAT:?}"),
            };
            return Err(refuse(None, "format", cause));
        }
        let calibration: Self = serde_json::from_str(&text)
            .map_err(|e| refuse(Some(e.line()), "calibration", e.to_string()))?;
        calibration
            .parameters()
            .validate()
            .map_err(|e| refuse(None, "parameters", e.to_string()))?;
        let sensor = calibration.sensor();
        sensor
            .geometry
            .validate()
            .and_then(|()| sensor.gains.validate())
            .map_err(|e| refuse(None, "sensor", e.to_string()))?;
        calibration
            .cross_talk(&sensor)
            .map_err(|e| refuse(None, "limbs", e.to_string()))?;
        if let Some(corner_hz) = calibration.sensor.amplifier_high_pass_hz
            && !(corner_hz > 0.0 && corner_hz.is_finite())
        {
            let cause = format!("{corner_hz} is not positive and finite");
            return Err(refuse(None, "sensor.amplifier_high_pass_hz", cause));
        }
        Ok(calibration)
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Recording`].
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_vec_pretty(self)
            .map_err(|e| sixaxis_recordings::Error::io(path, std::io::Error::other(e)))?;
        Ok(write_atomically(path, &text)?)
    }

    /// The parameters as the mathematics has them.
    pub fn parameters(&self) -> Parameters {
        let p = &self.parameters;
        Parameters {
            zero_drift_v: p.zero_drift_v,
            scale_per_mass_per_kg: p.scale_per_mass_per_kg,
            inertia_per_mass: InertiaPerMass::from_paper_order(p.inertia_per_mass_m2),
            stiffness_per_mass_per_s2: p.stiffness_per_mass_per_s2,
        }
    }

    /// The sensor with the session's default gains.
    pub fn sensor(&self) -> Sensor {
        Sensor {
            geometry: Geometry {
                limb_length_m: self.sensor.limb_length_m,
                half_edge_m: self.sensor.half_edge_m,
            },
            gains: Gains {
                gain_n_per_v: self.sensor.gain_n_per_v,
            },
        }
    }
}

impl Calibration {
    /// [`CalibratedLimbs::undone`] where a fit has determined limbs and channels.
    ///
    /// # Errors
    /// Those of [`CrossTalk::new`].
    pub fn cross_talk(&self, sensor: &Sensor) -> sixaxis_core::Result<Option<CrossTalk>> {
        let of = |limbs: &CalibratedLimbs| limbs.undone(sensor, &self.parameters());
        self.limbs.as_ref().map(of).transpose()
    }
}

/// The format's JSON schema.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Calibration).to_value()
}
