//! Every number the study produces, as plain data: what `results.json` holds.
//!
//! Nothing here depends on the machine, the clock or the number of threads: the same seed gives the same file, bit
//! for bit. What does is in `run.json`. A number that was not measured is NaN here and `null` in the file.

pub mod identifiability;

use identifiability::Identifiability;
use serde::Serialize;
use sixaxis_calibration::calibration::CalibratedParameters;
use sixaxis_core::identify::Verdict;
use sixaxis_core::{Parameters, Scheme};
use sixaxis_reference::laboratory::instruments::Instruments;
use sixaxis_reference::mujoco::threshold::SweepPoint;
use sixaxis_reference::rig::run::{Mode, Mounting};

use super::acceptance::largest;
use super::arithmetic::Arithmetic;

/// The whole study.
#[derive(Debug, Clone, Serialize)]
pub struct Results {
    /// Seed of the laboratory's errors.
    pub seed: u64,
    /// Whether fewer runs than the paper's were played.
    pub quick: bool,
    /// Trials per identification step.
    pub trials_per_step: usize,
    /// Version of this program.
    pub sixaxis_version: String,
    /// Version of MuJoCo, as the library reports it.
    pub mujoco_version: String,
    /// How good the reference is.
    pub reference: ReferenceCheck,
    /// Four steps without errors.
    pub noise_free: Identification,
    /// The same with steps 2 to 4 repeated, the limbs' compliance kept.
    pub noise_free_repeated: Identification,
    /// Four steps with the laboratory's errors.
    pub laboratory: Identification,
    /// The laboratory's instruments as drawn from their class.
    pub instruments: Instruments,
    /// Tables 4 to 6, without errors.
    pub compound_noise_free: Vec<Compound>,
    /// Tables 4 to 6, with the laboratory's errors.
    pub compound_laboratory: Vec<Compound>,
    /// Tables 4 to 6 with the pinion's axis level, so that gravity turns in the shell: noise-free.
    pub compound_axis_level: Vec<Compound>,
    /// The noise-free runs of both mountings at half the sample rate, with true parameters: what each scheme's order is read from.
    pub compound_half_rate: Vec<Compound>,
    /// Fig. 7.
    pub thresholds: Vec<Sweep>,
    /// Fig. 10.
    pub searches: Vec<Search>,
    /// How well each parameter is known, and why step 4 does not determine k/m.
    pub identifiability: Identifiability,
    /// Error of each scheme against the sample rate.
    pub orders: Vec<Order>,
    /// Time histories of the 5 Hz run.
    pub history: History,
    /// What single defects of the signal chain cost.
    pub defects: Defects,
    /// Printed claims that arithmetic decides.
    pub arithmetic: Arithmetic,
    /// The acceptance limits of this study.
    #[serde(rename = "bars")]
    pub acceptance: Vec<AcceptanceLimit>,
}

/// The reference against theory and against itself.
#[derive(Debug, Clone, Serialize)]
pub struct ReferenceCheck {
    /// Largest difference of MuJoCo's static elongations and an independent Newton solve, over the largest elongation.
    pub static_elongation_relative: f64,
    /// Largest static elongation under gravity, m.
    pub static_elongation_m: f64,
    /// Ring-downs of the design sensor and of the identified one.
    pub modes: Vec<ModeSet>,
    /// Step of the campaign's simulations, s.
    pub campaign_step_s: f64,
    /// Step of the compound runs, s; the halved step stands beside every comparison.
    pub compound_step_s: f64,
}

/// Six modes of one sensor.
#[derive(Debug, Clone, Serialize)]
pub struct ModeSet {
    /// Which sensor.
    pub sensor: String,
    /// Eigenvalue solution, Hz.
    pub predicted_hz: [f64; 6],
    /// MuJoCo's ring-down, Hz.
    pub measured_hz: [f64; 6],
}

/// Result of the four steps.
#[derive(Debug, Clone, Serialize)]
pub struct Identification {
    /// The truth, for comparison; no algorithm saw it.
    pub truth: Parameters,
    /// What the four steps found; k/m is the grid point of step 4.
    pub found: Parameters,
    /// What the decoupler uses: `found`, or the design's k/m where step 4 does not determine it.
    pub used: Parameters,
    /// Change of `found` when the simulator's step is halved: the reference's own error, per parameter.
    pub reference_error: CalibratedParameters,
    /// Standard errors that the steps report, per parameter (k/m: none).
    pub standard_error: CalibratedParameters,
    /// Step 2: condition number of the column-scaled regressor and residual, m/s^2.
    pub scale_condition: f64,
    /// See above.
    pub scale_residual_m_s2: f64,
    /// Verdict of step 2.
    pub scale_verdict: Verdict,
    /// Step 3: condition number and residual, m^2/s^2.
    pub inertia_condition: f64,
    /// See above.
    pub inertia_residual_m2_s2: f64,
    /// Verdict of step 3.
    pub inertia_verdict: Verdict,
    /// True rate over the gyroscope's reading as step 3 found it, and its standard error.
    pub rate_over_reading: Option<(f64, f64)>,
    /// Step 4: the minimum between grid points, s^-2.
    pub stiffness_interpolated_per_s2: f64,
    /// Verdict of step 4.
    pub stiffness_verdict: Verdict,
}

/// One compound run.
#[derive(Debug, Clone, Serialize)]
pub struct Compound {
    /// Table number in the paper.
    pub table: u32,
    /// Drive frequency, Hz.
    pub frequency_hz: f64,
    /// How the sensor hangs.
    pub mounting: Mounting,
    /// Sample rate of the recording, Hz.
    pub sample_rate_hz: f64,
    /// Peak of the truth: m/s^2, rad/s^2.
    pub peak: [f64; 6],
    /// Amplitude at the drive frequency at full speed, from the truth: m/s^2, rad/s^2. The table's target.
    pub amplitude: [f64; 6],
    /// Comparisons; errors are the largest over the whole run, over that axis' peak.
    pub comparisons: Vec<Comparison>,
    /// Change of the truth-to-decoupled difference when the simulator's step is halved, over the peak; NaN where that was not simulated.
    pub reference_error: [f64; 6],
}

/// One way of decoupling a run, held against one standard.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// Which parameters.
    pub parameters: ParameterSet,
    /// Which scheme.
    pub scheme: Scheme,
    /// Whether the decoupler reckons with gravity.
    pub gravity: Gravity,
    /// What is done about the drift that integration makes of small errors.
    pub correction: Correction,
    /// Against what.
    pub against: Standard,
    /// Largest error over the run, over the axis' peak.
    pub error: [f64; 6],
}

/// Parameters used to decouple.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ParameterSet {
    /// The design columns, zero drift included.
    Design,
    /// What the four steps found.
    Identified,
    /// The truth.
    True,
    /// What the four steps found when steps 2 to 4 were repeated with the limbs' compliance kept.
    Repeated,
}

/// Whether a decoupler reckons with gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gravity {
    /// Static preload restored and gravity turned with the shell.
    Kept,
    /// As in the paper's equations once the drift is off: right only while gravity is constant in the shell.
    Neglected,
}

/// What is done about the drift that integration makes of small errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Correction {
    /// Nothing, as in the paper.
    OpenLoop,
    /// Six numbers a run, so that it ends at rest where it began.
    RestToRest,
}

/// What a decoupled signal is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standard {
    /// The simulator's state.
    Truth,
    /// The standard instruments, as in the paper.
    Instruments,
}

/// One way of decoupling and comparing: with which parameters, scheme and correction, against what.
pub type Way = (ParameterSet, Scheme, Correction, Standard);

/// What the four steps found, against truth.
pub const FOUR_STEPS: Way = substepped(
    ParameterSet::Identified,
    Correction::OpenLoop,
    Standard::Truth,
);
/// What the repeated steps found, against truth.
pub const REPEATED: Way = substepped(
    ParameterSet::Repeated,
    Correction::OpenLoop,
    Standard::Truth,
);

/// Heun in eight sub-steps with these parameters.
pub const fn substepped(
    parameters: ParameterSet,
    correction: Correction,
    against: Standard,
) -> Way {
    (parameters, Scheme::HeunSubstepped, correction, against)
}

impl Compound {
    /// The comparison made in this way: where there are two, the one that reckons with gravity.
    pub fn comparison(&self, way: Way) -> Option<&Comparison> {
        let mut found = self
            .comparisons
            .iter()
            .filter(|c| (c.parameters, c.scheme, c.correction, c.against) == way);
        let first = found.next()?;
        Some(
            found
                .find(|c| c.gravity == Gravity::Kept && first.gravity != Gravity::Kept)
                .unwrap_or(first),
        )
    }

    /// Its errors, over the axes' peaks; NaN where nothing was compared in this way.
    pub fn error(&self, way: Way) -> [f64; 6] {
        self.comparison(way).map_or([f64::NAN; 6], |c| c.error)
    }
}

/// Largest error of a set of runs decoupled and compared in one way, over the axes' peaks. NaN without runs and where one of them was
/// not compared in this way: what nobody compared meets no limit.
pub fn worst(runs: &[Compound], way: Way) -> f64 {
    largest(runs.iter().flat_map(|run| run.error(way)))
}

/// One sweep of Fig. 7.
#[derive(Debug, Clone, Serialize)]
pub struct Sweep {
    /// Which sensor.
    pub sensor: String,
    /// Linear or angular.
    pub mode: Mode,
    /// Points, ascending in frequency.
    pub points: Vec<SweepPoint>,
    /// Linear theory at the same frequencies.
    pub theory: Vec<f64>,
    /// Threshold, m/s^2 or rad/s^2.
    pub threshold: f64,
    /// Where the sweep crosses it, Hz.
    pub crossing_hz: Option<f64>,
    /// Slope on log axes.
    pub slope: f64,
    /// Relative acceleration at 2 Hz and 4 Hz by interpolation on log axes.
    pub at_2_and_4_hz: [f64; 2],
}

/// One curve of Fig. 10.
#[derive(Debug, Clone, Serialize)]
pub struct Search {
    /// Which scale factors.
    pub label: String,
    /// True for eq. (2) as printed.
    pub sign_as_printed: bool,
    /// Relative size of the scale errors put in (root mean square); None where the four steps made them.
    pub scale_error: Option<f64>,
    /// (k/m, mean |w*|): s^-2, rad/s.
    pub curve: Vec<(f64, f64)>,
    /// Grid point of the minimum, s^-2.
    pub grid_minimum_per_s2: f64,
    /// Minimum between grid points, s^-2.
    pub interpolated_per_s2: f64,
    /// Whether the curve determines k/m.
    pub verdict: Verdict,
}

/// One scheme's errors over sample rates.
#[derive(Debug, Clone, Serialize)]
pub struct Order {
    /// Scheme.
    pub scheme: Scheme,
    /// Theoretical order.
    pub theoretical: u32,
    /// (sample rate in Hz, largest error of w* over its peak).
    pub points: Vec<(f64, f64)>,
    /// Slope over the points above ten times the reference's own error; None with fewer than three.
    pub measured: Option<f64>,
    /// The reference's own error of w* over its peak.
    pub reference_error: f64,
}

/// Truth and decoupled accelerations over time.
#[derive(Debug, Clone, Serialize)]
pub struct History {
    /// Drive frequency, Hz.
    pub frequency_hz: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Truth, m/s^2 and rad/s^2.
    pub truth: [Vec<f64>; 6],
    /// Decoupled with the noise-free identification, less the truth.
    pub error_noise_free: [Vec<f64>; 6],
    /// Decoupled with the laboratory's identification from its noisy recording.
    pub laboratory: [Vec<f64>; 6],
    /// The same less the truth.
    pub error_laboratory: [Vec<f64>; 6],
}

/// What single defects cost, everything else perfect.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Defects {
    /// Corner of the charge amplifier, Hz.
    pub amplifier_corner_hz: f64,
    /// Largest error of the 1 Hz run with an AC-coupled amplifier left alone, over the peak.
    pub amplifier_left_alone: f64,
    /// The same with the high-pass undone.
    pub amplifier_undone: f64,
    /// Largest error of I/m over its largest entry with the gyroscope's lag left alone in step 3.
    pub gyroscope_lag_left_alone: f64,
    /// The same with the lag undone.
    pub gyroscope_lag_undone: f64,
    /// Slowest compound run played with the axis level, Hz.
    pub gravity_neglected_frequency_hz: f64,
    /// Its largest error when gravity is neglected, over the peak.
    pub gravity_neglected: f64,
    /// The same when it is reckoned with.
    pub gravity_kept: f64,
    /// Largest voltage of the printed gyroscope sensitivity at the rig's largest rate, V.
    pub gyroscope_output_v: f64,
}

/// An acceptance limit and what was measured.
#[derive(Debug, Clone, Serialize)]
pub struct AcceptanceLimit {
    /// What is measured.
    pub name: String,
    /// Measured value.
    pub value: f64,
    /// Limit.
    pub limit: f64,
    /// Unit of both; empty for a ratio.
    pub unit: String,
    /// Whether the value is within the limit.
    pub met: bool,
    /// What a miss means.
    pub kind: LimitKind,
    /// Remark.
    pub note: String,
}

/// What it means that a limit is missed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitKind {
    /// Something here is broken: the command that made the report says so in its exit code.
    Required,
    /// The paper's method, or this seed's instruments, do not reach what one would like: a finding.
    Aim,
}

impl AcceptanceLimit {
    /// Whether it must hold and does not.
    pub fn is_broken(&self) -> bool {
        self.kind == LimitKind::Required && !self.met
    }
}
