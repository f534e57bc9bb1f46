//! The joint fit's part in a judgement: which estimator is asked for, and what is kept of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{LIMBS, Parameters};

use crate::calibration::{Covariance, PropagatedCovariance};
use crate::certified::Gain;
use crate::interval::ParameterReport;
use crate::iteration::Criterion;
use crate::joint::misfit::Misfit;
use crate::joint::{JointReport, Knowledge, Loss, fit};
use crate::propagation::Sources;
use crate::steps::{Campaign, FourSteps};
use crate::suspicion::{Cause, Finding};
use crate::tap::Taps;
use sixaxis_recordings::session::Session;

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
    /// Whether it is the one that files had before there was another.
    #[must_use]
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Its loss; beside the four steps the joint fit is shown by least squares.
    #[must_use]
    pub const fn loss(self) -> Loss {
        match self {
            Self::FourSteps | Self::Joint => Loss::Squares,
            Self::JointRobust => Loss::Huber,
        }
    }

    /// The name.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::FourSteps => "the four steps",
            Self::Joint => "the joint fit",
            Self::JointRobust => "the joint fit with Huber's loss",
        }
    }
}

/// What may be asked for besides a judgement.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Choices {
    /// How far steps 2 to 4 are repeated; shown, not used.
    pub repeat: Option<Criterion>,
    /// Whose parameters the calibration has.
    pub estimator: Estimator,
}

/// Fits jointly, starting from the four steps, with what session and taps say; or why that cannot be.
pub(super) fn fitted(
    session: &Session,
    campaign: &Campaign,
    steps: &FourSteps,
    taps: &Taps,
    loss: Loss,
) -> Result<JointReport, String> {
    let mut knowledge = Knowledge::of(session);
    knowledge.take_taps(taps);
    let report = fit(campaign, steps, &knowledge, loss).map_err(|error| error.to_string())?;
    // What is kept must be a sensor's.
    report
        .parameters(campaign.design.stiffness_per_mass_per_s2)
        .validate()
        .map_err(|error| error.to_string())?;
    Ok(report)
}

/// The parameters to decouple with: k/m is what its report says.
pub(super) fn used(
    joint: &JointReport,
    reports: &[ParameterReport],
    design: &Parameters,
) -> Parameters {
    let stiffness = reports
        .iter()
        .find(|p| p.parameter == Parameter::Stiffness)
        .map_or(design.stiffness_per_mass_per_s2, |p| p.estimate);
    joint.parameters(stiffness)
}

/// Covariances for the file; the whole one only where the channels' noise is known, too.
pub(super) fn covariance(joint: &JointReport, sources: Option<&Sources>) -> Covariance {
    let noise = joint.noise_covariance();
    let standards = joint.gain_covariance();
    let block = |from: usize, size: usize| -> Vec<Vec<f64>> {
        (from..from + size)
            .map(|i| (from..from + size).map(|j| noise[(i, j)]).collect())
            .collect()
    };
    let whole = |get: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..PARAMETERS)
            .map(|i| (0..PARAMETERS).map(|j| get(i, j)).collect())
            .collect()
    };
    Covariance {
        zero_drift_v2: core::array::from_fn(|i| noise[(i, i)]),
        scale_per_mass_per_kg2: block(LIMBS, LIMBS),
        inertia_per_mass_m4: block(2 * LIMBS, 6),
        propagated: sources.map(|sources| PropagatedCovariance {
            noise: whole(&|i, j| noise[(i, j)]),
            standards: whole(&|i, j| standards[(i, j)]),
            channel_noise_v: sources.typical_noise_v(),
        }),
    }
}

/// A joint fit that was asked for and cannot be had: there is no calibration then.
pub(super) fn refused(cause: &str) -> Finding {
    Finding {
        cause: Cause::JointFitRefused,
        recordings: Vec::new(),
        channels: Vec::new(),
        evidence: format!("the joint fit was asked for and refuses: {cause}"),
        advice: "calibrate with the four steps, which need less of the recordings".to_owned(),
    }
}

/// What is to be said against joint parameters whose channels contradict the model.
#[must_use]
pub fn contradiction(misfit: &Misfit) -> Option<String> {
    misfit.contradicts().then(|| {
        format!(
            "the channels contradict equal stiffness or white noise (misfit {:.2}, noise alone leaves at most {:.2}): the joint fit's own intervals would be too narrow and have been made {:.0} times as wide; use the four steps",
            misfit.per_degree,
            misfit.limit(),
            misfit.wider()
        )
    })
}

/// Standard deviations by which the trials must contradict a certificate before it is said.
const BEYOND_CERTIFICATE: f64 = 4.0;

/// What is to be said where gravity, turning in the sensor, contradicts the accelerometer's certificate.
#[must_use]
pub fn beyond_certificate(gain: &Gain) -> Option<String> {
    (gain.contradiction() > BEYOND_CERTIFICATE).then(|| {
        format!(
            "by gravity, which turns in the sensor, the accelerometer reads {:+.2} % of its reading too much, and its certificate allows {:.2} %: one of the two is wrong, or the axis is not level",
            100.0 * gain.seen,
            100.0 * gain.limit
        )
    })
}
