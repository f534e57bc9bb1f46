//! What the four steps found, beside the truth and the errors that they and the reference have.

use anyhow::{Context, Result};
use sixaxis_calibration::calibration::CalibratedParameters;
use sixaxis_calibration::steps::FourSteps;
use sixaxis_core::Parameters;
use sixaxis_core::parameter::PARAMETERS;

use super::results::Identification;

/// What four steps found beside the truth. The reference's own error is what the four steps without errors find differently at a
/// `coarse` step of the simulator.
///
/// # Errors
/// If the campaign had no trials for step 4.
pub fn found(
    truth: &Parameters,
    steps: &FourSteps,
    noise_free: &FourSteps,
    coarse: Option<&FourSteps>,
) -> Result<Identification> {
    let stiffness = steps.stiffness.as_ref();
    let stiffness = stiffness.context("a campaign without trials for step 4")?;
    let fine = noise_free.found().to_paper_order();
    let difference = |coarse: &FourSteps| -> [f64; PARAMETERS] {
        let coarse = coarse.found().to_paper_order();
        core::array::from_fn(|p| (coarse[p] - fine[p]).abs())
    };
    let change = coarse.map_or([f64::NAN; PARAMETERS], difference);
    Ok(Identification {
        truth: *truth,
        found: steps.found(),
        used: steps.used(),
        reference_error: change.into(),
        standard_error: CalibratedParameters {
            zero_drift_v: steps.drift.standard_error_v,
            scale_per_mass_per_kg: steps.scale.estimate.standard_error(),
            inertia_per_mass_m2: steps.inertia.estimate.standard_error(),
            stiffness_per_mass_per_s2: f64::NAN,
        },
        scale_condition: steps.scale.estimate.condition,
        scale_residual_m_s2: steps.scale.estimate.residual_rms,
        scale_verdict: steps.scale.verdict.clone(),
        inertia_condition: steps.inertia.estimate.condition,
        inertia_residual_m2_s2: steps.inertia.estimate.residual_rms,
        inertia_verdict: steps.inertia.verdict.clone(),
        rate_over_reading: steps.rate_over_reading,
        stiffness_interpolated_per_s2: stiffness.interpolated_per_s2,
        stiffness_verdict: stiffness.verdict.clone(),
    })
}
