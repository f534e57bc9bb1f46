//! The 25 parameters from the campaign with errors: four steps and joint fit, each with its intervals.
//!
//! The laboratory has certificates, a data sheet and a workshop's word on its wedges, as a session file would say them. That the
//! wedges of the simulation are right to the last digit it does not know.

use anyhow::{Context, Result};
use core::f64::consts::TAU;
use sixaxis_calibration::gain_prior::BoundedGain;
use sixaxis_calibration::joint::{self, JointReport, Knowledge, Loss, WEDGE_DEG};
use sixaxis_calibration::propagation::{Propagated, Sources, propagate};
use sixaxis_calibration::steps::{Campaign, GyroscopeGain};
use sixaxis_core::Parameter;
use sixaxis_core::identify::joint::{Certificates, Known as KnownTo};
use sixaxis_core::parameter::{COMPLIANCE, PARAMETERS};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::instruments::{
    GAIN_SHARE, GYROSCOPE_BANDWIDTH_HZ, INSTRUMENT_CLASS,
};

use super::tap;
use crate::study::conditioning::Preset;
use crate::study::results::identifiability::{Interval, Known, KnownParameter};

/// Largest gain error of either standard: what its certificate says.
const GAIN_LIMIT: f64 = GAIN_SHARE * INSTRUMENT_CLASS;
/// Relative standard deviation of a stated time constant: what a data sheet's typical value means.
const TIME_CONSTANT: f64 = 0.1;

/// Both estimators on a campaign recorded by `laboratory` and conditioned by `preset`. Of the gyroscope's gain the four steps ask trials
/// and certificate, as `sixaxis calibrate` does: the trials alone leave it to errors of the wedges.
///
/// # Errors
/// Those of the steps, of the propagation and of the joint fit.
pub fn study(campaign: &Campaign, preset: Preset, laboratory: &Laboratory) -> Result<Known> {
    let steps = &campaign
        .identify(GyroscopeGain::Certified { class: GAIN_LIMIT })
        .context("four steps with certificates")?;
    let mut sources = Sources::seen(campaign, steps, GAIN_LIMIT, GAIN_LIMIT)?;
    sources.wedge_rad = WEDGE_DEG.to_radians();
    let propagated = propagate(campaign, &preset.conditioning(), steps, &sources)
        .context("the errors of the campaign, propagated")?;
    let joint = joint::fit(campaign, steps, &knowledge(), Loss::Squares).context("joint fit")?;
    let compliance_s2 = campaign
        .compliance(&steps.found())
        .context("step 4 by least squares")?
        .mass_per_stiffness_s2;
    let mut found = steps.found().to_paper_order();
    found[COMPLIANCE] = compliance_s2;
    let four_steps = four_steps(&found, &propagated, sources.gyroscope_gain);
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
                of_certificate: of_certificate(&joint, p),
            },
            bound: bound[p],
            joint_error_over_bound: (told[p] - truth[p]) / bound[p],
        })
        .collect();
    Ok(Known {
        parameters,
        joint_misfit: joint.estimate.misfit(),
        compliance_is_determined: joint.compliance_is_determined,
        tap: tap::study(laboratory, campaign, steps, &propagated)?,
    })
}

/// What the session file of this laboratory would say.
fn knowledge() -> Knowledge {
    let lag_s = 1.0 / (TAU * GYROSCOPE_BANDWIDTH_HZ);
    Knowledge {
        accelerometer_gain_limit: GAIN_LIMIT,
        certificates: Certificates {
            gyroscope_gain_deviation: GAIN_LIMIT / 3.0_f64.sqrt(),
            gyroscope_lag_s: Some(KnownTo {
                value: lag_s,
                deviation: TIME_CONSTANT * lag_s,
            }),
            accelerometer_lag_s: 0.0,
            amplifier_corner_rad_s: None,
            wedge_deviation_rad: WEDGE_DEG.to_radians(),
            compliance_s2: None,
        },
    }
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
