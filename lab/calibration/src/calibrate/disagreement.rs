//! What the four steps' parameters are uncertain by because the joint fit of the same trials says otherwise.
//!
//! The four steps neglect what limbs differ by and what channels show of each other, and nothing in their own residuals says so. Two estimates
//! of one quantity leave it at least as uncertain as they differ. Where the trials contradict the joint fit's model, too, their noise is
//! too little by what its own intervals are made wider ([`Misfit::wider`]). Zeros and k/m have been told by other recordings.

use sixaxis_core::Parameter;
use sixaxis_core::significance::NORMAL_95;

use super::choice::Chosen;
use crate::finding::Finding;
use crate::interval;
use crate::joint::misfit::{CONTRADICTING, Misfit};
use crate::joint::{JointReport, hypotheses};
use crate::report::ParameterReport;

/// What limits a parameter that the joint fit has elsewhere.
const OTHERWISE: &str = "what the joint fit says otherwise";

/// Part of itself to within which a scale factor or a moment of inertia is to be known.
const HARDLY_KNOWN: f64 = 0.5;

/// That trials contradict each other too much for what was found to be used.
pub(super) fn hardly_known(chosen: &Chosen) -> Option<Finding> {
    let contradicted = chosen
        .estimate
        .misfit
        .is_some_and(|misfit| misfit.contradicts());
    let has_size =
        |p: &&ParameterReport| p.parameter.has_size() && p.parameter != Parameter::Stiffness;
    let share = |p: &ParameterReport| p.half_width_95.unwrap_or(f64::INFINITY) / p.estimate.abs();
    let sized = chosen.parameters.iter().filter(has_size);
    let worst = sized.max_by(|a, b| share(a).total_cmp(&share(b)))?;
    (contradicted && share(worst) > HARDLY_KNOWN).then(|| {
        let joint = chosen.estimate.joint.as_ref().map_err(String::as_str);
        hypotheses::unknown(format!(
            "{}, so that {} is known to ±{:.0} %",
            hypotheses::contradiction(joint),
            worst.parameter,
            100.0 * share(worst)
        ))
    })
}

/// The four steps' reports with what a joint fit departs from them by, and, whether it was finished or given up, with what it leaves over.
pub(super) fn held_against(
    four_steps: &[ParameterReport],
    joint: Option<&JointReport>,
    misfit: Option<&Misfit>,
) -> Vec<ParameterReport> {
    let wider = misfit.map_or(1.0, Misfit::wider);
    let held = |(p, own): (usize, &ParameterReport)| {
        if !matches!(own.parameter, Parameter::Scale(_) | Parameter::Inertia(_)) {
            return own.clone();
        }
        let apart = joint.map_or(0.0, |joint| NORMAL_95 * (own.estimate - joint.values[p]));
        let noise = own.from_noise.unwrap_or(0.0);
        let contradiction = noise * (wider * wider - 1.0).sqrt();
        let (otherwise, spread) = (apart.hypot(contradiction), own.from_trials.unwrap_or(0.0));
        if otherwise == 0.0 {
            return own.clone();
        }
        let mut held = interval::finish(
            own.parameter,
            own.estimate,
            own.design,
            own.from_noise,
            Some(spread.hypot(otherwise)),
            own.from_standards,
        );
        if otherwise > spread.max(noise).max(own.from_standards.unwrap_or(0.0)) {
            let what = if contradiction > apart.abs() {
                CONTRADICTING
            } else {
                OTHERWISE
            };
            what.clone_into(&mut held.dominated_by);
        }
        held
    };
    four_steps.iter().enumerate().map(held).collect()
}
