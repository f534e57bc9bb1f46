//! What a calibration reports, as plain data: the grade, the estimator, parameters, trials and validation runs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::Parameter;
use sixaxis_recordings::session::Role;

/// The judgement in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Use it.
    Good,
    /// Nothing wrong was named, and something is left open: evidence that is missing, or trials that no fit accounts for.
    Reserved,
    /// Do not use it.
    Bad,
}

impl Grade {
    /// The word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Reserved => "good with reservations",
            Self::Bad => "not good",
        }
    }
}

/// Whose 25 parameters a calibration has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// The paper's four steps.
    #[default]
    FourSteps,
    /// All at once, by least squares.
    Joint,
    /// All at once, by Huber's loss.
    JointRobust,
}

impl Estimator {
    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FourSteps => "the four steps",
            Self::Joint => "the joint fit",
            Self::JointRobust => "the joint fit with Huber's loss",
        }
    }
}

/// One of the 25 parameters as it is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterReport {
    /// By its name in the paper: `d1`, `s1/m`, `I1/m`, `k/m`.
    #[serde(rename = "name")]
    #[schemars(with = "String")]
    pub parameter: Parameter,
    /// Unit of all numbers here.
    pub unit: String,
    /// Estimate. For k/m that is not determined, the design's.
    pub estimate: f64,
    /// Design value.
    pub design: f64,
    /// Half width of the 95 % interval; none where the parameter is not determined.
    pub half_width_95: Option<f64>,
    /// Half width that noise alone would give, propagated through the steps.
    pub from_noise: Option<f64>,
    /// Half width that the differences between trials give: by the four steps what they scatter by, none for fewer than three trials, and
    /// what a joint fit of them says otherwise; by the joint fit what sensitivities move by over the day.
    pub from_trials: Option<f64>,
    /// Half width that the standards' classes give; for k/m by taps, errors of I/m and gains.
    pub from_standards: Option<f64>,
    /// What dominates the interval.
    pub dominated_by: String,
    /// Whether the data determine it.
    pub determined: bool,
    /// Why not, or how.
    pub remark: String,
}

/// One trial as it came out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrialReport {
    /// Its file.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// The same by the recording's clock, where its standards show three cycles or more.
    #[serde(default)]
    pub seen_hz: Option<f64>,
    /// Unit vector of travel and axis, sensor axes at rest.
    pub direction: [f64; 3],
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Samples.
    pub samples: usize,
    /// Largest voltage over the converter's limit.
    pub largest_over_full_scale: f64,
    /// Samples replaced by the outlier test, all channels.
    pub outliers: usize,
    /// Departure of the channels from what all trials agree on, relative to the trial's own size.
    pub departure: Option<f64>,
    /// Residual of the fit over the signal, root mean squares, all channels.
    pub residual: Option<f64>,
    /// Correlation of neighbouring residuals of its step's equation, at the distance of the rows that are fitted: 0 is white.
    pub residual_correlation: Option<f64>,
    /// Time by which the standards lag, s.
    pub lag_s: Option<f64>,
    /// Error of the prediction of this trial by a fit without it, over the trial's signal, root mean squares.
    pub hold_out: Option<f64>,
    /// Residual of each of the three coordination equations over the forces in them, root mean squares.
    pub coordination: Option<[f64; 3]>,
    /// Validation runs: largest error of each decoupled acceleration against the standards over the run's peak on that axis
    /// (or over a tenth of the largest peak, where an axis has less).
    pub validation: Option<[f64; 6]>,
}

/// What a validation run looks like in sensor axes, for the report: time, s; change of the specific force since the rest, m/s^2, and
/// angular acceleration, rad/s^2.
#[derive(Debug, Clone, PartialEq)]
pub struct ValidationRun {
    /// File.
    pub name: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// First sample that is decoupled.
    pub first: usize,
    /// By the standards.
    pub standard: Vec<[f64; 6]>,
    /// Decoupled.
    pub decoupled: Vec<[f64; 6]>,
}
