//! Whether calibrations of ordinary rooms keep what they state: `cargo run --release -p sixaxis-props --example rooms`.
//!
//! So many healthy sessions of each of the two rooms of the blind trials, written to disk and calibrated from their files, and every tenth of
//! them with a channel that is another in the angular trials. With `--publish`
//! it writes `props/results/rooms.json`.

use std::process::ExitCode;

use sixaxis_props::blind::rooms::played;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::Rooms;

/// First of the seeds, none of which a threshold was chosen with.
const REPORTED_FROM: u64 = 16_000_000;
/// Sessions of each room: a share of 95 % has a standard error of 0.7 %.
const COUNT: u64 = 1_000;

fn main() -> ExitCode {
    let seeds = Seeds {
        first: REPORTED_FROM,
        count: COUNT,
        sample: 2,
    };
    run(seeds, |first, count| {
        let rooms = Rooms {
            first_seed: first,
            rooms: played(first, count)?,
        };
        print(&rooms);
        Ok(rooms)
    })
}

fn print(published: &Rooms) {
    for room in &published.rooms {
        println!(
            "{:?} room: {} of {} sessions by the joint fit",
            room.room, room.by_joint_fit, room.sessions
        );
        for one in &room.intervals {
            let share = one.held;
            println!(
                "{:>8} held in {:>4} of {:>4}: {:.1} % ({:.1} to {:.1} %)",
                one.parameter.to_string(),
                share.count,
                share.of,
                100.0 * share.value(),
                100.0 * share.low_95,
                100.0 * share.high_95
            );
        }
        println!(
            "ground axes: {:.3} % of the values of {} runs within {} stated deviations, at least {:.3} % in 95 % of the runs; all within {:.2}",
            100.0 * room.values_within,
            room.runs,
            room.deviations,
            100.0 * room.values_within_95.unwrap_or(f64::NAN),
            room.largest_95.unwrap_or(f64::NAN)
        );
        for one in &room.one_kind {
            println!(
                "a channel that shows {:.0} % less in the angular trials: {} of {} called good, the channel named in {}",
                100.0 * one.less,
                one.good.count,
                one.good.of,
                one.named.count
            );
        }
    }
}
