//! What calibrations state of themselves in ordinary rooms, held against the truth: 95 % intervals parameter by parameter, and the
//! deviations of decoupled accelerations in ground axes.

use core::cmp::Ordering;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;
use sixaxis_calibration::report::Estimator;
use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_reference::laboratory::plan::Engine;
use sixaxis_reference::laboratory::room::Room;

use super::share::Share;
use super::validation_run::ValidationRun;
use super::{Cell, judged, one_kind, plan};
use crate::compare::worse;
use crate::results::{RoomCoverage, RoomIntervals};

/// Deviations within which ground axes are looked for.
pub const DEVIATIONS: f64 = 3.0;
/// Of so many sessions one is played with a channel that is another in one kind of trials, too.
const EVERY: usize = 10;
/// Sessions between two lines of progress.
const PROGRESS: usize = 50;

/// One session.
struct Held {
    /// Whether the joint fit's interval of each parameter holds the truth; none of a parameter that it leaves open.
    intervals: [Option<bool>; PARAMETERS],
    /// Error of each acceleration of each sample over its stated deviation, ground axes, open loop.
    over_deviation: Option<Vec<[f64; 6]>>,
}

/// Plays healthy sessions of both rooms with these seeds and holds what their calibrations state against the truth.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn played(first: u64, count: u64) -> Result<Vec<RoomCoverage>, String> {
    Room::ALL
        .iter()
        .map(|room| in_room(*room, first, count))
        .collect()
}

fn in_room(room: Room, first: u64, count: u64) -> Result<RoomCoverage, String> {
    let folder = std::env::temp_dir().join(format!("sixaxis-rooms-{}", std::process::id()));
    let done = AtomicUsize::new(0);
    let seeds: Vec<u64> = (first..first + count).collect();
    let held: Result<Vec<Option<Held>>, String> = seeds
        .par_iter()
        .map(|seed| {
            let held = held(room, *seed, &folder).map_err(|error| format!("seed {seed}: {error}"));
            let done = 1 + done.fetch_add(1, Relaxed);
            if done.is_multiple_of(PROGRESS) {
                eprintln!("{done} of {count} sessions in the {room:?} room");
            }
            held
        })
        .collect();
    let every_tenth: Vec<u64> = seeds.iter().copied().step_by(EVERY).collect();
    let one_kind = one_kind::played(room, &every_tenth, &folder)?;
    let _ = std::fs::remove_dir(&folder);
    let held: Vec<Held> = held?.into_iter().flatten().collect();
    let intervals = Parameter::all().enumerate().map(|(i, parameter)| {
        let stated: Vec<bool> = held.iter().filter_map(|held| held.intervals[i]).collect();
        RoomIntervals {
            parameter,
            held: Share::of(&stated, |holds| *holds),
        }
    });
    let mut within: Vec<f64> = Vec::new();
    let mut largest: Vec<f64> = Vec::new();
    for run in held.iter().filter_map(|held| held.over_deviation.as_ref()) {
        let all = run.as_flattened();
        let kept = all.iter().filter(|over| **over <= DEVIATIONS).count();
        within.push(kept as f64 / all.len() as f64);
        largest.push(all.iter().copied().fold(0.0, worse));
    }
    let in_95_of_100 = |mut of: Vec<f64>, worst_first: fn(&f64, &f64) -> Ordering| {
        of.sort_by(worst_first);
        of.get(of.len() / 20).copied()
    };
    Ok(RoomCoverage {
        room,
        sessions: count as usize,
        by_joint_fit: held.len(),
        intervals: intervals.collect(),
        deviations: DEVIATIONS,
        runs: within.len(),
        values_within: within.iter().sum::<f64>() / within.len() as f64,
        values_within_95: in_95_of_100(within, f64::total_cmp),
        largest_95: in_95_of_100(largest, |a, b| b.total_cmp(a)),
        one_kind,
    })
}

/// None where the session is refused or calibrated by the four steps.
fn held(room: Room, seed: u64, folder: &Path) -> Result<Option<Held>, String> {
    let plan = plan(Cell::Room(room), seed, Engine::Rigid);
    let own = folder.join(format!("{room:?}-{seed}"));
    let (played, judged) = judged(&plan, "npz", &own)?;
    let Some(judged) = judged.filter(|judged| judged.estimator == Estimator::Joint) else {
        return Ok(None);
    };
    let Some(calibration) = &judged.calibration else {
        return Ok(None);
    };
    let truth = played.truth.parameters.to_paper_order();
    let found = calibration.parameters.to_paper_order();
    Ok(Some(Held {
        intervals: core::array::from_fn(|i| {
            let half_width = calibration.intervals.get(i)?.half_width_95?;
            Some((found[i] - truth[i]).abs() <= half_width)
        }),
        over_deviation: ValidationRun::of(&judged, calibration, &played)
            .and_then(|run| run.over_deviation()),
    }))
}
