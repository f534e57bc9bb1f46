//! All 25 parameters at once, by maximum likelihood, with everything that was measured taken as measured.
//!
//! The four steps use each trial once, one after the other, and take the standard instruments for the truth. Here
//! - the true motion of every trial is unknown, too: the standard shows it with noise, a gain and a lag, and so do the nine
//!   channels (errors in variables). A regressor with noise in it makes least squares too small; this does not;
//! - every channel is predicted by itself, with equal stiffness saying how limbs share a load, instead of three sums of nine;
//! - the gyroscope's gain and lag, the amplifiers' time constant and the wedges' misalignment are unknowns beside the 25, with
//!   what certificates say of them as further measurements.
//!
//! | file | holds |
//! |---|---|
//! | [`harmonics`] | a record in orthonormal coordinates |
//! | `motion` | the latent motion and the series that limbs feel |
//! | [`shares`] | how nine limbs share a load |
//! | [`unknowns`] | what is estimated |
//! | `trial` | one trial's data and what the model makes of its motion |
//! | `normal` | its part in the normal equations, the motion eliminated |
//! | `solve` | Gauss-Newton over all trials |
//! | [`robust`] | the same with wild values cut off |
//! | [`estimate`] | the result |
//!
//! # The likelihood
//! Noise is white and normal, of a variance that each record itself shows above the last harmonic used. The logarithm of the
//! likelihood is then minus half a sum of squares, minimised by Gauss-Newton from the four steps' answer; the inverse of its
//! normal matrix, the latent motions eliminated, is the covariance of the estimate and the Cramer-Rao bound, with what certificates
//! say counted as measurements.
//!
//! # What the data cannot say
//! With no gravity turning in the sensor nothing but the accelerometer knows what a metre per second squared is: a gain error
//! gamma of it makes every s_i/m and every I/m larger by gamma, and no other change. It is therefore not fitted but carried
//! along ([`estimate::JointEstimate::by_accelerometer_gain`]).
//!
//! # What is neglected
//! Relative motion enters linear trials to first order in 1/(k/m) and angular ones not at all: 2e-7 of a force at 2 Hz.
//! Limbs that tilt add 5e-6 of a force at twice the drive's frequency at 5 Hz.
//!
//! Of the rig two things are taken as they are said to be, and are worth more: that an upright axis is plumb, of which a tenth of a
//! degree turns 0.02 m/s^2 of gravity in the sensor, and that the mass's centre lies on the axis, of which a millimetre is 0.1
//! m/s^2 at 2 Hz. Either shows in [`estimate::JointEstimate::misfit`].

pub mod estimate;
pub mod harmonics;
mod motion;
mod normal;
pub mod robust;
pub mod shares;
mod solve;
mod trial;
pub mod unknowns;

use alloc::vec::Vec;

use glam::DVec3;
use nalgebra::DVector;

pub use self::trial::Drive;

use self::estimate::JointEstimate;
use self::harmonics::{Grid, project};
use self::shares::Shares;
use self::trial::Trial;
use self::unknowns::{
    AMPLIFIER_CORNER, ANGLES, COMPLIANCE, DRIFT, GYROSCOPE_GAIN, GYROSCOPE_LAG, INERTIA,
    MASS_PER_SCALE, Unknowns, WEDGES, Wedge,
};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, LIMBS};
use crate::parameters::Parameters;
use crate::signal::Gains;

/// Last harmonic over the drive's frequency: the run-up of the crank and the squares of the rate lie below.
const HARMONICS_PER_DRIVE: f64 = 8.0;
/// Coordinates above the last harmonic that the noise is told from, at least.
const FEWEST_FOR_NOISE: usize = 64;
/// Smallest standard deviation of noise over a record's largest value: beyond what rounding leaves of one without noise.
const LEAST_NOISE: f64 = 1e-10;
/// Jump from a record's end to its beginning over its largest step.
const LARGEST_JUMP: f64 = 3.0;
/// Two unit vectors nearer than this are the same wedge's.
const SAME_WEDGE: f64 = 1e-3;
/// Sine of the angle between gravity and axis below which gravity does not turn in the sensor.
const TURNS: f64 = 1e-6;

/// A value and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Best guess.
    pub value: f64,
    /// Standard deviation.
    pub deviation: f64,
}

/// What is known before the trials, from certificates, workshop and other measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificates {
    /// Standard deviation of the gyroscope's gain.
    pub gyroscope_gain_deviation: f64,
    /// First-order lag of the gyroscope, s; none if it follows at once.
    pub gyroscope_lag_s: Option<Known>,
    /// First-order lag of the accelerometer, s, taken as it is.
    pub accelerometer_lag_s: f64,
    /// Corner of the charge amplifiers' high-pass, rad/s; none if the channels are tared instead.
    pub amplifier_corner_rad_s: Option<Known>,
    /// Standard deviation of each of a wedge's angles, rad; 0 for wedges that are right.
    pub wedge_deviation_rad: f64,
    /// 1/(k/m), s^2, from elsewhere: a tap on the shell.
    pub compliance_s2: Option<Known>,
}

/// One trial as it was recorded; nothing filtered. It begins and ends at rest in the same place or, if gravity does not turn in it,
/// holds whole turns of the drive.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// What the rig did.
    pub drive: Drive,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// c_i in use.
    pub gains: &'a Gains,
    /// Nine voltages per sample, V.
    pub voltage_v: &'a [[f64; LIMBS]],
    /// Accelerometer along the travel, m/s^2, or gyroscope about the axis, rad/s.
    pub standard: &'a [f64],
    /// Unit vector of travel and axis in the sensor's axes at rest.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
}

/// Zero drifts from a record at rest, V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest {
    /// Means.
    pub drift_v: [f64; LIMBS],
    /// Their standard deviations.
    pub deviation_v: [f64; LIMBS],
}

/// A trial in orthonormal coordinates, on no wedge yet.
#[derive(Debug, Clone)]
pub struct Prepared {
    nominal: DVec3,
    trial: Trial,
}

/// Refuses a record that does not close: from its last sample to its first it may step as from any other to the next, with the
/// noise of two samples more.
fn check_closed(standard: &[f64]) -> Result<()> {
    let steps = standard.windows(2).map(|w| (w[1] - w[0]).abs());
    let largest = steps.fold(f64::MIN_POSITIVE, f64::max);
    let (Some(first), Some(last)) = (standard.first(), standard.last()) else {
        return Ok(());
    };
    let jump_over_step = (last - first).abs() / largest;
    if jump_over_step <= LARGEST_JUMP {
        Ok(())
    } else {
        Err(Error::NotClosed {
            what: WHAT,
            jump_over_step,
        })
    }
}

/// Collects a campaign's trials.
#[derive(Debug, Clone)]
pub struct Joint {
    shares: Shares,
    certificates: Certificates,
    at_rest: AtRest,
    wedges: Vec<Wedge>,
    trials: Vec<Trial>,
}

/// Name of the estimator in errors.
const WHAT: &str = "joint estimator";

impl Joint {
    /// Starts a campaign.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for lengths, deviations or drifts that mean nothing.
    pub fn new(geometry: &Geometry, certificates: Certificates, at_rest: AtRest) -> Result<Self> {
        let positive = |name, value: f64| {
            (value > 0.0 && value.is_finite())
                .then_some(())
                .ok_or(Error::OutOfRange {
                    name,
                    value,
                    requirement: "positive and finite",
                })
        };
        positive(
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
                positive(name, known.value)?;
                positive(name, known.deviation)?;
            }
        }
        for (name, value) in [
            ("wedge_deviation_rad", certificates.wedge_deviation_rad),
            ("accelerometer_lag_s", certificates.accelerometer_lag_s),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::OutOfRange {
                    name,
                    value,
                    requirement: "finite and not negative",
                });
            }
        }
        for limb in 0..LIMBS {
            positive("zero drift's deviation", at_rest.deviation_v[limb])?;
            if !at_rest.drift_v[limb].is_finite() {
                return Err(Error::NotFinite {
                    channel: limb + 1,
                    sample: 0,
                    value: at_rest.drift_v[limb],
                });
            }
        }
        Ok(Self {
            shares: Shares::new(geometry)?,
            certificates,
            at_rest,
            wedges: Vec::new(),
            trials: Vec::new(),
        })
    }

    /// Adds a trial.
    ///
    /// # Errors
    /// [`Error::NotFinite`] (channel 10 is the standard), [`Error::LengthMismatch`], [`Error::TooFewSamples`] for a record that
    /// leaves nothing above its last harmonic to tell the noise from, [`Error::DeadChannel`] for one of zeros, [`Error::NotClosed`] for one that does not end where it
    /// began, [`Error::OutOfRange`] for a frequency, a gain or a
    /// direction that means nothing.
    pub fn push(&mut self, record: &Record) -> Result<()> {
        let trial = self.prepare(record)?;
        self.add(trial);
        Ok(())
    }

    /// Projects a trial on its harmonics, which is most of the work: [`Self::push`] in two halves, for trials side by side.
    ///
    /// # Errors
    /// Those of [`Self::push`].
    pub fn prepare(&self, record: &Record) -> Result<Prepared> {
        let samples = record.voltage_v.len();
        if record.standard.len() != samples {
            return Err(Error::LengthMismatch {
                what: "standard",
                expected: samples,
                got: record.standard.len(),
            });
        }
        for (name, value) in [
            ("sample_rate_hz", record.sample_rate_hz),
            ("frequency_hz", record.frequency_hz),
            ("direction_ground", record.direction_ground.length()),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::OutOfRange {
                    name,
                    value,
                    requirement: "positive and finite",
                });
            }
        }
        if !record.gravity_ground_m_s2.is_finite() {
            return Err(Error::OutOfRange {
                name: "gravity_ground_m_s2",
                value: record.gravity_ground_m_s2.length(),
                requirement: "finite",
            });
        }
        record.gains.validate()?;
        for (sample, (row, standard)) in record.voltage_v.iter().zip(record.standard).enumerate() {
            for (channel, value) in row.iter().chain([standard]).enumerate() {
                if !value.is_finite() {
                    return Err(Error::NotFinite {
                        channel: channel + 1,
                        sample,
                        value: *value,
                    });
                }
            }
        }
        let turns = samples as f64 / record.sample_rate_hz * record.frequency_hz;
        // More than there are samples are too many, however many more.
        let harmonics = ((HARMONICS_PER_DRIVE * turns).min(samples as f64) as usize).max(1);
        let grid = Grid {
            samples,
            step_s: 1.0 / record.sample_rate_hz,
            harmonics,
        };
        let needed = grid.coordinates() + FEWEST_FOR_NOISE;
        if samples < needed {
            return Err(Error::TooFewSamples {
                what: WHAT,
                needed,
                got: samples,
            });
        }
        check_closed(record.standard)?;
        let mut data = project(&grid, |n| {
            let row = &record.voltage_v[n];
            core::array::from_fn(|c| {
                if c < LIMBS {
                    row[c]
                } else {
                    record.standard[n]
                }
            })
        });
        // A limb may well feel nothing in a trial, all of them may not.
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |a, x| a.max(x.abs()));
        let floors = [
            largest(&mut record.voltage_v.iter().flatten().copied()),
            largest(&mut record.standard.iter().copied()),
        ]
        .map(|largest| (LEAST_NOISE * largest) * (LEAST_NOISE * largest));
        for (channel, variance) in data.variance.iter_mut().enumerate() {
            let floor = floors[usize::from(channel == LIMBS)];
            if floor == 0.0 {
                return Err(Error::DeadChannel {
                    channel: channel + 1,
                    value_v: 0.0,
                    samples,
                });
            }
            *variance = variance.max(floor);
        }
        let nominal = record.direction_ground.normalize();
        let g = record.gravity_ground_m_s2;
        Ok(Prepared {
            nominal,
            trial: Trial {
                drive: record.drive,
                latent: DVector::zeros(2 * harmonics),
                grid,
                gains: *record.gains,
                data,
                wedge: 0,
                gravity_m_s2: g,
                gravity_turns: record.drive == Drive::Angular
                    && g.cross(nominal).length() > TURNS * g.length(),
                amplifier: self.certificates.amplifier_corner_rad_s.is_some(),
                accelerometer_lag_s: self.certificates.accelerometer_lag_s,
                transient: [0.0; LIMBS],
            },
        })
    }

    /// Adds a projected trial.
    pub fn add(&mut self, prepared: Prepared) {
        let Prepared { nominal, mut trial } = prepared;
        trial.wedge = self
            .wedges
            .iter()
            .position(|w| (w.nominal - nominal).length() < SAME_WEDGE)
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
    /// [`Error::Indeterminate`] names an unknown that the trials leave open; [`Error::NotConverged`]; the errors of
    /// [`Parameters::validate`] for a start that is no sensor's.
    pub fn fit(&self, start: &Parameters) -> Result<JointEstimate> {
        Ok(self.fit_trials(start)?.0)
    }

    /// The fit, and the trials with their motions as it has them.
    fn fit_trials(&self, start: &Parameters) -> Result<(JointEstimate, Vec<Trial>)> {
        start.validate()?;
        let mut values = DVector::zeros(WEDGES + ANGLES * self.wedges.len());
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
        solve::fit(&self.shares, &self.trials, unknowns, &self.priors())
    }

    /// Measurements of single unknowns; an unknown with deviation 0 is not free.
    fn priors(&self) -> Vec<(usize, Known)> {
        let c = &self.certificates;
        let held = Known {
            value: 0.0,
            deviation: 0.0,
        };
        let mut priors: Vec<(usize, Known)> = (0..LIMBS)
            .map(|limb| {
                let known = Known {
                    value: self.at_rest.drift_v[limb],
                    deviation: self.at_rest.deviation_v[limb],
                };
                (DRIFT + limb, known)
            })
            .collect();
        let gyroscope_gain = Known {
            value: 0.0,
            deviation: c.gyroscope_gain_deviation,
        };
        priors.push((GYROSCOPE_GAIN, gyroscope_gain));
        priors.push((GYROSCOPE_LAG, c.gyroscope_lag_s.unwrap_or(held)));
        priors.push((AMPLIFIER_CORNER, c.amplifier_corner_rad_s.unwrap_or(held)));
        priors.extend(c.compliance_s2.map(|known| (COMPLIANCE, known)));
        for angle in 0..ANGLES * self.wedges.len() {
            let known = Known {
                value: 0.0,
                deviation: c.wedge_deviation_rad,
            };
            priors.push((WEDGES + angle, known));
        }
        priors
    }
}
