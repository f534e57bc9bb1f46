//! Covariances of the parameters that a calibration has.

use sixaxis_core::LIMBS;
use sixaxis_core::parameter::{INERTIA, PARAMETERS, SCALE};

use super::choice::Chosen;
use crate::calibration::{Covariance, PropagatedCovariance};
use crate::estimate::Estimate;
use crate::joint::JointReport;
use crate::propagation::Sources;
use crate::report::ParameterReport;

/// Of the estimator that was asked for.
pub(super) fn of(chosen: &Chosen) -> Covariance {
    match chosen.used_joint() {
        Some(joint) => of_joint(joint, chosen.estimate.propagated.as_ref().map(|p| &p.0)),
        None => of_four_steps(&chosen.estimate, &chosen.parameters),
    }
}

/// What differs between trials is in their intervals beside the noise; the covariance of the noise is made as wide, with its correlations.
fn of_four_steps(estimate: &Estimate, reports: &[ParameterReport]) -> Covariance {
    let steps = &estimate.steps;
    let wider: [f64; PARAMETERS] = core::array::from_fn(|p| {
        let parts = reports.get(p).map(|own| (own.from_trials, own.from_noise));
        match parts {
            Some((Some(trials), Some(noise))) if trials > noise && noise > 0.0 => trials / noise,
            _ => 1.0,
        }
    });
    let block = |from: usize, size: usize, get: &dyn Fn(usize, usize) -> f64| {
        rows(size, |i, j| wider[from + i] * wider[from + j] * get(i, j))
    };
    Covariance {
        zero_drift_v2: steps.drift.standard_error_v.map(|s| s * s),
        scale_per_mass_per_kg2: block(SCALE.start, LIMBS, &|i, j| {
            steps.scale.estimate.covariance[(i, j)]
        }),
        inertia_per_mass_m4: block(INERTIA.start, 6, &|i, j| {
            steps.inertia.estimate.covariance[(i, j)]
        }),
        propagated: estimate.propagated.as_ref().map(|(sources, propagated)| {
            PropagatedCovariance {
                noise: block(0, PARAMETERS, &|i, j| propagated.noise[(i, j)]),
                standards: rows(PARAMETERS, |i, j| propagated.standards[(i, j)]),
                channel_noise_v: sources.typical_noise_v(),
            }
        }),
    }
}

/// The whole covariance only where the channels' noise is known, too.
fn of_joint(joint: &JointReport, sources: Option<&Sources>) -> Covariance {
    let noise = joint.noise_covariance();
    let next = joint.covariance_of_next_recording();
    let standards = joint.gain_covariance();
    let block = |from: usize, size: usize| rows(size, |i, j| noise[(from + i, from + j)]);
    Covariance {
        zero_drift_v2: core::array::from_fn(|i| noise[(i, i)]),
        scale_per_mass_per_kg2: block(LIMBS, LIMBS),
        inertia_per_mass_m4: block(2 * LIMBS, 6),
        propagated: sources.map(|sources| PropagatedCovariance {
            noise: rows(PARAMETERS, |i, j| next[(i, j)]),
            standards: rows(PARAMETERS, |i, j| standards[(i, j)]),
            channel_noise_v: sources.typical_noise_v(),
        }),
    }
}

/// A square matrix row by row.
fn rows(size: usize, get: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..size)
        .map(|i| (0..size).map(|j| get(i, j)).collect())
        .collect()
}
