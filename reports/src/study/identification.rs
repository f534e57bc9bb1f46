//! The simulated campaign as the analysis has it: recorded, conditioned, ready for the four steps.

use anyhow::Result;
use rayon::prelude::*;
use sixaxis_calibration::steps::Campaign;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_recordings::session;
use sixaxis_reference::campaign::{Laboratory, Role, Trial};
use sixaxis_reference::paper;
use sixaxis_reference::recording::SimulatedRun;

use super::conditioning::Preset;

/// What a session calls a run's purpose.
fn role(role: Role) -> session::Role {
    match role {
        Role::Linear => session::Role::Linear,
        Role::Angular => session::Role::Angular,
        Role::FastLinear => session::Role::HighFrequencyLinear,
        Role::Compound => session::Role::Validation,
    }
}

/// Records and cleans a simulated campaign.
///
/// # Errors
/// Those of the conditioning.
pub fn record(
    laboratory: &Laboratory,
    simulated: &[(Trial, SimulatedRun)],
    preset: Preset,
) -> Result<Campaign> {
    let rest = simulated
        .first()
        .and_then(|(_, run)| run.limb_force_per_mass_m_s2.first())
        .copied()
        .unwrap_or([0.0; LIMBS]);
    let trials = simulated
        .par_iter()
        .enumerate()
        .map(|(index, (trial, run))| {
            let recording = laboratory.record(run, index);
            Ok(preset.condition(&recording, role(trial.role))?)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Campaign {
        geometry: Geometry::PAPER,
        design: paper::design_parameters(),
        static_voltage_v: laboratory.record_static(rest).voltage_v,
        trials,
    })
}
