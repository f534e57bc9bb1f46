//! The study: plays the paper's campaign on MuJoCo, runs the paper's methods on what a laboratory would see of it,
//! and holds the outcome against the truth.
//!
//! [`plan`] says what is played, [`simulations`] plays it, [`session`] is the laboratory's analysis and
//! [`identification`] what it finds, [`compound`], [`searches`], [`identifiability`], [`orders`], [`history`] and [`checks`] make the comparisons, [`arithmetic`] decides what needs no campaign,
//! [`laboratories`] says what one seed is worth, [`budget`] what one imperfection costs, [`acceptance`] judges them, and [`results`] is all of it as data. Nothing here draws.

pub mod acceptance;
pub mod arithmetic;
pub mod budget;
pub mod checks;
pub mod compound;
pub mod decoupling;
pub mod history;
pub mod identifiability;
pub mod identification;
pub mod laboratories;
pub mod orders;
pub mod plan;
pub mod results;
pub mod searches;
pub mod session;
pub mod simulations;

use anyhow::{Context, Result};
use sixaxis_calibration::steps::{FourSteps, GyroscopeGain};
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::mujoco::version;
use sixaxis_reference::rig::run::Mounting;

use compound::{COMPARED_DIVISOR, LABORATORY_DIVISOR};
use plan::Plan;
use results::{Gravity, Results};
use session::Preset;
use simulations::Simulations;

/// Who is told how far the work is: name of a stage, units of work in it, units done since the last call. From any thread.
pub type Progress<'a> = dyn Fn(&str, u64, u64) + Sync + 'a;

/// Steps that are not alike, each a stage of its own.
struct Steps<'a>(&'a Progress<'a>);

impl Steps<'_> {
    /// Does a step; an error names it.
    fn step<T>(&self, name: &'static str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        (self.0)(name, 1, 0);
        let outcome = work().context(name);
        (self.0)(name, 1, 1);
        outcome
    }
}

/// Runs the study.
///
/// # Errors
/// The first simulation, identification or decoupling that refuses, with what it was doing.
pub fn run(plan: &Plan, progress: &Progress<'_>) -> Result<Results> {
    let simulations = &simulations::simulate(plan, progress)?;
    let steps = Steps(progress);
    let truth = truth::identified_parameters();
    let perfect = Laboratory::noise_free(truth::sensor(&truth));
    let laboratory = Laboratory::with_errors(truth::sensor(&truth), plan.seed);

    // Branches that need nothing of each other run side by side.
    let (without_errors, with_errors) = rayon::join(
        || {
            let exact = session::record(&perfect, &simulations.campaign, Preset::None)?.campaign;
            let found = steps.step("campaign without errors", || {
                Ok(exact.identify(GyroscopeGain::Trusted)?)
            })?;
            let repeated = steps.step("the same, steps repeated", || {
                Ok(exact.repeat_from(&found, found.used().stiffness_per_mass_per_s2)?)
            })?;
            let coarse = steps.step("the same, doubled step", || coarse(simulations, &perfect))?;
            anyhow::Ok((exact, found, repeated, coarse))
        },
        || {
            let recorded = session::record(&laboratory, &simulations.campaign, Preset::Session)?;
            let found = steps.step("campaign with errors", || {
                Ok(recorded.campaign.identify(GyroscopeGain::Identified)?)
            })?;
            let (iterations, known) = rayon::join(
                || {
                    steps.step("the same, iterated", || {
                        identifiability::iteration::with_errors(&recorded.campaign, &found, &truth)
                    })
                },
                || {
                    steps.step("the same, joint fit", || {
                        identifiability::known::study(&recorded, &laboratory)
                    })
                },
            );
            anyhow::Ok((found, iterations?, known?))
        },
    );
    let (exact, noise_free, repeated, coarse) = without_errors?;
    let (with_errors, iterations, known) = with_errors?;

    let exact_ways = compound::ways(&truth, &noise_free, Some(&repeated), Gravity::Kept);
    let laboratory_ways = compound::ways(&truth, &with_errors, None, Gravity::Neglected);
    let compound = |mounting, divisor, laboratory, preset, ways: &[compound::Way]| {
        steps.step("compound runs", || {
            compound::study(simulations, mounting, divisor, laboratory, preset, ways)
        })
    };
    let (of_k, of_runs) = rayon::join(
        || {
            let searches = steps.step("search for k/m", || {
                let stride = plan.search_stride();
                searches::study(&exact, &noise_free, &with_errors, &truth, stride)
            })?;
            let identifiability = steps.step("identifiability", || {
                identifiability::study(plan, &exact, &noise_free, known, iterations, &truth)
            })?;
            anyhow::Ok((searches, identifiability))
        },
        || {
            let vertical = Mounting::AxisVertical;
            let level = Mounting::AxisLevel;
            let perfectly = |mounting, divisor, ways: &[compound::Way]| {
                compound(mounting, divisor, &perfect, Preset::None, ways)
            };
            let schemes = compound::ways_of_schemes(&truth);
            let upright = perfectly(vertical, COMPARED_DIVISOR, &exact_ways)?;
            let lying = perfectly(level, COMPARED_DIVISOR, &exact_ways)?;
            let at_half_rate = [vertical, level]
                .into_iter()
                .map(|mounting| perfectly(mounting, 2 * COMPARED_DIVISOR, &schemes))
                .collect::<Result<Vec<_>>>()?
                .concat();
            let recorded = compound(
                vertical,
                LABORATORY_DIVISOR,
                &laboratory,
                Preset::Session,
                &laboratory_ways,
            )?;
            let compounds = [upright, lying, at_half_rate, recorded];
            let orders = steps.step("order of the schemes", || {
                let run = simulations.compound_halved.last();
                let run = run.context("no compound run was simulated")?;
                orders::study(run, &truth, &plan.order_divisors())
            })?;
            let history = steps.step("time histories", || {
                history::study(simulations, &perfect, &repeated, &laboratory, &with_errors)
            })?;
            let defects = steps.step("defects", || checks::defects(simulations, &truth))?;
            anyhow::Ok((compounds, orders, history, defects))
        },
    );
    let (searches, identifiability) = of_k?;
    let (compounds, orders, history, defects) = of_runs?;
    let [
        compound_noise_free,
        compound_axis_level,
        compound_half_rate,
        compound_laboratory,
    ] = compounds;
    let found = |steps| identification::found(&truth, steps, &noise_free, coarse.as_ref());
    let mut results = Results {
        seed: plan.seed,
        quick: plan.quick,
        trials_per_step: plan.trials_per_step(),
        sixaxis_version: env!("CARGO_PKG_VERSION").to_owned(),
        mujoco_version: version().to_owned(),
        reference: checks::reference(plan, simulations)?,
        noise_free: found(&noise_free)?,
        noise_free_repeated: found(&repeated)?,
        laboratory: found(&with_errors)?,
        instruments: laboratory.instruments,
        compound_noise_free,
        compound_laboratory,
        compound_axis_level,
        compound_half_rate,
        thresholds: checks::sweeps(simulations),
        searches,
        identifiability,
        orders,
        history,
        defects,
        arithmetic: arithmetic::study(),
        acceptance: Vec::new(),
    };
    results.acceptance = acceptance::judge(&results);
    Ok(results)
}

/// The four steps without errors at twice the simulator's step, if that was simulated.
fn coarse(simulations: &Simulations, perfect: &Laboratory) -> Result<Option<FourSteps>> {
    if simulations.campaign_coarse.is_empty() {
        return Ok(None);
    }
    let session = session::record(perfect, &simulations.campaign_coarse, Preset::None)?;
    Ok(Some(session.campaign.identify(GyroscopeGain::Trusted)?))
}
