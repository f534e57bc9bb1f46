//! The study: plays the paper's campaign on MuJoCo, runs the paper's methods on what a laboratory would see of it,
//! and holds the outcome against the truth.
//!
//! [`plan`] says what is played, [`simulations`] plays it, [`conditioning`] and [`identification`] are the laboratory's
//! analysis, [`decoupling`], [`searches`], [`identifiability`], [`orders`] and [`checks`] make the comparisons, [`bars`]
//! judges them, and [`results`] is all of it as data. Nothing here draws.

pub mod bars;
pub mod checks;
pub mod conditioning;
pub mod decoupling;
pub mod identifiability;
pub mod identification;
pub mod orders;
pub mod plan;
pub mod results;
pub mod searches;
pub mod simulations;

use anyhow::{Context, Result};
use sixaxis_calibration::steps::{FourSteps, GyroscopeGain};
use sixaxis_core::{Parameters, Scheme};
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::version;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::Mounting;

use crate::progress::Progress;
use conditioning::Preset;
use decoupling::{Case, SixSeries, Way, decouple, six_series, truth};
use plan::{COMPOUND_RATE_HZ, Plan};
use results::{Compound, Gravity, History, Identification, ParameterSet, Parameters25, Results};
use simulations::Simulations;

/// Decimation of a compound run to the 10 kHz at which Tables 4 to 6 are compared.
const COMPARED_DIVISOR: usize = 2;
/// The laboratory keeps all 20 kHz: at a given noise of one sample, a higher rate is a quieter channel.
const LABORATORY_DIVISOR: usize = 1;
/// Points of a drawn time history.
const HISTORY_POINTS: usize = 1200;

/// Runs the study.
///
/// # Errors
/// The first simulation, identification or decoupling that refuses, with what it was doing.
pub fn run(plan: &Plan, progress: &Progress) -> Result<Results> {
    let simulations = simulations::simulate(plan, progress)?;
    let stage = progress.stage("analysis", 10);
    let truth = truth::identified_parameters();
    let perfect = Laboratory::noise_free(truth::sensor(&truth));
    let laboratory = Laboratory::with_errors(truth::sensor(&truth), plan.seed);

    let noise_free_session = identification::record(&perfect, &simulations.campaign, Preset::None)?;
    let noise_free = noise_free_session
        .identify(GyroscopeGain::Trusted)
        .context("noise-free campaign")?;
    stage.advance(1);
    let laboratory_session =
        identification::record(&laboratory, &simulations.campaign, Preset::Identification)?;
    let with_errors = laboratory_session
        .identify(GyroscopeGain::Identified)
        .context("campaign with laboratory errors")?;
    let iterations_with_errors =
        identifiability::iteration::with_errors(&laboratory_session, &with_errors, &truth)?;
    let known =
        identifiability::known::study(&laboratory_session, Preset::Identification, &laboratory)?;
    drop(laboratory_session);
    stage.advance(1);
    let coarse = if simulations.campaign_coarse.is_empty() {
        None
    } else {
        let session = identification::record(&perfect, &simulations.campaign_coarse, Preset::None)?;
        Some(
            session
                .identify(GyroscopeGain::Trusted)
                .context("campaign at the doubled step")?,
        )
    };
    stage.advance(1);

    let compound = |laboratory: &Laboratory,
                    ways: &[Way],
                    mounting: Mounting,
                    conditioning: Preset,
                    divisor: usize|
     -> Result<Vec<Compound>> {
        let (full, halved) = match mounting {
            Mounting::AxisVertical => (&simulations.compound, &simulations.compound_halved),
            Mounting::AxisLevel => (&simulations.axis_level, &simulations.axis_level_halved),
        };
        (0..full.len())
            .map(|index| {
                Case {
                    run: full[index].decimated(divisor),
                    halved: halved[index].decimated(divisor),
                    index: table_index(&full[index]),
                    mounting,
                    laboratory,
                    conditioning,
                    close: conditioning != Preset::None,
                }
                .compare(ways)
                .with_context(|| format!("compound run at {} Hz", full[index].motion.frequency_hz))
            })
            .collect()
    };
    let repeated = noise_free_session
        .repeat(&noise_free)
        .context("noise-free campaign, repeated")?;
    let exact_ways = ways(&truth, &noise_free, Some(&repeated), Gravity::Kept);
    let compound_noise_free = compound(
        &perfect,
        &exact_ways,
        Mounting::AxisVertical,
        Preset::None,
        COMPARED_DIVISOR,
    )?;
    stage.advance(1);
    let compound_laboratory = compound(
        &laboratory,
        &ways(&truth, &with_errors, None, Gravity::Neglected),
        Mounting::AxisVertical,
        Preset::Comparison,
        LABORATORY_DIVISOR,
    )?;
    stage.advance(1);
    let compound_axis_level = compound(
        &perfect,
        &exact_ways,
        Mounting::AxisLevel,
        Preset::None,
        COMPARED_DIVISOR,
    )?;
    stage.advance(1);
    let searches = searches::study(
        &noise_free_session,
        &noise_free,
        &with_errors,
        &truth,
        plan.search_stride(),
    )?;
    stage.advance(1);
    let identifiability = identifiability::study(
        plan,
        &noise_free_session,
        &noise_free,
        known,
        iterations_with_errors,
        &truth,
    )?;
    stage.advance(1);
    let orders = orders::study(
        simulations
            .compound_halved
            .last()
            .context("no compound run was simulated")?,
        &truth,
        &plan.order_divisors(),
    )?;
    stage.advance(1);
    let history = history(&simulations, &perfect, &repeated, &laboratory, &with_errors)?;
    let mut results = Results {
        seed: plan.seed,
        quick: plan.quick,
        trials_per_step: plan.trials_per_step(),
        sixaxis_version: env!("CARGO_PKG_VERSION").to_owned(),
        mujoco_version: version().to_owned(),
        reference: checks::reference(plan, &simulations)?,
        noise_free: identification_results(&truth, &noise_free, &noise_free, coarse.as_ref())?,
        noise_free_repeated: identification_results(
            &truth,
            &repeated,
            &noise_free,
            coarse.as_ref(),
        )?,
        laboratory: identification_results(&truth, &with_errors, &noise_free, coarse.as_ref())?,
        instruments: laboratory.instruments,
        compound_noise_free,
        compound_laboratory,
        compound_axis_level,
        thresholds: checks::sweeps(&simulations),
        searches,
        identifiability,
        orders,
        history,
        defects: checks::defects(&simulations, &truth)?,
        bars: Vec::new(),
    };
    results.bars = bars::judge(&results);
    stage.advance(1);
    Ok(results)
}

/// Which of Tables 4 to 6 a compound run belongs to.
fn table_index(run: &SimulatedRun) -> usize {
    paper::COMPOUND_TABLES
        .iter()
        .position(|table| table.frequency_hz == run.motion.frequency_hz)
        .unwrap_or_default()
}

/// Parameter sets and schemes with which every compound run is decoupled.
///
/// The laboratory knows from its mounting whether gravity turns in the shell; where it does not, it leaves gravity
/// out, as the paper does: reckoning with it would only let errors of the attitude in.
fn ways(
    truth: &Parameters,
    found: &FourSteps,
    repeated: Option<&FourSteps>,
    gravity: Gravity,
) -> Vec<Way> {
    let design = truth::design_parameters();
    let way = |set, parameters, scheme| Way {
        set,
        parameters,
        scheme,
        gravity,
    };
    let mut ways = vec![way(ParameterSet::Design, design, Scheme::Heun)];
    if gravity == Gravity::Neglected {
        // The laboratory: one scheme will do, its errors are larger than any scheme's.
        for (set, parameters) in [
            (ParameterSet::Identified, found.used()),
            (ParameterSet::True, *truth),
        ] {
            ways.push(way(set, parameters, Scheme::HeunSubstepped));
        }
        return ways;
    }
    ways.push(way(
        ParameterSet::DesignDriftRemoved,
        Parameters {
            zero_drift_v: found.drift.drift_v,
            ..design
        },
        Scheme::Heun,
    ));
    let mut sets = vec![
        (ParameterSet::Identified, found.used()),
        (ParameterSet::True, *truth),
    ];
    sets.extend(repeated.map(|r| (ParameterSet::Repeated, r.used())));
    for (set, parameters) in sets {
        for scheme in [Scheme::Heun, Scheme::HeunSubstepped, Scheme::AdamsMoulton4] {
            ways.push(way(set, parameters, scheme));
        }
    }
    ways.push(Way {
        set: ParameterSet::True,
        parameters: *truth,
        scheme: Scheme::AdamsMoulton4,
        gravity: Gravity::Neglected,
    });
    ways
}

fn identification_results(
    truth: &Parameters,
    steps: &FourSteps,
    noise_free: &FourSteps,
    coarse: Option<&FourSteps>,
) -> Result<Identification> {
    let not_measured = f64::NAN;
    let stiffness = steps
        .stiffness
        .as_ref()
        .context("a campaign without trials for step 4")?;
    Ok(Identification {
        truth: *truth,
        found: steps.found(),
        used: steps.used(),
        reference_error: match coarse.map(FourSteps::found) {
            None => Parameters25 {
                zero_drift_v: [not_measured; 9],
                scale_per_mass_per_kg: [not_measured; 9],
                inertia_per_mass_m2: [not_measured; 6],
                stiffness_per_mass_per_s2: not_measured,
            },
            Some(coarse) => {
                let fine = noise_free.found();
                let difference =
                    |a: [f64; 9], b: [f64; 9]| core::array::from_fn(|i| (a[i] - b[i]).abs());
                let (a, b) = (
                    coarse.inertia_per_mass.to_paper_order(),
                    fine.inertia_per_mass.to_paper_order(),
                );
                Parameters25 {
                    zero_drift_v: difference(coarse.zero_drift_v, fine.zero_drift_v),
                    scale_per_mass_per_kg: difference(
                        coarse.scale_per_mass_per_kg,
                        fine.scale_per_mass_per_kg,
                    ),
                    inertia_per_mass_m2: core::array::from_fn(|i| (a[i] - b[i]).abs()),
                    stiffness_per_mass_per_s2: (coarse.stiffness_per_mass_per_s2
                        - fine.stiffness_per_mass_per_s2)
                        .abs(),
                }
            }
        },
        standard_error: Parameters25 {
            zero_drift_v: steps.drift.standard_error_v,
            scale_per_mass_per_kg: steps.scale.estimate.standard_error(),
            inertia_per_mass_m2: steps.inertia.estimate.standard_error(),
            stiffness_per_mass_per_s2: not_measured,
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

/// The 5 Hz run over time: truth, and what both laboratories make of it.
fn history(
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
        let scheme = Scheme::HeunSubstepped;
        let case = Case {
            run: run.clone(),
            halved: run.clone(),
            index,
            mounting: Mounting::AxisVertical,
            laboratory,
            conditioning,
            close: conditioning != Preset::None,
        };
        let (recording, conditioned) = case.record(&run)?;
        let parameters = found.used();
        let voltages = case.voltages(&recording, &conditioned, &parameters)?;
        let samples = decouple(&recording, &voltages, &parameters, scheme, gravity)?;
        Ok(six_series(&samples))
    };
    let exact = ours(perfect, noise_free, Preset::None, Gravity::Kept)?;
    let noisy = ours(
        laboratory,
        with_errors,
        Preset::Comparison,
        Gravity::Neglected,
    )?;
    let stride = truth[0].len().div_ceil(HISTORY_POINTS).max(1);
    let thin = |series: &SixSeries| -> SixSeries {
        core::array::from_fn(|i| series[i].iter().copied().step_by(stride).collect())
    };
    let difference = |a: &SixSeries| -> SixSeries {
        core::array::from_fn(|i| a[i].iter().zip(&truth[i]).map(|(x, y)| x - y).collect())
    };
    let rate = COMPOUND_RATE_HZ / COMPARED_DIVISOR as f64;
    Ok(History {
        frequency_hz: run.motion.frequency_hz,
        time_s: (0..truth[0].len())
            .step_by(stride)
            .map(|i| (i + 1) as f64 / rate)
            .collect(),
        error_noise_free: thin(&difference(&exact)),
        error_laboratory: thin(&difference(&noisy)),
        laboratory: thin(&noisy),
        truth: thin(&truth),
    })
}
