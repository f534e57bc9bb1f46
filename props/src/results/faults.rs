//! Failed limbs: detected, excluded, and dying in mid-motion.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sixaxis_calibration::report::Grade;

pub use crate::faults::laboratories::{Corner, Course};
pub use crate::faults::null::{Curve, FalseAlarms};
pub use crate::faults::tally::{Counts, OfClass, Tally as FaultTally, WITHIN};
pub use crate::faults::watched::Watched;

/// False alarms, detection, isolation and naming of failed limbs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Detection {
    /// First of the seeds.
    pub first_seed: u64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Rate of false alarms that is asked for.
    pub false_alarms_per_hour: f64,
    /// Samples after the failure by which detection is counted.
    pub within_samples: [u64; WITHIN.len()],
    /// Alarms of sensors without a failure.
    pub false_alarms: Vec<FalseAlarms>,
    /// Each kind of failure at each size.
    pub kinds: Vec<FaultTally>,
    /// Size of the failures of `classes`, in standard deviations.
    pub class_sigmas: f64,
    /// Each class of limbs that fail alike.
    pub classes: Vec<OfClass>,
    /// Operating curves.
    pub curves: Vec<Curve>,
}

/// False alarms of `decouple --watch` on healthy laboratories.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WatchedLaboratories {
    /// First of the seeds.
    pub first_seed: u64,
    /// Laboratories that were played, as many again with equal limbs.
    pub laboratories: u64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Rate of false alarms that is asked for: the command's default.
    pub false_alarms_per_hour: f64,
    /// Length of one recording, s.
    pub recording_s: f64,
    /// Crank frequencies of the rig, from and to, Hz.
    pub rig_hz: (f64, f64),
    /// Largest error of a wedge, degrees.
    pub wedge_error_deg: f64,
    /// Standard deviation of the limbs' stiffnesses about their mean, relative, where they are not equal.
    pub stiffness_spread: f64,
    /// Each corner.
    pub corners: Vec<WatchedCorner>,
}

/// The laboratories of one corner.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WatchedCorner {
    /// In which respects they are better than real ones.
    pub corner: Corner,
    /// Calibrations of each grade. Those that are not good are not watched.
    pub grades: BTreeMap<String, usize>,
    /// All recordings.
    pub total: Watched,
    /// Those of each course of motion.
    pub courses: Vec<Watched>,
}

impl WatchedCorner {
    /// Counts grades by their words.
    pub fn grades(grades: &[Grade]) -> BTreeMap<String, usize> {
        grades.iter().fold(BTreeMap::new(), |mut counts, grade| {
            *counts.entry(grade.word().to_owned()).or_default() += 1;
            counts
        })
    }
}

/// A limb that dies in mid-motion. Histories hold one point for a stretch of samples.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DyingLimb {
    /// Seed of the motion.
    pub seed: u64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Number of the limb.
    pub limb: usize,
    /// Time of its death, s.
    pub died_at_s: f64,
    /// Samples from there to the isolation of its class.
    pub isolated_after_samples: u64,
    /// Samples from there to its exclusion.
    pub switched_after_samples: u64,
    /// What the monitor reports.
    pub verdict: String,
    /// Threshold of `statistic`.
    pub threshold: f64,
    /// Times of the points, s.
    pub time_s: Vec<f64>,
    /// Largest squared norm of the whitened parity rows in each stretch.
    pub statistic: Vec<f64>,
    /// Acceleration along x, ground axes, m/s^2: truth.
    pub truth_m_s2: Vec<f64>,
    /// The same decoded with all nine limbs.
    pub nine_m_s2: Vec<f64>,
    /// The same with the limb excluded once it is isolated.
    pub watched_m_s2: Vec<f64>,
    /// Rotation from the true attitude, rad: the sensor that never failed.
    pub never_failed_rad: Vec<f64>,
    /// The same with all nine limbs.
    pub nine_rad: Vec<f64>,
    /// The same with the limb excluded once it is isolated.
    pub watched_rad: Vec<f64>,
}

/// Every set of up to three excluded limbs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FailedLimbs {
    /// First of the seeds.
    pub first_seed: u64,
    /// Number of seeds.
    pub seeds: u64,
    /// Samples that the noise is measured over.
    pub noise_samples: usize,
    /// Sets that leave six axes.
    pub survivable: usize,
    /// Of those: the largest error of six at most twice that with all limbs, in the median over the seeds.
    pub within_twice: usize,
    /// The same with scale factors that obey the coordination equations on the run itself.
    pub within_twice_consistent: usize,
    /// As `within_twice`, of the root mean square over the samples.
    pub within_twice_rms: usize,
    /// As `within_twice_consistent`, of the root mean square over the samples.
    pub within_twice_rms_consistent: usize,
    /// What an exclusion adds to a noise-free answer, at most, over full scale.
    pub largest_noise_free_excess: f64,
    /// Largest error with all limbs, seed by seed.
    pub healthy_largest_error: Vec<f64>,
    /// Each set.
    pub sets: Vec<ExcludedSet>,
}

/// One set of excluded limbs. Ratios are over the decoder with all limbs and absent where a load is lost; six numbers
/// are those of ax, ay, az, alpha_x, alpha_y, alpha_z.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ExcludedSet {
    /// Numbers of the limbs, ascending.
    pub failed: Vec<usize>,
    /// The load that the remaining limbs cannot observe.
    pub lost: Option<String>,
    /// Standard deviations of the accelerations, closed form.
    pub amplification: Option<[f64; 6]>,
    /// The same measured.
    pub amplification_measured: Option<[f64; 6]>,
    /// What the exclusion adds to a noise-free answer, over full scale.
    pub noise_free_excess: Option<f64>,
    /// Largest error over the samples and six axes: median over the seeds.
    pub error_ratio: Option<f64>,
    /// The same with consistent scale factors.
    pub error_ratio_consistent: Option<f64>,
    /// Root mean square, worst of six axes.
    pub rms_ratio: Option<f64>,
    /// The same with consistent scale factors.
    pub rms_ratio_consistent: Option<f64>,
}
