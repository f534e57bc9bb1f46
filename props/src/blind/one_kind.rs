//! Days of ordinary rooms on which one channel shows less in all angular trials than in the others: which of them are called good, and
//! of how many the channel is named.

use std::path::Path;

use rayon::prelude::*;
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::report::Grade;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::plan::Engine;
use sixaxis_reference::laboratory::room::Room;
use sixaxis_reference::laboratory::session::simulate_session;

use super::share::Share;
use super::{Cell, judged_by_files, plan};
use crate::results::OneKind;

/// What the channel shows less, relative.
const SIZES: [f64; 2] = [0.01, 0.02];

/// Days with these seeds, a size at a time.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub(super) fn played(room: Room, seeds: &[u64], folder: &Path) -> Result<Vec<OneKind>, String> {
    let of_size = |less: f64| {
        let days: Result<Vec<Day>, String> = seeds
            .par_iter()
            .map(|seed| {
                Day::played(room, *seed, less, folder)
                    .map_err(|error| format!("seed {seed}: {error}"))
            })
            .collect();
        let days = days?;
        Ok(OneKind {
            less,
            good: Share::of(&days, |day| day.good),
            named: Share::of(&days, |day| day.named),
        })
    };
    SIZES.into_iter().map(of_size).collect()
}

/// What becomes of one.
struct Day {
    /// It is called good.
    good: bool,
    /// The first thing found is that this channel, and no other, changes.
    named: bool,
}

impl Day {
    fn played(room: Room, seed: u64, less: f64, folder: &Path) -> Result<Self, String> {
        let channel = seed as usize % LIMBS;
        let plan = plan(Cell::Room(room), seed, Engine::Rigid);
        let mut played = simulate_session(&plan).map_err(|e| format!("playing: {e}"))?;
        let angular = played
            .recordings
            .iter_mut()
            .filter(|r| r.role == Role::Angular);
        for row in angular.flat_map(|recording| &mut recording.voltage_v) {
            row[channel] *= 1.0 - less;
        }
        let own = folder.join(format!("{room:?}-{seed}-{less}"));
        let judged = judged_by_files(&played, "npz", &own)?;
        let first = judged.as_ref().and_then(|judged| judged.findings.first());
        Ok(Self {
            good: judged
                .as_ref()
                .is_some_and(|judged| judged.grade == Grade::Good),
            named: first.is_some_and(|first| {
                first.cause == Cause::FadingSensitivity && first.channels == [channel + 1]
            }),
        })
    }
}
