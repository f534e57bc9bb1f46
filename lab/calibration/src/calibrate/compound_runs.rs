//! How much the channels show of what compound runs travel and turn, each apart.
//!
//! Scale factors come from trials that travel and inertias from trials that turn. Where all nine channels were scaled otherwise in the ones
//! than in the others no trial shows it: the inertias take the factor. A run that was not fitted and does both tells: what one kind of
//! trials was scaled by and the run was not is missing from that motion and not from the other. Neither a centre off the axis nor
//! an axis off the plumb line moves anything along the axis, and of these runs' course nothing else is looked at.

use glam::DVec3;
use sixaxis_page::number::significant;

use crate::finding::{Cause, Finding};
use crate::joint::JointReport;
use crate::joint::nuisances::Nuisances;
use crate::report::ValidationRun;
use crate::steps::Campaign;

/// Excess that is noticed. In ordinary rooms it is a thousandth at most, where nothing is wrong.
const NOTICED: f64 = 5e-3;
/// How near to each other two excesses are that have one cause, as a share of the larger.
const ALIKE: f64 = 0.3;
/// Share of the excess that a run may leave of either motion, root mean squares, for it to be a factor's.
const FACTOR: f64 = 0.5;

/// What the channels show of a run's motions over what its standards read, less one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Excess {
    travelling: f64,
    turning: f64,
}

impl Excess {
    /// Of a run along this direction whose standards have gains as found; none where something else than factors makes it depart.
    fn of(run: &ValidationRun, direction: DVec3, found: &Nuisances) -> Option<Self> {
        let gyroscope = found.gyroscope_gain.map_or(0.0, |gain| gain.value);
        let (travelling, left_of_travelling) =
            amount(run, direction, 0, 1.0 + found.accelerometer_gain.value);
        let (turning, left_of_turning) = amount(run, direction, 3, 1.0 + gyroscope);
        let excess = Self {
            travelling: travelling - 1.0,
            turning: turning - 1.0,
        };
        let left = left_of_travelling.max(left_of_turning);
        // Written so that NaN is none.
        (left <= FACTOR * excess.travelling.abs().max(excess.turning.abs())).then_some(excess)
    }

    fn is_noticed(self) -> bool {
        self.travelling.abs() > NOTICED || self.turning.abs() > NOTICED
    }

    fn motion(self) -> Motion {
        let apart = (self.travelling - self.turning).abs();
        let larger = self.travelling.abs().max(self.turning.abs());
        if apart < ALIKE * larger {
            Motion::Both
        } else if self.turning.abs() < ALIKE * larger {
            Motion::Travelling
        } else if self.travelling.abs() < ALIKE * larger {
            Motion::Turning
        } else {
            Motion::EitherOtherwise
        }
    }
}

/// Which motion channels and standards do not agree on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    Travelling,
    Turning,
    Both,
    EitherOtherwise,
}

/// How many times the true motion the channels show along the direction, where the standard reads so many times of it, and what is
/// left of the channels' motion then, as a share, root mean squares. `first` is the motion's first axis in the run's six.
fn amount(run: &ValidationRun, direction: DVec3, first: usize, reading: f64) -> (f64, f64) {
    let along = |row: &[f64; 6]| DVec3::from_slice(&row[first..]).dot(direction);
    let (mut product, mut read, mut shown) = (0.0, 0.0, 0.0);
    for (standard, decoupled) in run.standard.iter().zip(&run.decoupled) {
        product += along(standard) * along(decoupled);
        read += along(standard).powi(2);
        shown += along(decoupled).powi(2);
    }
    let left = (1.0 - product * product / (read * shown)).max(0.0).sqrt();
    (reading * product / read, left)
}

/// What is scaled otherwise in the runs than in the trials that the joint fit saw, or in one kind of these than in the other: that finding
/// is of no recording.
pub(super) fn examine(
    campaign: &Campaign,
    runs: &[ValidationRun],
    joint: &JointReport,
) -> Option<Finding> {
    let found = joint.nuisances();
    let noticed = runs.iter().filter_map(|run| {
        let (trial, _) = campaign.trials.iter().find(|(t, _)| t.name == run.name)?;
        let excess = Excess::of(run, trial.direction_ground, &found)?;
        excess.is_noticed().then_some((run.name.as_str(), excess))
    });
    let noticed: Vec<(&str, Excess)> = noticed.collect();
    let (_, first) = noticed.first()?;
    let is_alike = noticed.iter().all(|(_, e)| e.motion() == first.motion());
    let is_of_all = noticed.len() == runs.len() && runs.len() > 1;
    let of_all = (is_alike && is_of_all).then(|| first.motion());
    let times = |of: fn(&Excess) -> f64| {
        let excesses = noticed.iter().map(|(_, excess)| of(excess));
        significant(1.0 + excesses.sum::<f64>() / noticed.len() as f64, 4)
    };
    let (travelling, turning) = (times(|e| e.travelling), times(|e| e.turning));
    let (why, advice) = match of_all {
        Some(Motion::Turning) => (
            "the angular trials were scaled otherwise than all others, or the gyroscope in compound runs",
            "compare all channels' gain_n_per_v in the angular trials with the amplifier's ranges and with the other recordings, and the gyroscope's sensitivity in compound runs",
        ),
        Some(Motion::Travelling) => (
            "the linear trials were scaled otherwise than all others, or the accelerometer in compound runs",
            "compare all channels' gain_n_per_v in the linear trials with the amplifier's ranges and with the other recordings, and the accelerometer's sensitivity in compound runs",
        ),
        _ => (
            "channels or standards were scaled otherwise there than in the trials",
            "compare gains and the standards' sensitivities there with those of the trials",
        ),
    };
    let evidence = format!(
        "decoupled, the channels show {travelling} times the travel and {turning} times the turn of compound runs by accelerometer and gyroscope, with their gains as found: {why}"
    );
    let finding = Finding::new(Cause::WrongScaling, evidence, advice);
    Some(match of_all {
        Some(Motion::Turning | Motion::Travelling) => finding,
        _ => finding.in_recordings(noticed.into_iter().map(|(name, _)| name)),
    })
}
