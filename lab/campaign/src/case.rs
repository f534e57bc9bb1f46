//! One seeded calibration without files: played, conditioned, four steps, a row.
//!
//! Equals what [`sixaxis_calibration::verdict::judge`] makes of the same session on disk, bit for bit, where the files keep
//! every bit of an f64 (test `inv_a_case_is_what_judge_finds_on_disk`).

use sixaxis_calibration::interval::{LeftOut, put_taps, report};
use sixaxis_calibration::joint::{self, JointReport, Knowledge, Loss};
use sixaxis_calibration::propagation;
use sixaxis_calibration::steps::{FourSteps, GyroscopeGain};
use sixaxis_calibration::tap::Taps;
use sixaxis_core::decouple::uncertainty::Covariance;
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_recordings::session::Session;
use sixaxis_reference::session::plan::SessionPlan;
use sixaxis_reference::session::play::{Played, PlayedSession, play};

use crate::collected::{Collected, Failure, collect};
use crate::row::{Group, Row, Scalar, Status, Text, Values};

/// Plays and calibrates the session of a plan with this seed. What fails is a row, too.
#[must_use]
pub fn calibrate(plan: &SessionPlan, seed: u64) -> Row {
    let plan = SessionPlan {
        seed,
        ..plan.clone()
    };
    let played = match play(&plan) {
        Ok(played) => played,
        Err(error) => {
            let mut row = Row::new(seed, Status::NotPlayed);
            row.set_text(Text::Failure, error.to_string());
            return row;
        }
    };
    let PlayedSession {
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
        row.set_text(Text::Defect, defect.kind().name());
    }
    match found {
        Ok(found) => {
            found.enter(&mut row);
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

/// What the laboratory finds.
struct Found {
    steps: FourSteps,
    /// Covariance from noise alone, by the closed form.
    noise: Option<Covariance>,
    half_width_95: [Option<f64>; PARAMETERS],
    joint: sixaxis_calibration::Result<JointReport>,
}

/// From here on only what a laboratory has.
fn identify(session: &Session, recordings: Vec<Played>) -> Result<Found, Failure> {
    let Collected {
        campaign,
        taps: struck,
        conditioning,
    } = collect(session, recordings)?;
    let class = session.gyroscope.class_percent / 100.0;
    let steps = campaign
        .identify(GyroscopeGain::Certified { class })
        .map_err(|error| Failure {
            status: Status::NotIdentified,
            cause: error.to_string(),
        })?;
    let propagated = propagation::of_session(session, &campaign, &conditioning, &steps);
    let noise = propagated.map(|(_, found)| found.noise);
    let left_out = LeftOut::fit(&campaign, &steps);
    let mut reports = report(session, &steps, &left_out, noise.as_ref());
    let taps = Taps::identify(
        &struck,
        campaign.geometry,
        &steps.used(),
        &campaign.design,
        &reports,
    );
    put_taps(&mut reports, &taps);
    let half_width_95 =
        core::array::from_fn(|i| reports.get(i).and_then(|report| report.half_width_95));
    let mut knowledge = Knowledge::of(session);
    knowledge.take_taps(&taps);
    let joint = joint::fit(&campaign, &steps, &knowledge, Loss::Squares);
    Ok(Found {
        steps,
        noise,
        half_width_95,
        joint,
    })
}

impl Found {
    fn enter(&self, row: &mut Row) {
        let steps = &self.steps;
        row.set_group(Group::FourSteps, steps.found().to_paper_order().map(Some));
        if let Some(noise) = &self.noise {
            // k/m is no linear function of anything: the closed form has its reciprocal.
            let deviation = |i: usize| (i < PARAMETERS - 1).then(|| noise[(i, i)].sqrt());
            row.set_group(
                Group::FourStepsStandardError,
                core::array::from_fn(deviation),
            );
        }
        row.set_group(Group::StatedHalfWidth, self.half_width_95);
        match &self.joint {
            Ok(joint) => enter_joint(joint, row),
            Err(error) => row.set_text(Text::JointFailure, error.to_string()),
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
