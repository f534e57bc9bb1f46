//! What a joint fit that does not account for its trials lacks.
//!
//! Each hypothesis is one more freedom of the model: something that the session does not state and that every recording may have.
//! The trials are fitted again with it, and it is believed if that leaves nothing over but noise, if its unknown is told beyond
//! doubt, and if no other hypothesis does as much. Where none does, or more than one, nothing is said.

use core::f64::consts::TAU;

use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::unknowns::{AMPLIFIER_CORNER, GYROSCOPE_LAG};

use super::{JointReport, Knowledge, Loss, fit};
use crate::finding::{Cause, Finding};
use crate::steps::{Campaign, FourSteps};

/// Corner of an amplifier that nobody stated, Hz: where it is looked for first, and how far about.
const CORNER_HZ: (f64, f64) = (0.05, 1.0);
/// Lag of a gyroscope that nobody stated, s: the same.
const LAG_S: (f64, f64) = (2e-3, 0.05);

/// Standard deviations of its unknown from which a freedom is needed: one that is not takes up what is left of anything, but little.
const BEYOND_DOUBT: f64 = 30.0;

/// A freedom.
struct Hypothesis {
    /// With it, if the session leaves room for it.
    freed: fn(&Knowledge) -> Option<Knowledge>,
    /// Its unknown.
    unknown: usize,
    /// What is said of it, by the fit.
    finding: fn(&JointReport) -> Finding,
}

const HYPOTHESES: [Hypothesis; 2] = [
    Hypothesis {
        freed: high_pass,
        unknown: AMPLIFIER_CORNER,
        finding: amplifier,
    },
    Hypothesis {
        freed: lag,
        unknown: GYROSCOPE_LAG,
        finding: gyroscope,
    },
];

/// The one hypothesis that accounts for the trials.
#[must_use]
pub fn explain(campaign: &Campaign, steps: &FourSteps, knowledge: &Knowledge) -> Option<Finding> {
    let mut accounting = HYPOTHESES.iter().filter_map(|hypothesis| {
        let freed = (hypothesis.freed)(knowledge)?;
        let joint = fit(campaign, steps, &freed, Loss::Squares).ok()?;
        let estimate = &joint.estimate;
        let at = hypothesis.unknown;
        let deviation = estimate.covariance[(at, at)].sqrt();
        let told = estimate.unknowns.values[at] > BEYOND_DOUBT * deviation;
        (told && joint.accounts()).then(|| (hypothesis.finding)(&joint))
    });
    let only = accounting.next()?;
    accounting.next().is_none().then_some(only)
}

fn about((value, deviation): (f64, f64)) -> Known {
    Known { value, deviation }
}

fn high_pass(knowledge: &Knowledge) -> Option<Knowledge> {
    let mut freed = *knowledge;
    let stated = &mut freed.certificates.amplifier_corner_rad_s;
    let free = about((TAU * CORNER_HZ.0, TAU * CORNER_HZ.1));
    stated.replace(free).is_none().then_some(freed)
}

fn amplifier(joint: &JointReport) -> Finding {
    let corner_hz = joint.estimate.unknowns.values[AMPLIFIER_CORNER] / TAU;
    Finding {
        cause: Cause::HighPassNotStated,
        recordings: Vec::new(),
        channels: Vec::new(),
        evidence: format!(
            "with a high-pass of {corner_hz:.4} Hz on every channel all trials agree to the noise, and without one they do not"
        ),
        advice: "state preprocessing.amplifier_high_pass_hz as the amplifier's manual has it"
            .to_owned(),
    }
}

fn lag(knowledge: &Knowledge) -> Option<Knowledge> {
    let mut freed = *knowledge;
    let stated = &mut freed.certificates.gyroscope_lag_s;
    stated.replace(about(LAG_S)).is_none().then_some(freed)
}

fn gyroscope(joint: &JointReport) -> Finding {
    let lag_s = joint.estimate.unknowns.values[GYROSCOPE_LAG];
    Finding {
        cause: Cause::GyroscopeLag,
        recordings: Vec::new(),
        channels: Vec::new(),
        evidence: format!(
            "with a gyroscope that is {:.2} ms behind, as a first-order bandwidth of {:.1} Hz has it, all trials agree to the noise, and without that they do not",
            1e3 * lag_s,
            1.0 / (TAU * lag_s)
        ),
        advice:
            "state the gyroscope's bandwidth_hz as its certificate has it; its lag is then undone"
                .to_owned(),
    }
}
