//! One seeded calibration without files: played, prepared, estimated, a row.
//!
//! Equals what [`calibrate`](sixaxis_calibration::calibrate::calibrate) makes of the same session on disk, bit for bit, where
//! the files keep every bit of an f64 (test `inv_a_case_is_what_calibrate_finds_on_disk`).

use sixaxis_calibration::estimate::Estimate;
use sixaxis_calibration::joint::{JointReport, Loss};
use sixaxis_calibration::progress::NoProgress;
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_recordings::session::Session;
use sixaxis_reference::laboratory::plan::SessionPlan;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::session::{SimulatedSession, simulate_session};

use crate::prepared::prepare;
use crate::row::{Group, Row, Scalar, Status, Text, Values};

/// Plays and calibrates the session of a plan with this seed. What fails is a row, too.
pub fn calibrate(plan: &SessionPlan, seed: u64) -> Row {
    let plan = SessionPlan {
        seed,
        ..plan.clone()
    };
    let played = match simulate_session(&plan) {
        Ok(played) => played,
        Err(error) => {
            let mut row = Row::new(seed, Status::NotPlayed);
            row.set_text(Text::Failure, error.to_string());
            return row;
        }
    };
    let SimulatedSession {
        session,
        recordings,
        truth,
    } = played;
    let found = identify(&session, recordings);
    let mut row = Row::new(
        seed,
        found
            .as_ref()
            .map_or_else(|failure| failure.status, |_| Status::Calibrated),
    );
    row.set_group(Group::Truth, truth.parameters.to_paper_order().map(Some));
    row.set_scalar(
        Scalar::AccelerometerGainError,
        truth.instruments.accelerometer_gain_error,
    );
    row.set_scalar(
        Scalar::GyroscopeGainError,
        truth.instruments.gyroscope_gain_error,
    );
    if let Some(defect) = &truth.defect {
        row.set_text(Text::Defect, defect.kind.name());
    }
    match found {
        Ok(found) => {
            enter(&found, &mut row);
            if let Ok(joint) = &found.joint {
                // The one place where a truth meets an estimate before the statistics: see the group.
                let gain = truth.instruments.accelerometer_gain_error;
                let known = joint.estimate.values(gain);
                row.set_group(
                    Group::JointGainKnown,
                    stiffness_last(known, joint.compliance_is_determined),
                );
            }
        }
        Err(failure) => row.set_text(Text::Failure, failure.cause),
    }
    row
}

/// Why there are no parameters.
struct Failure {
    status: Status,
    cause: String,
}

/// From here on only what a laboratory has.
fn identify(session: &Session, recordings: Vec<SimulatedRecording>) -> Result<Estimate, Failure> {
    let prepared = prepare(session, recordings);
    if let Some(finding) = prepared.findings.first() {
        return Err(Failure {
            status: Status::NotCleaned,
            cause: format!("{}: {}", finding.recordings.join(", "), finding.evidence),
        });
    }
    Estimate::of(session, &prepared, Loss::Squares, &NoProgress).map_err(|error| Failure {
        status: Status::NotIdentified,
        cause: error.to_string(),
    })
}

/// Enters what the laboratory finds.
fn enter(found: &Estimate, row: &mut Row) {
    let steps = &found.steps;
    row.set_group(Group::FourSteps, steps.found().to_paper_order().map(Some));
    if let Some(noise) = found.noise() {
        // k/m is no linear function of anything: the closed form has its reciprocal.
        let deviation = |i: usize| (i < PARAMETERS - 1).then(|| noise[(i, i)].sqrt());
        row.set_group(
            Group::FourStepsStandardError,
            core::array::from_fn(deviation),
        );
    }
    let half_width_95 = |i: usize| found.four_steps.get(i).and_then(|p| p.half_width_95);
    row.set_group(Group::StatedHalfWidth, core::array::from_fn(half_width_95));
    match &found.joint {
        Ok(joint) => enter_joint(joint, row),
        Err(error) => row.set_text(Text::JointFailure, error.as_str()),
    }
    if let Some((gain, error)) = steps.rate_over_reading {
        row.set_scalar(Scalar::RateOverReading, gain);
        row.set_scalar(Scalar::RateOverReadingStandardError, error);
    }
    if let Some(stiffness) = &steps.stiffness {
        let word = match stiffness.verdict {
            Verdict::Determined => "determined",
            Verdict::Undetermined {
                reason: Reason::EdgeOfGrid,
            } => "edge_of_grid",
            Verdict::Undetermined {
                reason: Reason::Flat { .. },
            } => "flat",
            Verdict::Undetermined {
                reason: Reason::Noise { .. },
            } => "noise",
            Verdict::Undetermined {
                reason: Reason::Misfit { .. },
            } => "misfit",
        };
        row.set_text(Text::Step4, word);
    }
}

fn enter_joint(joint: &JointReport, row: &mut Row) {
    let determined = joint.compliance_is_determined;
    // A stiffness is one over what the fit has: a small error of one is as large, relatively, of the other, and the ends of an
    // interval change places.
    let per_compliance = joint.values[PARAMETERS - 1].powi(-2);
    let deviations = |mut of: [f64; PARAMETERS]| -> Values {
        of[PARAMETERS - 1] *= per_compliance;
        let mut values = of.map(Some);
        if !determined {
            values[PARAMETERS - 1] = None;
        }
        values
    };
    let (mut low, mut high): ([f64; PARAMETERS], [f64; PARAMETERS]) = (
        joint.intervals_95.map(|ends| ends.0),
        joint.intervals_95.map(|ends| ends.1),
    );
    core::mem::swap(&mut low[PARAMETERS - 1], &mut high[PARAMETERS - 1]);
    row.set_group(Group::Joint, stiffness_last(joint.values, determined));
    row.set_group(Group::JointStandardError, deviations(joint.deviations));
    row.set_group(Group::CramerRao, deviations(joint.estimate.deviations()));
    row.set_group(Group::JointLow, stiffness_last(low, determined));
    row.set_group(Group::JointHigh, stiffness_last(high, determined));
    row.set_scalar(Scalar::JointMisfit, joint.estimate.misfit());
}

/// The joint fit's 25 with k/m for 1/(k/m), which is none where the fit leaves it open.
fn stiffness_last(values: [f64; PARAMETERS], determined: bool) -> Values {
    core::array::from_fn(|i| match i {
        i if i < PARAMETERS - 1 => Some(values[i]),
        i => determined.then(|| 1.0 / values[i]),
    })
}
