//! Plays a session plan: what the laboratory records, what it writes into its session file, and what only the simulator knows.

use std::path::PathBuf;

use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;
use sixaxis_core::{LIMBS, Parameters};
use sixaxis_recordings::session::{Entry, Role, Session};
use thiserror::Error;

use super::check::check;
use super::defect::{Defect, Where};
use super::plan::SessionPlan;
use super::record::{Recorder, chain, wedge_errors};
use super::schedule::{Planned, trials};
use super::session_file::session;
use super::strike;
use crate::instruments::{GAIN_SHARE, Instruments};
use crate::recording::TrueMotion;
use crate::rig::Mounting;
use crate::simulation::SimulationError;

/// Random streams of a session.
const INSTRUMENT_STREAM: u128 = 6;
const STATIC_STREAM: u128 = 7;

/// A session that cannot be played.
#[derive(Debug, Error)]
pub enum PlayError {
    /// MuJoCo refuses.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The plan says something that cannot be.
    #[error("simulation plan: {key}: {cause}")]
    Plan {
        /// The key, as in `rig.rest_s`.
        key: String,
        /// What is wrong, and what would be right.
        cause: String,
    },
}

/// One recording as it lies on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// What the session file says of it.
    pub entry: Entry,
    /// Samples per second as the recorder writes it down.
    pub sample_rate_hz: f64,
    /// Nine voltages per sample, V, true volts times whatever the recorder makes of them.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Accelerometer, m/s^2; empty for the static record and for taps.
    pub accelerometer_m_s2: Vec<f64>,
    /// Gyroscope, rad/s; empty for the static record and for taps.
    pub gyroscope_rad_s: Vec<f64>,
    /// The true motion; empty for the static record.
    pub truth: Vec<TrueMotion>,
}

/// A played session.
#[derive(Debug, Clone)]
pub struct PlayedSession {
    /// What the laboratory writes down.
    pub session: Session,
    /// Its recordings, the static one first.
    pub recordings: Vec<Played>,
    /// What it does not know.
    pub truth: Truth,
}

/// What only the simulator knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// The plan.
    pub plan: SessionPlan,
    /// The sensor's true parameters.
    pub parameters: Parameters,
    /// The instruments as they are.
    pub instruments: Instruments,
    /// What is wrong, particulars drawn.
    pub defect: Option<Defect>,
}

/// Plays a session.
///
/// # Errors
/// [`PlayError`].
pub fn play(plan: &SessionPlan) -> Result<PlayedSession, PlayError> {
    play_watched(plan, &|_| {})
}

/// Simulated time of all trials, ms: the work that [`play_watched`] reports on.
///
/// # Errors
/// [`PlayError::Plan`].
pub fn work_ms(plan: &SessionPlan) -> Result<u64, PlayError> {
    check(plan)?;
    let trials: u64 = trials(plan, None)
        .iter()
        .map(|trial| trial_ms(plan, trial))
        .sum();
    Ok(trials + plan.rig.taps as u64 * strike::WORK_MS)
}

fn trial_ms(plan: &SessionPlan, trial: &Planned) -> u64 {
    (1e3 * trial.run(&plan.rig, trial.direction).duration_s()) as u64
}

/// Plays a session and says of each trial, when it is done, how long it was, ms; from any thread.
///
/// # Errors
/// [`PlayError`].
pub fn play_watched(
    plan: &SessionPlan,
    done_ms: &(dyn Fn(u64) + Sync),
) -> Result<PlayedSession, PlayError> {
    check(plan)?;
    let defect = plan.drawn_defect();
    let defect = defect.as_ref();
    let parameters = plan.parameters();
    let instruments = instruments(plan, defect);
    let recorder = Recorder {
        plan,
        defect,
        instruments: &instruments,
        parameters: &parameters,
        mounting: match defect {
            Some(Defect::GravityNotHandled { level: true }) => Mounting::AxisLevel,
            Some(Defect::GravityNotHandled { level: false }) => Mounting::AxisVertical,
            _ => plan.rig.mounting,
        },
        wedge_errors: wedge_errors(plan),
    };
    let mut recordings = vec![static_record(plan, &parameters, defect)];
    let played: Vec<Played> = trials(plan, defect)
        .par_iter()
        .enumerate()
        .map(|(index, trial)| {
            let played = recorder.record(index, trial)?;
            done_ms(trial_ms(plan, trial));
            Ok(played)
        })
        .collect::<Result<_, PlayError>>()?;
    recordings.extend(played);
    let struck: Vec<Played> = (0..plan.rig.taps)
        .into_par_iter()
        .map(|index| {
            let played = recorder.strike(index)?;
            done_ms(strike::WORK_MS);
            Ok(played)
        })
        .collect::<Result<_, PlayError>>()?;
    recordings.extend(struck);
    Ok(PlayedSession {
        session: session(plan, defect, &recordings),
        recordings,
        truth: Truth {
            plan: plan.clone(),
            parameters,
            instruments,
            defect: defect.cloned(),
        },
    })
}

fn instruments(plan: &SessionPlan, defect: Option<&Defect>) -> Instruments {
    let mut rng = Pcg64::new(u128::from(plan.seed), INSTRUMENT_STREAM);
    // Half of the class is the gain's, as in `Instruments::of_class`; linearity and noise have the rest.
    let half = GAIN_SHARE * plan.instruments.class_percent / 100.0;
    let mut gain_error = || half * (2.0 * rng.random::<f64>() - 1.0);
    let bandwidth_hz = match defect {
        Some(Defect::GyroscopeLag { bandwidth_hz }) => *bandwidth_hz,
        _ => plan.instruments.gyroscope_bandwidth_hz,
    };
    Instruments {
        accelerometer_gain_error: gain_error(),
        gyroscope_gain_error: gain_error(),
        gyroscope_bandwidth_hz: (bandwidth_hz > 0.0).then_some(bandwidth_hz),
        signal_to_noise_db: plan
            .instruments
            .signal_to_noise_db
            .is_finite()
            .then_some(plan.instruments.signal_to_noise_db),
    }
}

fn static_record(plan: &SessionPlan, parameters: &Parameters, defect: Option<&Defect>) -> Played {
    Played {
        entry: Entry {
            file: PathBuf::from("static"),
            role: Role::Static,
            direction: None,
            down: None,
            frequency_hz: None,
            sample_rate_hz: None,
            gain_n_per_v: None,
            reference_file: None,
            reference_start_s: None,
            reference_sample_rate_hz: None,
            channels: None,
        },
        sample_rate_hz: plan.static_rate_hz,
        voltage_v: at_rest(plan, parameters, defect),
        accelerometer_m_s2: Vec::new(),
        gyroscope_rad_s: Vec::new(),
        truth: Vec::new(),
    }
}

fn at_rest(
    plan: &SessionPlan,
    parameters: &Parameters,
    defect: Option<&Defect>,
) -> Vec<[f64; LIMBS]> {
    let converter = chain(plan).converter();
    let mut rng = Pcg64::new(u128::from(plan.seed), STATIC_STREAM);
    let samples = (plan.static_duration_s * plan.static_rate_hz) as usize;
    let mut drift = parameters.zero_drift_v;
    let mut slope = [0.0; LIMBS];
    let mut factor = [1.0; LIMBS];
    match defect {
        Some(Defect::InvertedChannel {
            channel,
            place: Where::Everywhere,
        }) => factor[*channel] = -1.0,
        Some(Defect::SwappedChannels {
            channels: [a, b],
            place: Where::Everywhere,
        }) => drift.swap(*a, *b),
        Some(Defect::MillivoltMixUp {
            channel,
            place: Where::Everywhere,
            factor: f,
        }) => {
            for (limb, own) in factor.iter_mut().enumerate() {
                if channel.is_none_or(|c| c == limb) {
                    *own = *f;
                }
            }
        }
        Some(Defect::DriftDuringRun {
            channel,
            trial: None,
            share,
        }) => slope[*channel] = share * plan.chain.full_scale_v,
        _ => {}
    }
    (0..samples)
        .map(|sample| {
            let share = sample as f64 / samples as f64 - 0.5;
            core::array::from_fn(|limb| {
                factor[limb] * converter.convert(drift[limb] + slope[limb] * share, &mut rng)
            })
        })
        .collect()
}
