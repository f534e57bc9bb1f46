//! Calibrations: the joint fit, the propagation of errors, taps, self-calibration.

use serde::{Deserialize, Serialize};
use sixaxis_core::LIMBS;
use sixaxis_core::Parameter;
use sixaxis_reference::rig::field::Pace;

pub use crate::taps::Tally as TapTally;

/// Errors in variables: the bias of scale factors.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Joint {
    /// First of the seeds.
    pub first_seed: u64,
    /// Campaigns a level.
    pub campaigns: u64,
    /// Standard deviation of each bias.
    pub scatter: f64,
    /// Levels of noise.
    pub levels: Vec<JointLevel>,
}

/// One level of noise: mean errors of s1/m to s9/m in their standard deviations.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JointLevel {
    /// Ratio of signal to noise of the channels, dB.
    pub noise_db: f64,
    /// By step 2 as printed.
    pub plain_least_squares: [f64; LIMBS],
    /// By the joint fit.
    pub joint_fit: [f64; LIMBS],
}

/// Closed-form standard deviations against drawn ones.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Propagation {
    /// Campaigns drawn.
    pub draws: u64,
    /// First of the seeds.
    pub first_seed: u64,
    /// Sample rate of the trials, Hz.
    pub sample_rate_hz: f64,
    /// Trials a step.
    pub trials_per_step: usize,
    /// Standard deviation of a drawn standard deviation, relative.
    pub drawn_to: f64,
    /// Sets of sources of error.
    pub sets: Vec<PropagationSet>,
}

/// One set of sources of error.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PropagationSet {
    /// The sources in words.
    pub sources: String,
    /// The 25 parameters.
    pub parameters: Vec<PropagationParameter>,
    /// Largest departure of closed form over drawn from 1, of the parameters.
    pub largest_departure: f64,
    /// Largest error of a correlation.
    pub largest_correlation_error: f64,
    /// Accelerations by how well the attitude is known.
    pub by_attitude: Vec<Band>,
    /// Accelerations of each compound run.
    pub runs: Vec<PropagationRun>,
}

/// A parameter's standard deviations, in its unit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PropagationParameter {
    /// As in the paper: `s1/m`.
    #[serde(rename = "name")]
    pub parameter: Parameter,
    /// Its unit.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Closed form.
    pub closed_form: f64,
    /// The part of it that is noise.
    pub of_noise: f64,
    /// The part of it that is the standard instruments.
    pub of_standards: f64,
    /// The part of it that is the wedges.
    pub of_wedges: f64,
    /// Drawn.
    pub drawn: f64,
    /// Closed form over drawn.
    pub ratio: f64,
}

/// How accelerations depart where the attitude's standard deviation lies below an edge and above the edge before: the
/// decoupler is open loop, and first order ends where the attitude is lost.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Band {
    /// The edge, rad.
    pub below_rad: f64,
    /// Number of standard deviations.
    pub values: usize,
    /// Largest departure of closed form over drawn from 1.
    pub largest_departure: f64,
    /// Its root mean square.
    pub rms_departure: f64,
}

/// Accelerations of one compound run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PropagationRun {
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// Whether gravity turns in shell axes.
    pub gravity_turns: bool,
    /// Samples.
    pub samples: usize,
    /// Times of the curves' points, s.
    pub time_s: Vec<f64>,
    /// The six axes.
    pub axes: Vec<PropagationAxis>,
}

/// One axis of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PropagationAxis {
    /// Its name.
    pub name: String,
    /// Largest departure of closed form over drawn from 1.
    pub largest_departure: f64,
    /// Its root mean square.
    pub rms_departure: f64,
    /// Standard deviations along the run, closed form.
    pub closed_form: Vec<f64>,
    /// The same drawn.
    pub drawn: Vec<f64>,
}

/// k/m from taps.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Taps {
    /// First of the seeds.
    pub first_seed: u64,
    /// Standard deviation of the noise over the largest channel's peak.
    pub noise_over_peak: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Length of a recording, s.
    pub duration_s: f64,
    /// Largest effect of halving MuJoCo's step on ln k/m, over the bound.
    pub reference_error_over_bound: f64,
    /// One damping each.
    pub tallies: Vec<TapTally>,
}

/// Ratios of scale factors from tumbles.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SelfCalibration {
    /// First of the seeds.
    pub first_seed: u64,
    /// Standard deviation of the noise over the largest channel's peak.
    pub noise_over_peak: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Accuracy of a ratio that is asked for.
    pub bar: f64,
    /// Rates of false alarms that are asked for.
    pub rates: [f64; 2],
    /// Standard deviation of a scale factor by step 2, relative.
    pub step_2_deviation: f64,
    /// Accuracy of k_i/k_j that is asked for.
    pub stiffness_bar: f64,
    /// Size of the accumulator.
    pub accumulator_bytes: usize,
    /// Errors against intervals.
    pub lengths: Vec<TumbleLength>,
    /// The test of equal stiffness.
    pub stiffness: Vec<TumbleStiffness>,
    /// One limb that has drifted.
    pub drift: TumbleDrift,
    /// What each motion leaves unobservable.
    pub motions: Vec<TumbleMotion>,
}

/// Errors against intervals at one length, of ln c_i over the nine's mean.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TumbleLength {
    /// How the sensor is turned.
    pub pace: Pace,
    /// Length of a recording, s.
    pub duration_s: f64,
    /// Number of recordings.
    pub draws: usize,
    /// Of those refused as too poor.
    pub refused: usize,
    /// Root mean square of the errors over all limbs and draws.
    pub rms_error: f64,
    /// Largest of them.
    pub largest_error: f64,
    /// Median of the stated standard deviations.
    pub median_deviation: f64,
    /// Largest of them.
    pub largest_deviation: f64,
    /// Share of the errors within the accuracy asked for.
    pub share_within_bar: f64,
    /// Share of the draws of which all nine are.
    pub draws_within_bar: f64,
    /// Share of 95 % intervals that hold the truth.
    pub coverage_95: f64,
    /// The same limb by limb.
    pub coverage_95_by_limb: [f64; LIMBS],
    /// Mean of the errors' sum of squares over their covariance, less 8, in its standard deviations.
    pub chi_square_z: f64,
    /// Mean correlation of neighbouring blocks, in its standard deviations.
    pub mean_lag_one_z: f64,
    /// Share of draws whose misfit has less than 5 % of chance.
    pub share_misfit_at_5_percent: f64,
    /// Share of draws in which a limb is reported as drifted although none has, at each of the rates.
    pub named_without_drift: [f64; 2],
    /// Share of draws in which equal stiffness is refused although it holds, at each of the rates.
    pub refused_equal_stiffness: [f64; 2],
}

/// The test of equal stiffness at one spread.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TumbleStiffness {
    /// Standard deviation of the stiffnesses, relative.
    pub spread: f64,
    /// Number of recordings.
    pub draws: usize,
    /// Share refused at each of the rates.
    pub refused_at: [f64; 2],
    /// Root mean square error of ln k_i/k_j.
    pub rms_error_of_pair: f64,
    /// Largest.
    pub largest_error_of_pair: f64,
    /// Share within the accuracy asked for.
    pub share_of_pairs_within_bar: f64,
}

/// One limb that has drifted.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TumbleDrift {
    /// Its number.
    pub limb: usize,
    /// Change of ln s/m.
    pub change: f64,
    /// Length of a recording, s.
    pub duration_s: f64,
    /// Number of recordings.
    pub draws: usize,
    /// Share in which it is named and no other.
    pub named_alone: f64,
    /// Root mean square error of the change.
    pub rms_error: f64,
    /// Share of 95 % intervals that hold the change.
    pub coverage_95: f64,
}

/// What a motion leaves unobservable.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TumbleMotion {
    /// The motion in words.
    pub motion: String,
    /// The limbs between which no ratio is determined.
    pub open: Option<String>,
    /// Number of such directions.
    pub directions: usize,
}
