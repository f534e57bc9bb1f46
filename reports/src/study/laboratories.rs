//! The compound runs by many laboratories: what one seed's largest error is worth.

use anyhow::{Context, Result};
use rayon::prelude::*;
use sixaxis_calibration::steps::GyroscopeGain;
use sixaxis_props::results::{Against, Laboratories, Treated};
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::rig::run::Mounting;

use super::compound::LABORATORY_DIVISOR;
use super::results::{Compound, Correction, Gravity, ParameterSet, Standard, substepped, worst};
use super::session::{self, Preset};
use super::simulations::Simulations;
use super::{Progress, compound};

/// The laboratories of `count` seeds from `first_seed` on, each with its own instruments and noise, on the same simulated runs.
///
/// # Errors
/// The first identification or decoupling that refuses, with its seed.
pub fn study(
    simulations: &Simulations,
    first_seed: u64,
    count: u64,
    progress: &Progress<'_>,
) -> Result<Laboratories> {
    let runs = (first_seed..first_seed + count)
        .into_par_iter()
        .map(|seed| {
            let runs = of_seed(simulations, seed).with_context(|| format!("seed {seed}"))?;
            progress("laboratories", count, 1);
            Ok(runs)
        })
        .collect::<Result<Vec<_>>>()?;
    let errors = |set, correction, standard| {
        let way = substepped(set, correction, standard);
        runs.iter().map(|runs| worst(runs, way)).collect()
    };
    let against = |set, correction| Against {
        instruments: errors(set, correction, Standard::Instruments),
        truth: errors(set, correction, Standard::Truth),
    };
    let treated = |set| Treated {
        open_loop: against(set, Correction::OpenLoop),
        corrected: against(set, Correction::RestToRest),
    };
    Ok(Laboratories {
        first_seed,
        design: treated(ParameterSet::Design),
        identified: treated(ParameterSet::Identified),
        with_truth: treated(ParameterSet::True),
    })
}

fn of_seed(simulations: &Simulations, seed: u64) -> Result<Vec<Compound>> {
    let truth = truth::identified_parameters();
    let laboratory = Laboratory::with_errors(truth::sensor(&truth), seed);
    let found = session::record(&laboratory, &simulations.campaign, Preset::Session)?
        .campaign
        .identify(GyroscopeGain::Identified)?;
    let ways = compound::ways(&truth, &found, None, Gravity::Neglected);
    compound::study(
        simulations,
        Mounting::AxisVertical,
        LABORATORY_DIVISOR,
        &laboratory,
        Preset::Session,
        &ways,
    )
}
