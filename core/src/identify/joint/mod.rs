//! All 25 parameters at once by maximum likelihood, with noise, gain and lag in every instrument.
//!
//! The four steps use each trial once, one after the other, and take the standard instruments for the truth. Here
//! - the true motion of every trial is unknown, too: the standard measures it with noise, a gain and a lag, and so do the nine
//!   channels (errors in variables). Least squares with noise in the regressor is biased towards zero; this estimate is not;
//! - every channel is predicted by itself, by the limbs' static load sharing, instead of three sums of nine;
//! - the gyroscope's gain and lag, the amplifiers' time constant and the wedges' misalignment are unknowns beside the 25, with
//!   priors from certificates;
//! - limbs that are not equally stiff, channels that show a little of each other, a centre off the axis, an axis off the plumb line,
//!   zeros and sensitivities that move from trial to trial are unknowns, too, with the spreads of an ordinary [`room`].
//!
//! | file | holds |
//! |---|---|
//! | [`harmonics`] | a record in orthonormal coordinates |
//! | `colour` | noise that is not white |
//! | `ends` | trials that do not end at the angle at which they began |
//! | `motion` | the latent motion and the series that limbs feel |
//! | [`super::static_load_sharing`] | how nine limbs share a load |
//! | [`unknowns`] | what is estimated |
//! | [`room`] | spreads of what nobody states, themselves estimated |
//! | `own` | what one trial has for itself |
//! | `load` | what the motion asks of the limbs, and what the channels show of it |
//! | `trial` | one trial's data and what the model makes of its motion |
//! | `standard` | what the standard shows of it |
//! | `normal` | its part in the normal equations, the motion eliminated |
//! | `solve` | Gauss-Newton over all trials |
//! | `settle` | the spreads at one linearisation |
//! | [`robust`] | the same with wild values cut off |
//! | [`estimate`] | the result |
//!
//! # The likelihood
//! Noise is normal and, in the band of the fit, white, of a variance that each record itself shows above the last harmonic used, and more
//! where all records together show more beside the harmonics (`colour`). The logarithm of the
//! likelihood is then minus half a sum of squares, minimised by Gauss-Newton from the four steps' answer; the inverse of its
//! normal matrix, the latent motions eliminated, is the covariance of the estimate and the Cramer-Rao bound, with what certificates
//! say counted as measurements.
//!
//! # What is unobservable
//! With no gravity turning in the sensor, the standard accelerometer alone sets the scale: its gain error gamma makes every s_i/m
//! and every I/m larger by gamma and changes nothing else. It is therefore not fitted but carried along ([`estimate::JointEstimate::by_accelerometer_gain`]).
//!
//! # What is neglected
//! Relative motion enters linear trials to first order in 1/(k/m) and angular ones not at all: 2e-7 to 7e-7 of a force at 2 Hz.
//! Limbs that tilt add 5e-6 of a force at twice the drive's frequency at 5 Hz.
mod colour;
mod ends;
pub mod estimate;
pub mod harmonics;
mod load;
mod motion;
mod normal;
mod own;
mod record;
pub mod robust;
pub mod room;
mod settle;
mod solve;
mod standard;
mod trial;
pub mod unknowns;

use alloc::vec::Vec;

use nalgebra::DVector;
use serde::Serialize;

pub use self::record::{Prepared, Record};
pub use self::trial::Drive;

use self::estimate::JointEstimate;
use self::room::{Room, Spread, Spreads};
use self::trial::Trial;
use self::unknowns::{
    AMPLIFIER_CORNER, ANGLES, COMPLIANCE, CROSS_TALK, DRIFT, GYROSCOPE_GAIN, GYROSCOPE_LAG,
    INERTIA, MASS_CENTRE, MASS_PER_SCALE, ROD_MASS, STIFFNESS, Unknowns, WEDGES, Wedge, Wedges,
};
use super::static_load_sharing::StaticLoadSharing;
use crate::error::{Error, Result, require_finite, require_not_negative, require_positive};
use crate::geometry::{Geometry, LIMBS};
use crate::model::Parameters;

/// Two unit vectors nearer than this are the same wedge's.
const SAME_WEDGE: f64 = 1e-3;
/// Sine of the angle between gravity and axis below which gravity does not turn in the sensor.
const TURNS: f64 = 1e-6;
/// What a stated tolerance of wedges is worth, in angles, against the wedges' own word.
const WEDGE_WORTH: f64 = 4.0;

/// Spread of the wedges' angles that a fit begins with, rad: far beyond any workshop's.
const FIRST_WEDGES_RAD: f64 = 0.1;

/// A value and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Known {
    /// Best guess.
    pub value: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Known {
    /// An unknown that is held at zero.
    pub(crate) const HELD: Self = Self::about_zero(0.0);

    /// Zero, as far as is known.
    #[must_use]
    pub const fn about_zero(deviation: f64) -> Self {
        Self {
            value: 0.0,
            deviation,
        }
    }
}

/// Priors from certificates, the workshop and other measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificates {
    /// Standard deviation of the gyroscope's gain.
    pub gyroscope_gain_deviation: f64,
    /// First-order lag of the gyroscope, s; none if it follows at once.
    pub gyroscope_lag_s: Option<Known>,
    /// First-order lag of the accelerometer, s, taken as it is.
    pub accelerometer_lag_s: f64,
    /// Pure delays of the accelerometer and the gyroscope, s, taken as they are, beside their lags; negative where more was undone.
    pub standard_delay_s: [f64; 2],
    /// Corner of the charge amplifiers' high-pass, rad/s; none if the channels are tared instead.
    pub amplifier_corner_rad_s: Option<Known>,
    /// Standard deviation of the time by which each channel is behind the standards, s; 0 for channels on their clock.
    pub channel_delay_s: f64,
    /// Standard deviation of each of a wedge's angles, rad; 0 for exact wedges.
    pub wedge_deviation_rad: f64,
    /// Whether trials in one direction stand on one wedge, or each as if it had a wedge of its own.
    pub wedges: Wedges,
    /// 1/(k/m), s^2, from elsewhere: a tap on the shell.
    pub compliance_s2: Option<Known>,
    /// What nobody states.
    pub room: Room,
}

/// Zero drifts from a record at rest, V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest {
    /// Means.
    pub drift_v: [f64; LIMBS],
    /// Their standard deviations.
    pub deviation_v: [f64; LIMBS],
}

/// Collects a campaign's trials.
#[derive(Debug, Clone)]
pub struct Joint {
    shares: StaticLoadSharing,
    certificates: Certificates,
    at_rest: AtRest,
    wedges: Vec<Wedge>,
    trials: Vec<Trial>,
}

/// Name of the estimator in errors.
const WHAT: &str = "the estimate from all trials";

impl Joint {
    /// Starts a campaign.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for lengths, deviations or drifts that mean nothing.
    pub fn new(geometry: &Geometry, certificates: Certificates, at_rest: AtRest) -> Result<Self> {
        require_positive(
            "gyroscope_gain_deviation",
            certificates.gyroscope_gain_deviation,
        )?;
        for (name, known) in [
            ("gyroscope_lag_s", certificates.gyroscope_lag_s),
            (
                "amplifier_corner_rad_s",
                certificates.amplifier_corner_rad_s,
            ),
            ("compliance_s2", certificates.compliance_s2),
        ] {
            if let Some(known) = known {
                require_positive(name, known.value)?;
                require_positive(name, known.deviation)?;
            }
        }
        for (name, value) in [
            ("wedge_deviation_rad", certificates.wedge_deviation_rad),
            ("accelerometer_lag_s", certificates.accelerometer_lag_s),
            ("channel_delay_s", certificates.channel_delay_s),
            ("room.stiffness", certificates.room.stiffness.usual),
            (
                "room.cross_talk_beside",
                certificates.room.cross_talk_beside.usual,
            ),
            (
                "room.cross_talk_apart",
                certificates.room.cross_talk_apart.usual,
            ),
            ("room.sensitivity", certificates.room.sensitivity.usual),
            ("room.zero_v", certificates.room.zero_v),
            ("room.centre_m", certificates.room.centre_m),
            ("room.mass_centre_m", certificates.room.mass_centre_m),
            ("room.rod_mass", certificates.room.rod_mass),
            ("room.plumb_rad", certificates.room.plumb_rad),
        ] {
            require_not_negative(name, value)?;
        }
        for delay_s in certificates.standard_delay_s {
            require_finite("standard_delay_s", delay_s)?;
        }
        let room = &certificates.room;
        for spread in [
            room.stiffness,
            room.cross_talk_beside,
            room.cross_talk_apart,
            room.sensitivity,
        ] {
            // What no trial determines is then the usual one.
            if spread.usual > 0.0 {
                require_positive("worth of a room's spread", spread.worth)?;
            }
        }
        for limb in 0..LIMBS {
            require_positive("zero drift's deviation", at_rest.deviation_v[limb])?;
            if !at_rest.drift_v[limb].is_finite() {
                return Err(Error::NotFinite {
                    channel: limb + 1,
                    sample: 0,
                    value: at_rest.drift_v[limb],
                });
            }
        }
        Ok(Self {
            shares: StaticLoadSharing::new(geometry)?,
            certificates,
            at_rest,
            wedges: Vec::new(),
            trials: Vec::new(),
        })
    }

    /// Projects a trial on its harmonics, which is most of the work and may be done for several trials at once.
    ///
    /// # Errors
    /// [`Error::NotFinite`] (channel 10 is the standard), [`Error::LengthMismatch`], [`Error::TooFewSamples`] for a record that
    /// leaves nothing above its last harmonic to tell the noise from, [`Error::DeadChannel`] for one of zeros, [`Error::NotClosed`] for one that does not end where it
    /// began, [`Error::OutOfRange`] for a frequency, a gain or a
    /// direction that means nothing.
    pub fn prepare(&self, record: &Record) -> Result<Prepared> {
        record.prepare(&self.certificates)
    }

    /// Adds a projected trial.
    pub fn add(&mut self, prepared: Prepared) {
        let Prepared { nominal, mut trial } = prepared;
        let is_shared = self.certificates.wedges == Wedges::Shared;
        trial.wedge = self
            .wedges
            .iter()
            .position(|w| is_shared && (w.nominal - nominal).length() < SAME_WEDGE)
            .unwrap_or_else(|| {
                self.wedges.push(Wedge::new(nominal));
                self.wedges.len() - 1
            });
        self.trials.push(trial);
    }

    /// Number of trials so far.
    #[must_use]
    pub fn trials(&self) -> usize {
        self.trials.len()
    }

    /// Fits everything, starting from the given parameters.
    ///
    /// # Errors
    /// [`Error::Indeterminate`] names an unknown that the trials leave open; [`Error::NotConverged`]; [`Error::Unaccounted`]; the errors of
    /// [`Parameters::validate`] for a start that is no sensor's.
    pub fn fit(&self, start: &Parameters) -> Result<JointEstimate> {
        Ok(self.fit_trials(start)?.0)
    }

    /// The fit, and the trials with their motions as it has them.
    fn fit_trials(&self, start: &Parameters) -> Result<(JointEstimate, Vec<Trial>)> {
        start.validate()?;
        let mut values = DVector::zeros(self.delays().end);
        for limb in 0..LIMBS {
            values[DRIFT + limb] = self.at_rest.drift_v[limb];
            values[MASS_PER_SCALE + limb] = 1.0 / start.scale_per_mass_per_kg[limb];
        }
        for (j, i) in start
            .inertia_per_mass
            .to_paper_order()
            .into_iter()
            .enumerate()
        {
            values[INERTIA + j] = i;
        }
        values[COMPLIANCE] = 1.0 / start.stiffness_per_mass_per_s2;
        let c = &self.certificates;
        values[GYROSCOPE_LAG] = c.gyroscope_lag_s.map_or(0.0, |k| k.value);
        values[AMPLIFIER_CORNER] = c.amplifier_corner_rad_s.map_or(0.0, |k| k.value);
        let unknowns = Unknowns {
            values,
            wedges: self.wedges.clone(),
        };
        solve::fit(self, unknowns)
    }

    fn wedge_angles(&self) -> core::ops::Range<usize> {
        WEDGES..WEDGES + ANGLES * self.wedges.len()
    }

    /// Places of the channels' delays; empty where these are not free.
    fn delays(&self) -> core::ops::Range<usize> {
        let first = self.wedge_angles().end;
        let free = self.certificates.channel_delay_s > 0.0;
        first..first + if free { LIMBS } else { 0 }
    }

    /// Spread of each of a wedge's angles, rad.
    fn wedge_spread(&self) -> Spread {
        Spread {
            usual: self.certificates.wedge_deviation_rad,
            worth: WEDGE_WORTH,
        }
    }

    /// Spreads before any trial has said anything. Wedges come first: a sensor turned on its flange looks to limbs like cross-talk,
    /// and 72 shares held too loosely would take it up before twelve angles held too tightly have moved.
    fn first_spreads(&self) -> Spreads {
        let room = &self.certificates.room;
        let usual_rad = self.wedge_spread().usual;
        Spreads {
            stiffness: room.stiffness.usual,
            cross_talk_beside: room.cross_talk_beside.usual,
            // From where it may come down: a spread that begins next to nothing takes long to grow.
            cross_talk_apart: match room.cross_talk_apart.usual {
                0.0 => 0.0,
                usual => usual.max(room.cross_talk_beside.usual),
            },
            sensitivity: room.sensitivity.usual,
            wedge_rad: if usual_rad > 0.0 {
                usual_rad.max(FIRST_WEDGES_RAD)
            } else {
                0.0
            },
        }
    }

    /// Measurements of single unknowns; an unknown with deviation 0 is not free.
    fn priors(&self, spreads: &Spreads) -> Vec<(usize, Known)> {
        let c = &self.certificates;
        let mut priors: Vec<(usize, Known)> = (0..LIMBS)
            .map(|limb| {
                let known = Known {
                    value: self.at_rest.drift_v[limb],
                    deviation: self.at_rest.deviation_v[limb],
                };
                (DRIFT + limb, known)
            })
            .collect();
        let gyroscope_gain = Known::about_zero(c.gyroscope_gain_deviation);
        let or_held = |known: Option<Known>| known.unwrap_or(Known::HELD);
        priors.push((GYROSCOPE_GAIN, gyroscope_gain));
        priors.push((GYROSCOPE_LAG, or_held(c.gyroscope_lag_s)));
        priors.push((AMPLIFIER_CORNER, or_held(c.amplifier_corner_rad_s)));
        priors.extend(c.compliance_s2.map(|known| (COMPLIANCE, known)));
        for (range, deviation) in [
            (MASS_CENTRE..ROD_MASS, c.room.mass_centre_m),
            (ROD_MASS..STIFFNESS, c.room.rod_mass),
            (STIFFNESS..CROSS_TALK, spreads.stiffness),
            (self.wedge_angles(), spreads.wedge_rad),
            (self.delays(), c.channel_delay_s),
        ] {
            let known = Known::about_zero(deviation);
            priors.extend(range.map(|unknown| (unknown, known)));
        }
        for (beside, deviation) in [
            (true, spreads.cross_talk_beside),
            (false, spreads.cross_talk_apart),
        ] {
            let known = Known::about_zero(deviation);
            priors.extend(Unknowns::shares_of(beside).map(|unknown| (unknown, known)));
        }
        priors
    }
}
