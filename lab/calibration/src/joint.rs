//! The joint estimator on a session's trials: what the session file says, handed to the mathematics, and its answer with
//! intervals.
//!
//! | file | holds |
//! |---|---|
//! | [`account`] | whether the fit accounts for the session, and what is out of the ordinary |
//! | [`hypotheses`] | what accounts for the trials where it does not |
//! | [`limbs`] | limbs and channels as a calibration keeps them |
//! | [`misfit`] | what to make of channels that contradict the model |
//! | [`nuisances`] | what the instruments and wedges turned out to be |
//! | [`reports`] | the 25 in the form that the four steps report them in |

pub mod account;
pub mod hypotheses;
mod limbs;
pub mod misfit;
pub mod nuisances;
pub mod reports;
mod sensitivities;

use misfit::Misfit;
use nalgebra::SMatrix;
use rayon::prelude::*;
use sixaxis_core::identify::joint::estimate::JointEstimate;
use sixaxis_core::identify::joint::robust::USUAL_LIMIT;
use sixaxis_core::identify::joint::room::Room;
use sixaxis_core::identify::joint::{AtRest, Certificates, Drive, Joint, Known, Record};
use sixaxis_core::identify::zero_drift::ZeroDrift;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{Geometry, LIMBS, Parameters};

use crate::error::{Error, Result};
use crate::gain_prior::BoundedGain;
use crate::steps::{Campaign, FourSteps};
use crate::tap::Taps;
use crate::trial::Trial;
use sixaxis_recordings::session::{Role, Session};

/// Standard deviation of a wedge's angles where the session does not say, degrees: a workshop's.
pub const WEDGE_DEG: f64 = 0.1;
/// Relative standard deviation of a stated bandwidth or time constant: what a data sheet's typical value means.
const TIME_CONSTANT: f64 = 0.1;
/// Standard deviation of a zero drift from a record without noise, V: below every converter, above every underflow.
const LEAST_DRIFT_V: f64 = 1e-12;
/// 1/(k/m) whose standard deviation is below this share of it is known; what is below a tenth is a measurement.
const COMPLIANCE_KNOWN: f64 = 0.1;

/// Rows and columns of the 25.
type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;
/// Those of the scale factors.
const SCALES: core::ops::Range<usize> = LIMBS..2 * LIMBS;

/// How a residual counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// By its square: best where noise is normal.
    #[default]
    Squares,
    /// Huber's, cut off at [`USUAL_LIMIT`] deviations: wild samples cannot bend the fit. It takes several fits' time.
    Huber,
}

/// What the session says before the trials do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knowledge {
    /// Largest relative gain error of the accelerometer.
    pub accelerometer_gain_limit: f64,
    /// The mathematics' part.
    pub certificates: Certificates,
}

impl Knowledge {
    /// What a session file says.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let share = |percent: f64| percent / 100.0;
        let accelerometer = &session.accelerometer;
        let gyroscope = &session.gyroscope;
        let first_order = |hz: f64| 1.0 / (core::f64::consts::TAU * hz);
        let known = |value: f64| Known {
            value,
            deviation: TIME_CONSTANT * value,
        };
        let wedge_deg = session
            .rig
            .as_ref()
            .and_then(|rig| rig.wedge_deg)
            .unwrap_or(WEDGE_DEG);
        Self {
            accelerometer_gain_limit: share(
                accelerometer
                    .gain_percent
                    .unwrap_or(accelerometer.class_percent),
            ),
            certificates: Certificates {
                // The standard deviation of an even spread; the trials know this gain far better as a rule.
                gyroscope_gain_deviation: share(
                    gyroscope.gain_percent.unwrap_or(gyroscope.class_percent),
                ) / 3.0_f64.sqrt(),
                gyroscope_lag_s: gyroscope.bandwidth_hz.map(|hz| known(first_order(hz))),
                accelerometer_lag_s: accelerometer.bandwidth_hz.map_or(0.0, first_order),
                amplifier_corner_rad_s: session
                    .preprocessing
                    .amplifier_high_pass_hz
                    .map(|hz| known(core::f64::consts::TAU * hz)),
                channel_delay_s: 0.0,
                wedge_deviation_rad: wedge_deg.to_radians(),
                compliance_s2: None,
                room: Room::ORDINARY,
            },
        }
    }
}

impl Knowledge {
    /// Takes k/m from taps, if they determine it. They were evaluated with steps 2 and 3, whose errors they share with the
    /// trials; of k/m that is a small part, and the trials say next to nothing of k/m themselves.
    pub fn take_taps(&mut self, taps: &Taps) {
        self.certificates.compliance_s2 = taps.stiffness.as_ref().map(|found| {
            let compliance = 1.0 / found.per_mass_per_s2;
            Known {
                value: compliance,
                deviation: found.half_width_95 / NORMAL_95 * compliance * compliance,
            }
        });
    }
}

/// The joint estimate of the 25 with intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct JointReport {
    /// The fit.
    pub estimate: JointEstimate,
    /// Names of its trials' recordings, in order.
    pub recordings: Vec<String>,
    /// What is known of the accelerometer's gain.
    pub gain: BoundedGain,
    /// The 25: d, V; s/m, 1/kg; I/m, m^2; 1/(k/m), s^2.
    pub values: [f64; PARAMETERS],
    /// Their standard deviations, the accelerometer's gain included.
    pub deviations: [f64; PARAMETERS],
    /// Ends of their 95 % intervals.
    pub intervals_95: [(f64, f64); PARAMETERS],
    /// Whether 1/(k/m) is determined.
    pub compliance_is_determined: bool,
    /// Whether the channels agree with the model; where not, all of the above is that much wider.
    pub misfit: Misfit,
}

impl JointReport {
    /// What the fit to these recordings comes to.
    #[must_use]
    pub fn new(
        estimate: JointEstimate,
        recordings: Vec<String>,
        accelerometer_gain_limit: f64,
    ) -> Self {
        let misfit = Misfit::of(&estimate);
        let wider = misfit.wider();
        let gain = BoundedGain {
            limit: accelerometer_gain_limit,
            seen: estimate.accelerometer_gain_seen,
            information: estimate.accelerometer_gain_information / (wider * wider),
        };
        let slopes = estimate.slopes();
        let covariance = with_moved(&estimate, noise_covariance(&estimate, wider));
        let noise: [f64; PARAMETERS] = core::array::from_fn(|p| covariance[(p, p)].max(0.0).sqrt());
        let (mean, spread) = (gain.mean(), gain.deviation());
        let compliance = estimate.compliance_s2().0;
        Self {
            values: estimate.values(mean),
            deviations: core::array::from_fn(|p| noise[p].hypot(spread * slopes[p])),
            intervals_95: gain.intervals_95(|gain| estimate.values(gain), &noise),
            compliance_is_determined: compliance > 0.0
                && noise[PARAMETERS - 1] < COMPLIANCE_KNOWN * compliance,
            gain,
            misfit,
            estimate,
            recordings,
        }
    }

    /// Covariance of the 25 without the accelerometer's gain: noise, and whatever the channels disagree by.
    #[must_use]
    pub fn noise_covariance(&self) -> Square {
        noise_covariance(&self.estimate, self.misfit.wider())
    }

    /// What parameter `p`, from 0, is off before or after the trials, a standard deviation: of a scale factor how far its sensitivity has moved.
    #[must_use]
    pub fn moved(&self, p: usize) -> f64 {
        moved(&self.estimate, p)
    }

    /// Covariance of the 25 without the accelerometer's gain for a recording of another time, with what sensitivities and zeros are off there.
    #[must_use]
    pub fn covariance_of_next_recording(&self) -> Square {
        let mut all = with_moved(&self.estimate, self.noise_covariance());
        for limb in 0..LIMBS {
            let zeros = self.estimate.trials.iter().map(|trial| trial.zero_v[limb]);
            all[(limb, limb)] += spread(zeros).powi(2);
        }
        all
    }

    /// Covariance of the 25 that the accelerometer's gain alone gives.
    #[must_use]
    pub fn gain_covariance(&self) -> Square {
        let (slopes, spread) = (self.estimate.slopes(), self.gain.deviation());
        SMatrix::from_fn(|a, b| slopes[a] * slopes[b] * spread * spread)
    }

    /// To decouple with: where 1/(k/m) is open, with the given k/m, 1/s^2.
    #[must_use]
    pub fn parameters(&self, otherwise_per_s2: f64) -> Parameters {
        let (compliance, _) = self.estimate.compliance_s2();
        let stiffness = if self.compliance_is_determined {
            1.0 / compliance
        } else {
            otherwise_per_s2
        };
        self.estimate.parameters(self.gain.mean(), stiffness)
    }
}

/// Factors on the fit's own deviations. A compliance that was given is not the trials' to spoil.
fn widths(estimate: &JointEstimate, wider: f64) -> [f64; PARAMETERS] {
    let mut widths = [wider; PARAMETERS];
    if estimate.compliance_from_elsewhere {
        widths[PARAMETERS - 1] = 1.0;
    }
    widths
}

/// Covariance of the 25 with the accelerometer's gain held, that much wider.
fn noise_covariance(estimate: &JointEstimate, wider: f64) -> Square {
    let widths = widths(estimate, wider);
    let own = estimate.parameter_covariance();
    Square::from_fn(|a, b| widths[a] * widths[b] * own[(a, b)])
}

/// See [`JointReport::moved`]. In the place of a scale factor stands its reciprocal.
fn moved(estimate: &JointEstimate, p: usize) -> f64 {
    if SCALES.contains(&p) {
        estimate.spreads.next_sensitivity() / estimate.unknowns.values[p]
    } else {
        0.0
    }
}

/// A covariance with how far sensitivities have moved.
fn with_moved(estimate: &JointEstimate, mut covariance: Square) -> Square {
    for p in SCALES {
        covariance[(p, p)] += moved(estimate, p).powi(2);
    }
    covariance
}

/// Spread about zero of what is known with errors of its own.
fn spread(of: impl Iterator<Item = Known>) -> f64 {
    let (sum, count) = of.fold((0.0, 0.0), |(sum, count), known| {
        let square = known.value * known.value - known.deviation * known.deviation;
        (sum + square, count + 1.0)
    });
    if count > 0.0 {
        f64::max(sum / count, 0.0).sqrt()
    } else {
        0.0
    }
}

/// What a static record says of the drift.
#[must_use]
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
#[must_use]
pub fn record(trial: &Trial) -> Option<Record<'_>> {
    let (drive, standard) = match trial.role {
        Role::Linear | Role::HighFrequencyLinear => (Drive::Linear, &trial.accelerometer_m_s2),
        Role::Angular => (Drive::Angular, &trial.gyroscope_rad_s),
        Role::Static | Role::Tap | Role::Validation => return None,
    };
    Some(Record {
        drive,
        sample_rate_hz: trial.sample_rate_hz,
        frequency_hz: trial.frequency_hz,
        gains: &trial.gains,
        voltage_v: &trial.voltage_v,
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
    fit_trials(
        &campaign.geometry,
        &trials,
        &at_rest(&steps.drift),
        &start(campaign, steps),
        knowledge,
        loss,
    )
}

/// Trials that do not end where they began, which no fit takes, and by how many of its largest steps each one's standard jumps.
#[must_use]
pub fn not_closed(
    campaign: &Campaign,
    steps: &FourSteps,
    knowledge: &Knowledge,
) -> Vec<(String, f64)> {
    let at_rest = at_rest(&steps.drift);
    let Ok(joint) = Joint::new(&campaign.geometry, knowledge.certificates, at_rest) else {
        return Vec::new();
    };
    let all = campaign.trials.par_iter();
    all.filter_map(|(trial, _)| match joint.prepare(&record(trial)?).err()? {
        sixaxis_core::Error::NotClosed { jump_over_step, .. } => {
            Some((trial.name.clone(), jump_over_step))
        }
        _ => None,
    })
    .collect()
}

/// Where a fit starts: from the four steps' answer, with the design's k/m where theirs is none.
#[must_use]
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
    let estimate = match loss {
        Loss::Squares => joint.fit(start),
        Loss::Huber => {
            let records: Vec<Record> = records.iter().map(|(_, record)| *record).collect();
            joint.fit_robust(start, &records, USUAL_LIMIT)
        }
    }
    .map_err(refuse)?;
    let recordings = records.iter().map(|(name, _)| (*name).to_owned()).collect();
    Ok(JointReport::new(
        estimate,
        recordings,
        knowledge.accelerometer_gain_limit,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_no_spread() {
        let known = |value: f64, deviation: f64| Known { value, deviation };
        assert_eq!(spread([known(1.0, 1.0), known(-1.0, 1.0)].into_iter()), 0.0);
        assert_eq!(spread([known(3.0, 0.0), known(-3.0, 0.0)].into_iter()), 3.0);
        assert_eq!(spread(core::iter::empty()), 0.0);
    }
}
