//! The budget of 7.479 %: one imperfection at a time, over a ladder of sizes, in a laboratory that is perfect otherwise.
//!
//! Every laboratory plays a whole session, trials of steps 2 to 4 and the compound runs of Tables 4 to 6: in MuJoCo what concerns the
//! limbs, by the rigid engine, whose forces are MuJoCo's to 1e-5 at 5 Hz (test `ref_rigid_runs_are_mujocos`), what concerns rig and
//! laboratory alone. The four steps see what a laboratory sees and trust the gyroscope, as the paper does; errors are against the
//! simulator's state. Gravity is left out, as in the paper.

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::steps::GyroscopeGain;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::{Parameters, Scheme};
use sixaxis_props::results::{Budget, Cells, Errors, Imperfect, Part, Treatments};
use sixaxis_props::truth::{InCore, parameters};
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::plan::{
    ChainPlan, Engine, InstrumentPlan, RigPlan, SensorChoice, SessionPlan,
};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::rig::run::Mounting;

use super::decoupling::{decouple, largest_error, six_series, truth_of};
use super::results::Gravity;
use super::session::{self, Preset};

/// Trials for each of steps 2 to 4: along the sensor's own axes, the fewest that determine all parameters.
const TRIALS_PER_STEP: usize = 3;
/// Laboratories at each size of an imperfection that is drawn; odd, so that the median is one of them.
const DRAWS: usize = 3;
/// Class of instruments that are as good as perfect, %: a plan wants a positive one.
const PERFECT_CLASS_PERCENT: f64 = 1e-9;
/// Seed of the first laboratory of the list; the others follow. Any other multiple of [`LIST`] gives the same laboratories with other
/// draws.
pub const FIRST_SEED: u64 = 810_000;
/// Longest list.
const LIST: u64 = 1_000;

/// An imperfection.
#[derive(Clone, Copy)]
pub struct Imperfection {
    /// Its name.
    pub name: &'static str,
    unit: &'static str,
    drawn: bool,
    /// The engine that plays it: rig and laboratory are the same to either, and limbs that give way change a force by 1e-5.
    engine: Engine,
    sizes: &'static [f64],
    /// Makes a plan's laboratory imperfect by a size.
    apply: fn(&mut SessionPlan, f64),
}

/// All that the study plays.
pub const ALL: &[Imperfection] = &[
    Imperfection {
        name: "unequal stiffness",
        unit: "standard deviation over the mean",
        drawn: false,
        engine: Engine::Mujoco,
        sizes: &[1e-3, 1e-2, 0.05, 0.2],
        apply: |plan, size| plan.chain.stiffness_spread = size,
    },
    Imperfection {
        name: "flexures that bend",
        unit: "lateral over axial stiffness",
        drawn: false,
        engine: Engine::Mujoco,
        sizes: &[1e-5, 1e-4, 1e-3, 1e-2],
        apply: |plan, size| plan.limbs.lateral_stiffness = size,
    },
    Imperfection {
        name: "flexures that damp",
        unit: "of critical",
        drawn: false,
        engine: Engine::Mujoco,
        sizes: &[1e-4, 1e-3, 1e-2, 0.1],
        apply: |plan, size| plan.limbs.lateral_damping = size,
    },
    Imperfection {
        name: "limbs with mass",
        unit: "of the seismic mass, each",
        drawn: false,
        engine: Engine::Mujoco,
        sizes: &[1e-5, 1e-4, 1e-3, 1e-2],
        apply: |plan, size| plan.limbs.mass = size,
    },
    Imperfection {
        name: "connecting rod",
        unit: "crank over rod",
        drawn: false,
        engine: Engine::Rigid,
        sizes: &[1e-3, 1e-2, 0.1, 0.3],
        apply: |plan, size| plan.rig.crank_over_rod = size,
    },
    Imperfection {
        name: "tilted axis",
        unit: "degrees",
        drawn: true,
        engine: Engine::Rigid,
        sizes: &[0.01, 0.1, 1.0, 5.0],
        apply: |plan, size| plan.rig.axis_tilt_deg = size,
    },
    Imperfection {
        name: "centre off the axis",
        unit: "mm",
        drawn: true,
        engine: Engine::Rigid,
        sizes: &[0.01, 0.1, 1.0, 5.0],
        apply: |plan, size| plan.rig.centre_offset_mm = size,
    },
    Imperfection {
        name: "wedges",
        unit: "degrees, at most",
        drawn: true,
        engine: Engine::Rigid,
        sizes: &[0.01, 0.1, 1.0, 5.0],
        apply: |plan, size| plan.rig.wedge_error_deg = size,
    },
    Imperfection {
        name: "instruments",
        unit: "class, %",
        drawn: true,
        engine: Engine::Rigid,
        sizes: &[0.1, 1.0, 5.0, 20.0],
        apply: |plan, size| plan.instruments.class_percent = size,
    },
    Imperfection {
        name: "noise of the channels",
        unit: "of a full-scale sine",
        drawn: false,
        engine: Engine::Rigid,
        sizes: &[1e-4, 1e-3, 1e-2, 0.1],
        apply: |plan, size| plan.chain.signal_to_noise_db = -20.0 * size.log10(),
    },
];

/// Plausible sizes of several together, which are played at each of [`FACTORS`] times as much.
const COMBINATIONS: &[&[(&str, f64)]] = &[
    &[
        ("unequal stiffness", 0.02),
        ("flexures that bend", 3e-4),
        ("limbs with mass", 3e-4),
    ],
    &[
        ("connecting rod", 0.1),
        ("tilted axis", 0.1),
        ("centre off the axis", 0.1),
        ("wedges", 0.1),
        ("instruments", 1.0),
        ("noise of the channels", 1e-3),
    ],
];
/// See [`COMBINATIONS`].
const FACTORS: [f64; 3] = [0.3, 1.0, 3.0];

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

/// All laboratories: what is imperfect in each.
fn list() -> Vec<Vec<(&'static Imperfection, f64)>> {
    let mut list = vec![Vec::new()];
    for imperfection in ALL {
        for &size in imperfection.sizes {
            let alone = core::iter::repeat_n(vec![(imperfection, size)], imperfection.draws());
            list.extend(alone);
        }
    }
    for parts in COMBINATIONS {
        for factor in FACTORS {
            let parts = parts.iter();
            let sized: Vec<_> = parts
                .filter_map(|(name, size)| Some((Imperfection::named(name)?, factor * size)))
                .collect();
            let draws = sized.iter().map(|(of, _)| of.draws()).max().unwrap_or(1);
            list.extend(core::iter::repeat_n(sized, draws));
        }
    }
    list
}

/// Number of laboratories in the study.
pub fn laboratories() -> u64 {
    list().len() as u64
}

/// Plays `count` of the study's laboratories, the one of `first_seed` first, and says of each what came of it. Seeds that are none of
/// the study's are left out.
pub fn study(first_seed: u64, count: u64, say: &dyn Fn(&Imperfect)) -> Budget {
    let list = list();
    let played = (first_seed..first_seed + count).filter_map(|seed| {
        let sized = list.get((seed % LIST) as usize)?;
        let laboratory = imperfect(seed, sized);
        say(&laboratory);
        Some(laboratory)
    });
    Budget {
        trials_per_step: TRIALS_PER_STEP,
        laboratories: played.collect(),
    }
}

impl Imperfection {
    fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|imperfection| imperfection.name == name)
    }

    fn draws(&self) -> usize {
        if self.drawn { DRAWS } else { 1 }
    }
}

fn imperfect(seed: u64, sized: &[(&Imperfection, f64)]) -> Imperfect {
    let mut plan = perfect(seed);
    let all_rigid = sized.iter().all(|(of, _)| of.engine == Engine::Rigid);
    if all_rigid && !sized.is_empty() {
        plan.engine = Engine::Rigid;
    }
    for (imperfection, size) in sized {
        (imperfection.apply)(&mut plan, *size);
    }
    let parts = sized.iter().map(|(of, size)| Part {
        name: of.name.to_owned(),
        size: *size,
        unit: of.unit.to_owned(),
    });
    let parts = parts.collect();
    let mujoco = plan.engine == Engine::Mujoco;
    let (errors, refused) = match of_laboratory(&plan) {
        Ok(errors) => (Some(errors), None),
        Err(error) => (None, Some(format!("{error:#}"))),
    };
    Imperfect {
        seed,
        mujoco,
        parts,
        errors,
        refused,
    }
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
    let found = campaign.identify(GyroscopeGain::Trusted)?.used();
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
