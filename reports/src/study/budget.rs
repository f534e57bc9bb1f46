//! The budget of 7.479 %: one imperfection at a time, over a ladder of sizes, in a laboratory that is perfect otherwise.
//!
//! Every laboratory plays a whole session in MuJoCo, trials of steps 2 to 4 and the compound runs of Tables 4 to 6. The four
//! steps see what a laboratory sees; errors are against the simulator's state. Gravity is left out, as in the paper.

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::steps::GyroscopeGain;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::{Parameters, Scheme};
use sixaxis_props::results::{
    Budget, Cells, Combination, Errors, Ladder, PRINTED, Part, Step, Treatments,
};
use sixaxis_props::truth::{InCore, parameters};
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::plan::{
    ChainPlan, Engine, InstrumentPlan, RigPlan, SensorChoice, SessionPlan,
};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::rig::run::Mounting;

use super::Progress;
use super::decoupling::{decouple, largest_error, six_series, truth_of};
use super::results::Gravity;
use super::session::{self, Preset};

/// Trials for each of steps 2 to 4: one on each wedge.
const TRIALS_PER_STEP: usize = 6;
/// Laboratories at each size of an imperfection that is drawn; odd, so that the median is one of them.
const DRAWS: u64 = 3;
/// Class of instruments that are as good as perfect, %: a plan wants a positive one.
const PERFECT_CLASS_PERCENT: f64 = 1e-9;
/// Rounds in which a combination's common share is brought nearer to [`PRINTED`].
const ROUNDS: usize = 3;

/// An imperfection.
#[derive(Clone, Copy)]
pub struct Imperfection {
    /// Its name.
    pub name: &'static str,
    unit: &'static str,
    drawn: bool,
    sizes: &'static [f64],
    /// Makes a plan's laboratory imperfect by a size.
    apply: fn(&mut SessionPlan, f64),
}

/// All that the study plays.
pub const ALL: &[Imperfection] = &[
    Imperfection {
        name: "unequal stiffness",
        unit: "standard deviation over the mean",
        drawn: true,
        sizes: &[1e-3, 1e-2, 0.05, 0.2],
        apply: |plan, size| plan.chain.stiffness_spread = size,
    },
    Imperfection {
        name: "flexures that bend",
        unit: "lateral over axial stiffness",
        drawn: false,
        sizes: &[1e-3, 1e-2, 0.1, 0.5],
        apply: |plan, size| plan.limbs.lateral_stiffness = size,
    },
    Imperfection {
        name: "flexures that damp",
        unit: "of critical",
        drawn: false,
        sizes: &[1e-3, 1e-2, 0.1, 0.5],
        apply: |plan, size| plan.limbs.lateral_damping = size,
    },
    Imperfection {
        name: "limbs with mass",
        unit: "of the seismic mass, each",
        drawn: false,
        sizes: &[1e-4, 1e-3, 1e-2, 0.1],
        apply: |plan, size| plan.limbs.mass = size,
    },
    Imperfection {
        name: "wedges",
        unit: "degrees, at most",
        drawn: true,
        sizes: &[0.01, 0.1, 1.0, 5.0],
        apply: |plan, size| plan.rig.wedge_error_deg = size,
    },
    Imperfection {
        name: "instruments",
        unit: "class, %",
        drawn: true,
        sizes: &[0.1, 1.0, 5.0, 20.0],
        apply: |plan, size| plan.instruments.class_percent = size,
    },
    Imperfection {
        name: "noise of the channels",
        unit: "of a full-scale sine",
        drawn: true,
        sizes: &[1e-4, 1e-3, 1e-2, 0.1],
        apply: |plan, size| plan.chain.signal_to_noise_db = -20.0 * size.log10(),
    },
];

/// Those that are combined, and what they have in common.
const COMBINATIONS: &[(&str, &[&str])] = &[
    (
        "a sensor's limbs",
        &["unequal stiffness", "flexures that bend", "limbs with mass"],
    ),
    (
        "a workshop and its instruments",
        &["wedges", "instruments", "noise of the channels"],
    ),
];

fn perfect(seed: u64) -> SessionPlan {
    SessionPlan {
        seed,
        sensor: SensorChoice::Paper,
        engine: Engine::Mujoco,
        trials_per_step: TRIALS_PER_STEP,
        static_duration_s: 10.0,
        rig: RigPlan::one_turn(Mounting::AxisVertical),
        chain: ChainPlan {
            signal_to_noise_db: f64::INFINITY,
            resolution_bits: 0,
            ..ChainPlan::default()
        },
        instruments: InstrumentPlan {
            class_percent: PERFECT_CLASS_PERCENT,
            signal_to_noise_db: f64::INFINITY,
            ..InstrumentPlan::default()
        },
        ..SessionPlan::default()
    }
}

/// Plays all ladders and combinations.
///
/// # Errors
/// The first session, identification or decoupling that refuses, with what was imperfect.
pub fn study(first_seed: u64, progress: &Progress<'_>) -> Result<Budget> {
    let total = ALL.iter().map(Imperfection::laboratories).sum();
    let nothing = of_laboratory(&perfect(first_seed)).context("a perfect laboratory")?;
    let ladders = ALL
        .iter()
        .map(|imperfection| imperfection.ladder(first_seed, total, progress))
        .collect::<Result<Vec<_>>>()?;
    let combinations = COMBINATIONS
        .iter()
        .filter_map(|(name, parts)| combined(name, parts, &ladders, first_seed).transpose())
        .collect::<Result<Vec<_>>>()?;
    Ok(Budget {
        first_seed,
        trials_per_step: TRIALS_PER_STEP,
        nothing,
        ladders,
        combinations,
    })
}

impl Imperfection {
    fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|imperfection| imperfection.name == name)
    }

    fn draws(&self) -> u64 {
        if self.drawn { DRAWS } else { 1 }
    }

    fn laboratories(&self) -> u64 {
        self.draws() * self.sizes.len() as u64
    }

    fn ladder(&self, first_seed: u64, total: u64, progress: &Progress<'_>) -> Result<Ladder> {
        let steps = self
            .sizes
            .iter()
            .map(|&size| {
                let errors = of_draws(first_seed, self.draws(), &[(self, size)])?;
                progress("laboratories", total, self.draws());
                Ok(Step { size, errors })
            })
            .collect::<Result<Vec<_>>>()?;
        let points: Vec<(f64, f64)> = steps
            .iter()
            .map(|step| (step.size, headline(&step.errors)))
            .collect();
        Ok(Ladder {
            name: self.name.to_owned(),
            unit: self.unit.to_owned(),
            draws: self.draws(),
            alone: Ladder::crossing(&points, PRINTED),
            steps,
        })
    }
}

/// What stands beside the paper's figure: identified, open loop, the largest of 18.
fn headline(errors: &Errors) -> f64 {
    errors.identified.open_loop.largest
}

/// Several imperfections at a common share of the sizes that would do alone, brought near to [`PRINTED`] by a few rounds. None if
/// one of them does nothing by itself.
fn combined(
    name: &str,
    parts: &[&str],
    ladders: &[Ladder],
    first_seed: u64,
) -> Result<Option<Combination>> {
    let alone: Option<Vec<(&Imperfection, f64)>> = parts
        .iter()
        .map(|part| {
            let ladder = ladders.iter().find(|ladder| ladder.name == *part)?;
            Some((Imperfection::named(part)?, ladder.alone?))
        })
        .collect();
    let Some(alone) = alone else {
        return Ok(None);
    };
    let draws = alone.iter().map(|(of, _)| of.draws()).max().unwrap_or(1);
    // Where errors add up as squares do.
    let mut share = (alone.len() as f64).sqrt().recip();
    let mut best: Option<(f64, Combination)> = None;
    for _ in 0..ROUNDS {
        let sized: Vec<_> = alone.iter().map(|&(of, size)| (of, share * size)).collect();
        let errors = of_draws(first_seed, draws, &sized)?;
        let found = headline(&errors);
        let off = (found / PRINTED).ln().abs();
        if best.as_ref().is_none_or(|(least, _)| off < *least) {
            let parts = sized.iter().map(|(of, size)| Part {
                name: of.name.to_owned(),
                size: *size,
                unit: of.unit.to_owned(),
            });
            let name = name.to_owned();
            let parts = parts.collect();
            best = Some((
                off,
                Combination {
                    name,
                    parts,
                    errors,
                },
            ));
        }
        share *= PRINTED / found;
    }
    Ok(best.map(|(_, combination)| combination))
}

/// The median over `draws` laboratories with these imperfections, number by number.
fn of_draws(first_seed: u64, draws: u64, sized: &[(&Imperfection, f64)]) -> Result<Errors> {
    let all = (first_seed..first_seed + draws)
        .map(|seed| {
            let mut plan = perfect(seed);
            for (imperfection, size) in sized {
                (imperfection.apply)(&mut plan, *size);
            }
            of_laboratory(&plan).with_context(|| {
                let names = sized.iter().map(|(of, size)| format!("{} {size}", of.name));
                format!("{}, seed {seed}", names.collect::<Vec<_>>().join(", "))
            })
        })
        .collect::<Result<Vec<_>>>()?;
    let median = |of: &dyn Fn(&Errors) -> f64| middle(all.iter().map(of).collect());
    let cells = |of: &dyn Fn(&Errors) -> Cells| Cells {
        largest: median(&|errors| of(errors).largest),
        median: median(&|errors| of(errors).median),
    };
    let treatments = |of: fn(&Errors) -> Treatments| Treatments {
        open_loop: cells(&|errors| of(errors).open_loop),
        corrected: cells(&|errors| of(errors).corrected),
    };
    Ok(Errors {
        with_truth: treatments(|errors| errors.with_truth),
        identified: treatments(|errors| errors.identified),
    })
}

/// The median; NaN of nothing.
fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.len().saturating_sub(1) / 2, values.len() / 2);
    let at = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
    0.5 * (at(low) + at(high))
}

/// Plays, identifies and decouples.
fn of_laboratory(plan: &SessionPlan) -> Result<Errors> {
    let played = simulate_session(plan)?;
    let recordings: Vec<SimulatedRecording> = played
        .recordings
        .iter()
        .filter(|recording| recording.role == Role::Validation)
        .cloned()
        .collect();
    let truth = parameters(&played.truth.parameters);
    let all = played.recordings.into_iter();
    let campaign = session::prepare(all.map(|r| (r.clone(), r.role)), Preset::Session)?.campaign;
    let found = campaign.identify(GyroscopeGain::Identified)?.used();
    let runs: Vec<(&SimulatedRecording, &Conditioned)> = recordings
        .iter()
        .map(|recording| {
            let mut trials = campaign.trials.iter();
            let conditioned = trials.find(|(trial, _)| trial.name == recording.name);
            let (_, conditioned) = conditioned.context("a compound run is lost")?;
            Ok((recording, conditioned))
        })
        .collect::<Result<_>>()?;
    ensure!(runs.len() == 3, "three compound runs make 18 cells");
    let treatments = |parameters: &Parameters| {
        Ok::<_, anyhow::Error>(Treatments {
            open_loop: cells(&runs, parameters, false)?,
            corrected: cells(&runs, parameters, true)?,
        })
    };
    Ok(Errors {
        with_truth: treatments(&truth)?,
        identified: treatments(&found)?,
    })
}

fn cells(
    runs: &[(&SimulatedRecording, &Conditioned)],
    parameters: &Parameters,
    corrected: bool,
) -> Result<Cells> {
    let of_run = |(recording, conditioned): &(&SimulatedRecording, &Conditioned)| {
        let mut voltage_v = conditioned.voltage_v.clone();
        if corrected {
            let settings = recording.settings(Scheme::Heun);
            let sensor = recording.sensor();
            (voltage_v, _) = rest_to_rest::detrend(&sensor, parameters, &settings, &voltage_v)?;
        }
        let scheme = Scheme::HeunSubstepped;
        let samples = decouple(
            recording,
            &voltage_v,
            parameters,
            scheme,
            Gravity::Neglected,
        )?;
        Ok(largest_error(
            &six_series(&samples),
            &truth_of(&recording.truth),
        ))
    };
    let errors: Vec<f64> = runs
        .par_iter()
        .map(of_run)
        .collect::<Result<Vec<_>>>()?
        .concat();
    Ok(Cells {
        largest: errors.iter().copied().fold(0.0, f64::max),
        median: middle(errors),
    })
}
