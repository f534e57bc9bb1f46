//! Blind trials of the verdict: healthy laboratories, and defects by their size.

use serde::{Deserialize, Serialize};
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::report::Grade;
use sixaxis_core::Parameter;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::Engine;
use sixaxis_reference::laboratory::room::Room;

use crate::blind::share::Share;
use crate::blind::{Cell, could_show};

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
    /// The same of the sessions whose defect, if they have one, a recording of the day could show.
    pub false_good_that_could_show: Share,
    /// Those among all of which a zero drift breaks it, of all.
    pub false_good_at_rest: Share,
    /// Of those that are called good.
    pub false_good_of_good: Share,
    /// Sessions whose cause named first is not the defect, of all of which a cause is named.
    pub wrong_cause_of_named: Share,
    /// Healthy laboratories.
    pub healthy: Vec<BlindCell>,
    /// Kinds of defects.
    pub kinds: Vec<BlindKind>,
}

impl Blind {
    /// As `false_good_that_could_show`, of those that are called good.
    pub fn false_good_of_good_that_could_show(&self) -> Share {
        let hidden = self.kinds.iter().filter(|kind| !could_show(kind.kind));
        let hidden = hidden.flat_map(|kind| &kind.bins);
        let hidden: usize = hidden.map(|bin| bin.tally.good.count).sum();
        Share::new(
            self.false_good_that_could_show.count,
            self.false_good_of_good.of - hidden,
        )
    }
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
    /// What it exceeds in 5 % of the sessions with a calibration, but for what the accelerometer's gain makes of the scale factors:
    /// linear and angular accelerations.
    pub beyond_gain_95: Option<[f64; 2]>,
}

impl BlindPairs {
    /// Sessions of which the rigid engine's verdict names the same cause first, of all of which MuJoCo's names one.
    pub fn same_cause_of_named(&self) -> Share {
        let named = self.mujoco.wrong_cause_of_named.of;
        let other = self.differing.iter();
        let other = other
            .filter(|pair| pair.mujoco.cause.is_some() && pair.mujoco.cause != pair.rigid.cause);
        Share::new(named.saturating_sub(other.count()), named)
    }
}

/// The same sessions played by MuJoCo and by the engine with rigid limbs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindPairs {
    /// As MuJoCo played them.
    pub mujoco: Blind,
    /// Sessions that are called the same, or are refused, whichever engine played them.
    pub same_grade: Share,
    /// Of which the same cause is named first, or none.
    pub same_cause: Share,
    /// Of which the calibration keeps what good states, or breaks it, either way; without one it does neither.
    pub same_promise: Share,
    /// Those that differ in any of these.
    pub differing: Vec<BlindPair>,
}

/// One session whose verdict or worth depends on the engine.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BlindPair {
    /// Its seed.
    pub seed: u64,
    /// What it was drawn from.
    pub cell: Cell,
    /// Size of the defect in its kind's unit, without sign.
    pub magnitude: Option<f64>,
    /// As MuJoCo played it.
    pub mujoco: BlindVerdict,
    /// As the engine with rigid limbs did.
    pub rigid: BlindVerdict,
}

/// Verdict on a session and what it is worth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BlindVerdict {
    /// The verdict; none if the session is refused.
    pub grade: Option<Grade>,
    /// The cause named first.
    pub cause: Option<Cause>,
    /// Whether the calibration breaks what good states; none without one.
    pub breaks_the_promise: Option<bool>,
}

/// What calibrations of the two rooms state of themselves, held against the truth.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Rooms {
    /// First of the seeds of each room.
    pub first_seed: u64,
    /// The rooms.
    pub rooms: Vec<RoomCoverage>,
}

/// Healthy sessions of one room.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RoomCoverage {
    /// The room.
    pub room: Room,
    /// Sessions that were played.
    pub sessions: usize,
    /// Of which the joint fit gave the calibration; the others are in none of the shares below.
    pub by_joint_fit: usize,
    /// The 25 parameters.
    pub intervals: Vec<RoomIntervals>,
    /// Stated standard deviations within which accelerations are looked for.
    pub deviations: f64,
    /// 3 Hz runs that were decoupled open loop.
    pub runs: usize,
    /// Share of a run's values that keep within them, all six accelerations in ground axes of all samples: mean over the runs. Of normal
    /// errors 99.73 % are within three.
    pub values_within: f64,
    /// Share that it is at least in 95 % of the runs.
    pub values_within_95: Option<f64>,
    /// Stated deviations within which all values of a run are in 95 % of the runs.
    pub largest_95: Option<f64>,
    /// Every tenth session again, with a channel that shows less in the angular trials, by size.
    pub one_kind: Vec<OneKind>,
}

/// Sessions with one channel that shows less in all angular trials than in the others.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OneKind {
    /// So much less, relative.
    pub less: f64,
    /// Called good.
    pub good: Share,
    /// The first thing that is found is that this channel, and no other, changes.
    pub named: Share,
}

/// One parameter's 95 % intervals.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RoomIntervals {
    /// As in the paper: `s1/m`.
    #[serde(rename = "name")]
    pub parameter: Parameter,
    /// Those that hold the truth, of those that are stated.
    pub held: Share,
}
