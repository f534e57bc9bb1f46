//! The simulated campaign as the analysis has it: recorded, conditioned, ready for the four steps.

use anyhow::Result;
use rayon::prelude::*;
use sixaxis_calibration::steps::Campaign;
use sixaxis_core::Geometry;
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::schedule::PlannedTrial;
use sixaxis_reference::motion::SimulatedRun;

use super::conditioning::Preset;

/// Records and cleans a simulated campaign.
///
/// # Errors
/// Those of the conditioning.
pub fn record(
    laboratory: &Laboratory,
    simulated: &[(PlannedTrial, SimulatedRun)],
    preset: Preset,
) -> Result<Campaign> {
    let trials = simulated
        .par_iter()
        .enumerate()
        .map(|(index, (trial, run))| {
            let recording = laboratory.record(run, index);
            Ok(preset.condition(&recording, trial.role)?)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Campaign {
        geometry: Geometry::PAPER,
        design: truth::design_parameters(),
        static_voltage_v: laboratory.record_static().voltage_v,
        trials,
    })
}
