//! The joint estimator on a session's trials: what the session file says, handed to the mathematics, and its answer with
//! intervals.
//!
//! | file | holds |
//! |---|---|
//! | [`account`] | whether the fit accounts for the session, and what is out of the ordinary |
//! | [`hypotheses`] | what accounts for the trials where it does not |
//! | `knowledge` | what the fit knows before it sees the trials |
//! | `mass_centre` | a mass whose centre is not the cube's, and looks like cross-talk |
//! | `limbs` | limbs and channels as a calibration keeps them |
//! | [`misfit`] | what to make of channels that contradict the model |
//! | [`nuisances`] | what the instruments and wedges turned out to be |
//! | [`parameter_reports`] | the 25 in the form that the four steps report them in |
//! | `report` | what the fit comes to, with intervals and covariances |
//! | `rod_mass` | limbs that have mass |
//! | `sensitivities` | what the fit says of the channels' sensitivities |

pub mod account;
pub mod hypotheses;
mod knowledge;
mod limbs;
mod mass_centre;
pub mod misfit;
pub mod nuisances;
pub mod parameter_reports;
mod report;
mod rod_mass;
mod sensitivities;

pub use knowledge::{Knowledge, WEDGE_DEG};
pub use report::JointReport;

use rayon::prelude::*;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::identify::joint::estimate::JointEstimate;
use sixaxis_core::identify::joint::robust::USUAL_LIMIT;
use sixaxis_core::identify::joint::{AtRest, Drive, Joint, Record};
use sixaxis_core::identify::zero_drift::ZeroDrift;
use sixaxis_core::{Geometry, Parameters};

use crate::error::{Error, Result};
use crate::steps::{Campaign, FourSteps};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Standard deviation of a zero drift from a record without noise, V: below every converter, above every underflow.
const LEAST_DRIFT_V: f64 = 1e-12;

/// How a residual counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// By its square: best where noise is normal.
    #[default]
    Squares,
    /// Huber's, cut off at [`USUAL_LIMIT`] deviations: wild samples cannot bend the fit. It takes several fits' time.
    Huber,
}

/// What a static record says of the drift.
pub fn at_rest(drift: &ZeroDrift) -> AtRest {
    AtRest {
        drift_v: drift.drift_v,
        deviation_v: core::array::from_fn(|i| {
            let least = f64::EPSILON * drift.drift_v[i].abs();
            drift.standard_error_v[i].max(least).max(LEAST_DRIFT_V)
        }),
    }
}

/// A trial as the joint fit takes it; none for one that it has no use for.
pub fn record(trial: &Trial) -> Option<Record<'_>> {
    let (drive, standard) = match trial.role {
        Role::Linear | Role::HighFrequencyLinear => (Drive::Linear, &trial.accelerometer_m_s2),
        Role::Angular => (Drive::Angular, &trial.gyroscope_rad_s),
        Role::Static | Role::Tap | Role::Validation => return None,
    };
    // What the recorder took before and after the motion tells nothing of it, and costs time.
    let moving = rest_to_rest::motion(&trial.voltage_v, trial.sample_rate_hz);
    let standard = standard.get(moving.clone())?;
    Some(Record {
        drive,
        sample_rate_hz: trial.sample_rate_hz,
        frequency_hz: trial.frequency_hz,
        gains: &trial.gains,
        voltage_v: &trial.voltage_v[moving],
        standard,
        limbs_band_hz: trial.limbs_band_hz,
        standard_band_hz: trial.standards_band_hz,
        direction_ground: trial.direction_ground,
        gravity_ground_m_s2: trial.gravity_ground_m_s2,
    })
}

/// Fits all linear and angular trials of a campaign at once, starting from the four steps' answer. The recordings are taken as
/// they were read, nothing filtered and no sample mended: wild ones are the loss' matter.
///
/// # Errors
/// [`Error::Trial`] names the recording that cannot be used, [`Error::Step`] what the fit refuses.
pub fn fit(
    campaign: &Campaign,
    steps: &FourSteps,
    knowledge: &Knowledge,
    loss: Loss,
) -> Result<JointReport> {
    let trials: Vec<&Trial> = campaign.trials.iter().map(|(trial, _)| trial).collect();
    let (rest, start) = (at_rest(&steps.drift), start(campaign, steps));
    let fitted = |knowledge: &Knowledge| {
        fit_trials(&campaign.geometry, &trials, &rest, &start, knowledge, loss)
    };
    let held = fitted(knowledge);
    if held.as_ref().is_ok_and(JointReport::accounts) {
        return held;
    }
    // Limbs with mass, and a mass far off the middle, look like more cross-talk than a fit finds its way through.
    let accounting = |free: Knowledge| fitted(&free).ok().filter(JointReport::accounts);
    let free = match accounting(knowledge.with_heavy_limbs()) {
        Some(heavy) if rod_mass::is_told(&heavy.estimate) => Some(heavy),
        Some(_) if held.is_err() => accounting(knowledge.with_free_mass()),
        _ => None,
    };
    free.map_or(held, Ok)
}

/// Where a fit starts: from the four steps' answer, with the design's k/m where theirs is none.
pub fn start(campaign: &Campaign, steps: &FourSteps) -> Parameters {
    let mut start = steps.used();
    if start.validate().is_err() {
        start.stiffness_per_mass_per_s2 = campaign.design.stiffness_per_mass_per_s2;
    }
    start
}

/// The same of these trials, of a sensor with these lengths and this static record, from any start.
///
/// # Errors
/// Those of [`fit`].
pub(crate) fn fit_trials(
    geometry: &Geometry,
    trials: &[&Trial],
    at_rest: &AtRest,
    start: &Parameters,
    knowledge: &Knowledge,
    loss: Loss,
) -> Result<JointReport> {
    let refuse = |source| Error::Step {
        step: "joint estimator",
        source: Box::new(source),
    };
    let mut joint = Joint::new(geometry, knowledge.certificates, *at_rest).map_err(refuse)?;
    let records: Vec<(&str, Record)> = trials
        .iter()
        .filter_map(|trial| Some((trial.name.as_str(), record(trial)?)))
        .collect();
    // Side by side, added in their own order.
    let prepared: Vec<_> = records
        .par_iter()
        .map(|(name, record)| {
            joint.prepare(record).map_err(|source| Error::Trial {
                file: (*name).to_owned(),
                source: Box::new(source),
            })
        })
        .collect::<Result<_>>()?;
    for trial in prepared {
        joint.add(trial);
    }
    let fitted = |joint: &Joint| {
        match loss {
            Loss::Squares => joint.fit(start),
            Loss::Huber => {
                let records: Vec<Record> = records.iter().map(|(_, record)| *record).collect();
                joint.fit_robust(start, &records, USUAL_LIMIT)
            }
        }
        .map_err(refuse)
    };
    let mut estimate = fitted(&joint)?;
    if knowledge.certificates.room.mass_centre_m == 0.0 && mass_centre::may_be(geometry, &estimate)
    {
        joint
            .free_mass_centre(mass_centre::DEVIATION_M)
            .map_err(refuse)?;
        let free = fitted(&joint).ok();
        if let Some(free) = free.filter(|free| mass_centre::is_it(&estimate, free)) {
            estimate = free;
        }
    }
    if knowledge.certificates.room.rod_mass == 0.0 && rod_mass::may_be(&estimate) {
        joint
            .free_mass_centre(mass_centre::DEVIATION_M)
            .and_then(|()| joint.free_rod_mass(rod_mass::DEVIATION))
            .map_err(refuse)?;
        let heavy = fitted(&joint).ok();
        let is_it = |heavy: &JointEstimate| {
            mass_centre::is_it(&estimate, heavy) && rod_mass::is_told(heavy)
        };
        if let Some(heavy) = heavy.filter(is_it) {
            estimate = heavy;
        }
    }
    let recordings = records.iter().map(|(name, _)| (*name).to_owned()).collect();
    Ok(JointReport::new(
        estimate,
        recordings,
        knowledge.accelerometer_gain_limit,
        knowledge.gravity_deviation,
    ))
}
