//! Hours of motion decoupled with what else is known of them.

use serde::{Deserialize, Serialize};
use sixaxis_reference::rig::journey::Kind;

pub use crate::aided::Aids;
use crate::evidence::Quantiles;

/// Motions of an hour, open loop and with aids.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hours {
    /// First of the seeds.
    pub first_seed: u64,
    /// Motions of each kind.
    pub runs: u64,
    /// Length of each, s.
    pub duration_s: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Noise of a sample over the largest signal.
    pub noise_over_peak: f64,
    /// Deviation of the attitude up to which it counts as known, rad.
    pub known_rad: f64,
    /// Time after which the open loop is no longer followed, s.
    pub open_until_s: f64,
    /// Each kind of motion with each set of aids.
    pub rides: Vec<AidedRide>,
}

/// The same of motions that MuJoCo played, with what its own step leaves open.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MujocoHours {
    /// MuJoCo's step, s.
    pub step_s: f64,
    /// What half of it changes; nothing in a sample, as it would take as long as all else.
    pub halved: Vec<Halved>,
    /// Errors and deviations.
    pub hours: Hours,
}

/// Largest difference that half the step makes in the first seconds of a motion.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Halved {
    /// The motion.
    pub kind: Kind,
    /// Of a limb's force over the mass, m/s^2.
    pub force_m_s2: f64,
    /// Of the attitude, rad, by an arc cosine, whose rounding is 4e-8.
    pub attitude_rad: f64,
}

/// One kind of motion with one set of aids, over all runs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AidedRide {
    /// The motion.
    pub kind: Kind,
    /// The aids.
    pub aids: Aids,
    /// Errors at some times.
    pub at: Vec<AidedErrors>,
    /// Components of a that were looked at, about one a second in each direction while the attitude was known.
    pub components: u64,
    /// How many of them were off by more than three of their deviations.
    pub beyond_three: u64,
    /// The largest error of one, in its deviations; none where nothing was looked at.
    pub largest: Option<f64>,
    /// Runs whose attitude was known to the end.
    pub known_to_the_end: u64,
    /// Median of the times from which on it was not known for the first time, of the other runs, s.
    pub unknown_from_s: Option<f64>,
    /// What a still sensor keeps open under these aids, where that has an end.
    pub bound: Option<Steady>,
    /// Median of the stated deviations of the runs that were known at the last time.
    pub stated: Option<Steady>,
    /// Root of their mean squared errors.
    pub attained: Option<Steady>,
}

/// Deviations, or errors, across the plumb line.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Steady {
    /// Of down, rad.
    pub tilt_rad: f64,
    /// Of the rate, rad/s.
    pub rate_rad_s: f64,
}

/// Errors of all runs at one time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AidedErrors {
    /// Time, s.
    pub time_s: f64,
    /// Runs whose attitude was known then.
    pub known: u64,
    /// What the attitude's error makes of a, of all runs that were decoupled so far, m/s^2.
    pub linear_m_s2: Option<Quantiles>,
    /// Squared errors of the attitude and of the rate over their variances, mean of the runs that were known.
    pub over_variance: Option<[f64; 2]>,
}
