//! The parameters of the estimator that was asked for.

use sixaxis_core::{Parameter, Parameters};

use super::disagreement::held_against;
use super::validation::{Decoding, largest_error};
use crate::estimate::Estimate;
use crate::finding::{Cause, Finding};
use crate::gain_prior::BoundedGain;
use crate::joint::hypotheses;
use crate::joint::misfit::Misfit;
use crate::joint::{JointReport, Loss};
use crate::report::{Estimator, ParameterReport};
use crate::steps::Campaign;

/// How many times further off the runs are by the parameters that are used, from which on the others are worth a word.
const MUCH_LESS: f64 = 2.0;

/// The loss of the joint fit; beside the four steps it is shown by least squares.
pub(super) const fn loss(estimator: Option<Estimator>) -> Loss {
    match estimator {
        None | Some(Estimator::FourSteps | Estimator::Joint) => Loss::Squares,
        Some(Estimator::JointRobust) => Loss::Huber,
    }
}

/// An estimate and what is used of it.
pub(super) struct Chosen {
    pub estimate: Estimate,
    /// Whose parameters were asked for or, where nobody asked, chosen.
    pub estimator: Estimator,
    /// The four steps, for want of a joint fit that accounts for the trials.
    fell_back: bool,
    /// The 25 parameters, by the four steps where the joint fit refuses.
    pub parameters: Vec<ParameterReport>,
    /// The parameters to decouple with: where k/m is not determined, the design's.
    pub used: Parameters,
}

impl Chosen {
    pub fn of(estimate: Estimate, asked_for: Option<Estimator>, design: &Parameters) -> Self {
        let estimator = asked_for.unwrap_or(match &estimate.joint {
            Ok(joint) if joint.accounts() || joint.nearly_accounts() => Estimator::Joint,
            _ => Estimator::FourSteps,
        });
        let fell_back = asked_for.is_none() && estimator == Estimator::FourSteps;
        let four_steps = &estimate.four_steps;
        let (parameters, used) = match &estimate.joint {
            Ok(joint) if estimator != Estimator::FourSteps => {
                let parameters = joint.parameter_reports(four_steps);
                let stiffness = stiffness(&parameters);
                let otherwise = stiffness.map_or(design.stiffness_per_mass_per_s2, |p| p.estimate);
                (parameters, joint.parameters(otherwise))
            }
            _ => {
                let mut used = estimate.steps.used();
                if let Some(stiffness) = stiffness(four_steps) {
                    used.stiffness_per_mass_per_s2 = if stiffness.determined {
                        stiffness.estimate
                    } else {
                        estimate.steps.design_stiffness_per_mass_per_s2
                    };
                }
                let joint = estimate.joint.as_ref().ok();
                let held = held_against(four_steps, joint, estimate.misfit.as_ref());
                (held, used)
            }
        };
        Self {
            estimate,
            estimator,
            fell_back,
            parameters,
            used,
        }
    }

    /// The joint fit where it was asked for and could be done.
    pub fn used_joint(&self) -> Option<&JointReport> {
        let joint = self.estimate.joint.as_ref().ok();
        joint.filter(|_| self.estimator != Estimator::FourSteps)
    }

    /// The joint fit where its parameters are used and it accounts for the trials.
    pub fn accounting_joint(&self) -> Option<&JointReport> {
        self.used_joint().filter(|joint| joint.accounts())
    }

    /// What is to be said where the joint fit does not account for the trials, and leaves the validation runs much less far off than the four
    /// steps, whose parameters are used and by which they depart by `by_steps`, in %.
    pub fn set_aside(&self, campaign: &Campaign, by_steps: f64, limit: f64) -> Option<String> {
        let joint = self.estimate.joint.as_ref().ok();
        let joint = joint.filter(|_| self.fell_back && by_steps.is_finite() && by_steps > limit)?;
        let decoding = Decoding {
            parameters: &joint.parameters(self.used.stiffness_per_mass_per_s2),
            limbs: Some(joint.limbs()),
        };
        let by_joint = 100.0 * largest_error(campaign, &decoding)?;
        (MUCH_LESS * by_joint < by_steps).then(|| {
            format!(
                "the joint fit, which does not account for the trials either, leaves the validation runs {by_joint:.1} % off the standards at most, and the four \
                 steps, whose parameters are used, {by_steps:.1} %: --estimator joint has its parameters"
            )
        })
    }

    /// Why the joint fit that was asked for refuses.
    pub fn refusal(&self) -> Option<&str> {
        let refusal = self.estimate.joint.as_ref().err();
        refusal
            .filter(|_| self.estimator != Estimator::FourSteps)
            .map(String::as_str)
    }

    /// What is to be said against the estimate where nothing is wrong.
    pub fn reservations(&self) -> Vec<String> {
        let mut reservations = self.estimate.taps.remarks.clone();
        if let Some(joint) = self.used_joint() {
            let advice = if joint.nearly_accounts() {
                ""
            } else {
                "; hold its validation runs against those of the four steps"
            };
            reservations.extend(contradiction(&joint.misfit).map(|said| said + advice));
            reservations.extend(beyond_certificate(&joint.gain));
            reservations.extend(joint.odd_mass_centre());
        }
        if self.fell_back {
            let joint = self.estimate.joint.as_ref().map_err(String::as_str);
            let wider = self.estimate.misfit.as_ref().map_or(1.0, Misfit::wider);
            let intervals = match joint {
                _ if wider > 1.0 => format!(
                    "noise counts {wider:.0} times in their intervals and in deviations of what is decoupled"
                ),
                Ok(_) => "their intervals, and deviations of what is decoupled, contain what the joint fit departs from them by".to_owned(),
                Err(_) => "their intervals, and deviations of what is decoupled, contain the spread among trials, and nothing of what keeps all from being fitted together: open loop what is decoupled may be tens of percent off".to_owned(),
            };
            reservations.push(format!(
                "{}: the four steps' parameters are used, and {intervals}",
                hypotheses::contradiction(joint)
            ));
        }
        reservations
    }
}

/// The report on k/m.
pub(super) fn stiffness(parameters: &[ParameterReport]) -> Option<&ParameterReport> {
    parameters
        .iter()
        .find(|p| p.parameter == Parameter::Stiffness)
}

/// The finding for a joint fit that was asked for and refuses; no calibration is written then.
pub(super) fn refused(cause: &str) -> Finding {
    let evidence = format!("the joint fit was asked for and refuses: {cause}");
    let advice = "calibrate with the four steps, which need less of the recordings";
    Finding::new(Cause::JointFitRefused, evidence, advice)
}

/// What is to be said against joint parameters whose channels contradict the model.
pub fn contradiction(misfit: &Misfit) -> Option<String> {
    misfit.contradicts().then(|| {
        format!(
            "the channels contradict straight and unhurried sensors, an ordinary room and white noise (misfit {:.2}, noise alone leaves at most {:.2}): the joint fit's own intervals would be too narrow and have been made {:.0} times as wide",
            misfit.per_degree,
            misfit.limit(),
            misfit.wider()
        )
    })
}

/// Relative deviation that a standard accelerometer has at most: what departs by more is none of its gain.
const NO_GAIN: f64 = 0.2;

/// What is to be said where gravity, turning in the sensor, contradicts the accelerometer's certificate.
pub fn beyond_certificate(gain: &BoundedGain) -> Option<String> {
    gain.is_beyond_certificate().then(|| {
        let (seen, limit) = (100.0 * gain.seen, 100.0 * gain.limit);
        if gain.seen.abs() > NO_GAIN {
            return format!(
                "what turns in the sensor with the motion is not gravity alone, or the accelerometer's gain depends on frequency: gravity would have it off by {seen:+.0} %. \
                 Its certificate of {limit:.2} % alone is used"
            );
        }
        format!(
            "by gravity, which turns in the sensor, the accelerometer reads {seen:+.2} % of its reading too much, and its certificate allows {limit:.2} %: one of the two is wrong, or the axis is not level. The certificate alone is used"
        )
    })
}
