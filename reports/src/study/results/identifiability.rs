//! What the campaign can and cannot say of its parameters, as data.

mod known;

pub use known::{Interval, Known, KnownParameter, KnownTap};

use serde::Serialize;
use sixaxis_calibration::iteration::{End, Pass};
use sixaxis_core::LIMBS;

/// How well the parameters are known, and four answers to the question why step 4 does not determine k/m.
#[derive(Debug, Clone, Serialize)]
pub struct Identifiability {
    /// The 25 from the campaign with errors.
    pub known: Known,
    /// What errors of the other parameters do to step 4.
    pub tolerances: Vec<Tolerance>,
    /// What any method could know of k/m.
    pub bound: BoundStudy,
    /// What step 2's neglect does to step 4, from whole runs and from even turns.
    pub biases: Vec<Bias>,
    /// Steps 2 to 4 repeated until k/m stands still.
    pub iterations: Vec<IterationRun>,
}

/// Which part of its trials step 4 is given. Pure linear motion has no rate at any time, so that any part will do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Records {
    /// From rest to rest.
    WholeRuns,
    /// The turns at full speed alone.
    EvenTurns,
}

/// Which parameters are in error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Erring {
    /// Scale factors, relative.
    Scale,
    /// Zero drifts, over the converter's full scale.
    Drift,
    /// Inertias, over the largest.
    Inertia,
}

/// Error of k/m from noise-free records against the size of the errors of one kind of parameter.
#[derive(Debug, Clone, Serialize)]
pub struct Tolerance {
    /// What step 4 is given.
    pub records: Records,
    /// Which.
    pub erring: Erring,
    /// Seed of the first draw; the others follow it.
    pub seed: u64,
    /// Draws at each size, the same directions at every size.
    pub draws: usize,
    /// Ascending in size.
    pub points: Vec<TolerancePoint>,
}

/// One size of error.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TolerancePoint {
    /// Standard deviation of the relative errors.
    pub size: f64,
    /// Median of |ln(k/m found over true)|.
    pub median: f64,
    /// Smallest and largest of it.
    pub range: (f64, f64),
    /// The median by first-order theory; scale factors only.
    pub predicted_median: Option<f64>,
    /// Share of searches that end at an edge of the grid.
    pub at_edge: f64,
    /// Share of searches whose curve determines k/m by its own verdict.
    pub determined: f64,
}

/// Cramer-Rao bounds.
#[derive(Debug, Clone, Serialize)]
pub struct BoundStudy {
    /// Frequencies of a band, from four fifths of its upper end to that end.
    pub frequencies: usize,
    /// Samples of each trial.
    pub samples: usize,
    /// Noise of a sample over the largest channel of its trial.
    pub noise_over_largest: f64,
    /// The bands that the table names; the paper's first.
    pub bands: Vec<BandBound>,
    /// The same over the frequency.
    pub curve: Vec<BandBound>,
}

/// Bounds on the standard deviation of ln(k/m) from trials in one band.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct BandBound {
    /// Upper end of the band, Hz.
    pub to_hz: f64,
    /// Three directions, nine scale factors and six inertias unknown.
    pub three_directions: f64,
    /// Six directions, the same unknown.
    pub six_directions: f64,
    /// Three directions, the scale factors known.
    pub scale_known: f64,
    /// Three directions, everything but k/m known.
    pub all_else_known: f64,
    /// Three directions with the limbs' tilt, everything unknown, nine zero drifts a trial among it. The others: linear theory.
    pub tilted_three_directions: f64,
    /// Six directions, the same.
    pub tilted_six_directions: f64,
    /// Three directions with the limbs' tilt, linear motion alone, the inertias known.
    pub tilted_linear_motion: f64,
}

/// What step 2's neglect does, measured and by first-order theory.
#[derive(Debug, Clone, Serialize)]
pub struct Bias {
    /// What step 4 is given.
    pub records: Records,
    /// Relative error of the nine scale factors of step 2, noise-free.
    pub scale_error_measured: [f64; LIMBS],
    /// The same by first-order theory.
    pub scale_error_predicted: [f64; LIMBS],
    /// The same without gravity: what is left of it is due to the drive's frequency.
    pub scale_error_without_gravity: [f64; LIMBS],
    /// Root mean squares in step 4, m^2/s^2: the half edge times the acceleration, the size of a single limb's torque.
    pub torque_of_a_limb: f64,
    /// The torque that the limbs' compliance causes.
    pub torque_of_compliance: f64,
    /// The torque that the scale factors' errors cause.
    pub torque_of_scale_error: f64,
    /// k/m that step 4 finds with the scale factors of step 2, s^-2.
    pub stiffness_measured_per_s2: f64,
    /// The same by first-order theory, s^-2.
    pub stiffness_predicted_per_s2: f64,
    /// Smallest and largest k/m that a single trial finds, s^-2.
    pub single_trial_measured_per_s2: (f64, f64),
    /// The same by first-order theory, s^-2.
    pub single_trial_predicted_per_s2: (f64, f64),
    /// Share of a compliance's error that is left after one more pass, by first-order theory, with its sign.
    pub left_after_a_pass: f64,
    /// Step 4's curve with the scale factors of step 2: k/m, s^-2, and mean |w*|, rad/s.
    pub curve_measured: Vec<(f64, f64)>,
    /// The same by first-order theory.
    pub curve_predicted: Vec<(f64, f64)>,
}

/// One iteration.
#[derive(Debug, Clone, Serialize)]
pub struct IterationRun {
    /// What step 4 is given.
    pub records: Records,
    /// Whether the records have errors.
    pub with_errors: bool,
    /// k/m of the first repetition where it is not step 4's own, s^-2.
    pub start_per_s2: Option<f64>,
    /// True k/m, s^-2.
    pub truth_per_s2: f64,
    /// Passes, the four steps first.
    pub passes: Vec<Pass>,
    /// How it ended.
    pub end: End,
    /// The same in a sentence.
    pub sentence: String,
}
