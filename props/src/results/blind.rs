//! Blind trials of the verdict: healthy laboratories, and defects by their size.

use serde::{Deserialize, Serialize};
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::Engine;

use crate::blind::Cell;
use crate::blind::share::Share;

/// Blind trials of the verdict.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Blind {
    /// First of the seeds.
    pub first_seed: u64,
    /// Number of sessions, one a seed.
    pub sessions: usize,
    /// What played them.
    pub engine: Engine,
    /// Sample rate of the trials, Hz.
    pub sample_rate_hz: f64,
    /// Length of the static record, s.
    pub static_duration_s: f64,
    /// A good calibration has no parameter beyond so many half widths of its 95 % interval,
    pub promised_widths: f64,
    /// and decouples to within this, of the peak.
    pub promised_decoupling: f64,
    /// Sessions called good that break this, of all.
    pub false_good: Share,
    /// Of those that are called good.
    pub false_good_of_good: Share,
    /// Sessions whose cause named first is not the defect, of all of which a cause is named.
    pub wrong_cause_of_named: Share,
    /// Healthy laboratories.
    pub healthy: Vec<BlindCell>,
    /// Kinds of defects.
    pub kinds: Vec<BlindKind>,
}

/// Healthy laboratories of one sort.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindCell {
    /// What they have in common.
    pub cell: Cell,
    /// What became of them.
    pub tally: BlindTally,
}

/// One kind of defect.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindKind {
    /// The kind.
    pub kind: Kind,
    /// Unit of its magnitude.
    pub unit: String,
    /// What the magnitude is.
    pub meaning: String,
    /// From small to large.
    pub bins: Vec<BlindBin>,
}

/// Defects of about one size.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindBin {
    /// Smallest magnitude.
    pub from: f64,
    /// Largest.
    pub to: f64,
    /// What became of them.
    pub tally: BlindTally,
}

/// Verdicts, causes and harm of some sessions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindTally {
    /// Sessions.
    pub sessions: usize,
    /// Called good.
    pub good: Share,
    /// Called good with reservations.
    pub reserved: Share,
    /// Called not good, with a calibration.
    pub not_good: Share,
    /// Without a calibration.
    pub refused: Share,
    /// The cause named first is the defect.
    pub right_cause: Share,
    /// No cause is named.
    pub no_cause: Share,
    /// Another cause is named.
    pub wrong_cause: Share,
    /// Called good, and a parameter or the decoupling is worse than good states.
    pub false_good: Share,
    /// Largest relative error of scale factors and inertias: median of the sessions with a calibration.
    pub median_parameter_error: Option<f64>,
    /// Largest of these errors over the half width of its interval: median.
    pub median_over_interval: Option<f64>,
    /// Error of the decoupled validation run in sensor axes, of the peak: median.
    pub median_decoupling_error: Option<f64>,
}
