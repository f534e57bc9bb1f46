//! The 25 parameters from the campaign with errors: four steps and joint fit, each with its intervals.
//!
//! What the laboratory knows beforehand stands in its [`session`].

use anyhow::{Context, Result, anyhow};
use sixaxis_calibration::estimate::Estimate;
use sixaxis_calibration::gain_prior::BoundedGain;
use sixaxis_calibration::joint::{JointReport, Loss};
use sixaxis_calibration::prepare::PreparedSession;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::propagation::Propagated;
use sixaxis_core::Parameter;
use sixaxis_core::parameter::{COMPLIANCE, PARAMETERS};
use sixaxis_reference::laboratory::Laboratory;

use super::tap;
use crate::study::results::identifiability::{Interval, Known, KnownParameter};
use crate::study::session::{GAIN_LIMIT, session};

/// Both estimators on a prepared session recorded by `laboratory`. Of the gyroscope's gain the four steps ask trials and
/// certificate, as `sixaxis calibrate` does: the trials alone leave it to errors of the wedges.
///
/// # Errors
/// Those of the steps, of the propagation and of the joint fit.
pub fn study(prepared: &PreparedSession, laboratory: &Laboratory) -> Result<Known> {
    let campaign = &prepared.campaign;
    let estimate = Estimate::of(&session()?, prepared, Loss::Squares, &NoProgress)
        .context("four steps with certificates")?;
    let steps = &estimate.steps;
    let (sources, propagated) = estimate
        .propagated
        .as_ref()
        .context("the errors of the campaign, propagated")?;
    let joint = estimate
        .joint
        .as_ref()
        .map_err(|cause| anyhow!("joint fit: {cause}"))?;
    let compliance_s2 = campaign
        .compliance(&steps.found())
        .context("step 4 by least squares")?;
    let mut found = steps.found().to_paper_order();
    found[COMPLIANCE] = compliance_s2;
    let four_steps = four_steps(&found, propagated, sources.gyroscope_gain);
    let mut truth = laboratory.sensor.to_paper_order();
    truth[COMPLIANCE] = 1.0 / laboratory.sensor.stiffness_per_mass_per_s2;
    // Here truth meets estimate, after the fact.
    let told = joint
        .estimate
        .values(laboratory.instruments.accelerometer_gain_error);
    let bound = joint.estimate.deviations();
    let parameters = Parameter::all()
        .map(|parameter| (parameter.estimated(), parameter.place()))
        .map(|(parameter, p)| KnownParameter {
            parameter,
            unit: parameter.unit().to_owned(),
            truth: truth[p],
            four_steps: four_steps[p],
            joint: Interval {
                estimate: joint.values[p],
                ends_95: joint.intervals_95[p],
                of_trials: bound[p],
                of_certificate: of_certificate(joint, p),
            },
            bound: bound[p],
            joint_error_over_bound: (told[p] - truth[p]) / bound[p],
        })
        .collect();
    Ok(Known {
        parameters,
        joint_misfit: joint.estimate.misfit(),
        compliance_is_determined: joint.compliance_is_determined,
        tap: tap::study(laboratory, campaign, steps, propagated)?,
    })
}

fn of_certificate(joint: &JointReport, p: usize) -> f64 {
    joint.gain.deviation() * joint.estimate.slopes()[p].abs()
}

/// The four steps' intervals: noise, wedges and the gyroscope as normal errors, the accelerometer within its limit.
fn four_steps(
    found: &[f64; PARAMETERS],
    propagated: &Propagated,
    gyroscope_gain: f64,
) -> [Interval; PARAMETERS] {
    let gain = BoundedGain {
        limit: GAIN_LIMIT,
        seen: 0.0,
        information: 0.0,
    };
    let [by_accelerometer, by_gyroscope] = &propagated.per_gain;
    let spread = gain.deviation();
    core::array::from_fn(|p| {
        let drawn = propagated.noise[(p, p)] + propagated.wedges[(p, p)];
        let of_trials = drawn
            .max(0.0)
            .sqrt()
            .hypot(gyroscope_gain * by_gyroscope[p]);
        let [(low, high)] = gain.intervals_95(|gain| [gain * by_accelerometer[p]], &[of_trials]);
        Interval {
            estimate: found[p],
            ends_95: (found[p] + low, found[p] + high),
            of_trials,
            of_certificate: spread * by_accelerometer[p].abs(),
        }
    })
}
