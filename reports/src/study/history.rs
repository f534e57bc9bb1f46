//! Time histories of the 5 Hz compound run.

use anyhow::Result;
use sixaxis_calibration::steps::FourSteps;
use sixaxis_core::Scheme;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::rig::run::Mounting;

use super::compound::{COMPARED_DIVISOR, Case, Way};
use super::decoupling::{SixSeries, decouple, difference, six_series, truth};
use super::plan::COMPOUND_RATE_HZ;
use super::results::{Correction, Gravity, History, ParameterSet};
use super::session::Preset;
use super::simulations::Simulations;

/// Points of a drawn time history.
const HISTORY_POINTS: usize = 1200;

/// The 5 Hz run over time: truth, and what both laboratories make of it.
///
/// # Errors
/// Those of recording and decoupling.
pub fn study(
    simulations: &Simulations,
    perfect: &Laboratory,
    noise_free: &FourSteps,
    laboratory: &Laboratory,
    with_errors: &FourSteps,
) -> Result<History> {
    let index = simulations.compound.len() - 1;
    let run: SimulatedRun = simulations.compound[index].decimated(COMPARED_DIVISOR);
    let truth = truth(&run);
    let ours = |laboratory, found: &FourSteps, conditioning, gravity| -> Result<SixSeries> {
        let way = Way {
            set: ParameterSet::Identified,
            parameters: found.used(),
            scheme: Scheme::HeunSubstepped,
            gravity,
            correction: match conditioning {
                Preset::None => Correction::OpenLoop,
                _ => Correction::RestToRest,
            },
        };
        let case = Case {
            run: run.clone(),
            halved: None,
            index,
            mounting: Mounting::AxisVertical,
            laboratory,
            conditioning,
        };
        let (recording, conditioned) = case.record(&run)?;
        let voltages = case.voltages(&recording, &conditioned, &way)?;
        let samples = decouple(&recording, &voltages, &way.parameters, way.scheme, gravity)?;
        Ok(six_series(&samples))
    };
    let exact = ours(perfect, noise_free, Preset::None, Gravity::Kept)?;
    let noisy = ours(laboratory, with_errors, Preset::Session, Gravity::Neglected)?;
    let stride = truth[0].len().div_ceil(HISTORY_POINTS).max(1);
    let thin = |series: &SixSeries| -> SixSeries {
        core::array::from_fn(|i| series[i].iter().copied().step_by(stride).collect())
    };
    let rate = COMPOUND_RATE_HZ / COMPARED_DIVISOR as f64;
    Ok(History {
        frequency_hz: run.motion.frequency_hz,
        time_s: (0..truth[0].len())
            .step_by(stride)
            .map(|i| (i + 1) as f64 / rate)
            .collect(),
        error_noise_free: thin(&difference(&exact, &truth)),
        error_laboratory: thin(&difference(&noisy, &truth)),
        laboratory: thin(&noisy),
        truth: thin(&truth),
    })
}
