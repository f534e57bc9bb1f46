//! Ten minutes of motion as MuJoCo plays it, open loop and with aids: `cargo run --release -p sixaxis-props --example hours_mujoco`.
//!
//! Some minutes of processor time for each. With `--publish` it writes what the report shows; its samples, which `--check` plays again, are
//! the first [`SAMPLE_S`] seconds of a motion of each kind, at the usual step alone.

use std::process::ExitCode;

use sixaxis_props::aided::Played;
use sixaxis_props::aided::hours::{Length, halved, study};
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::MujocoHours;

/// No seed of the example `hours` is among these.
const REPORTED_FROM: u64 = 31_000;
const STEP_S: f64 = 2.5e-5;
/// Motions of each kind.
const COUNT: u64 = 2;
const SAMPLE_S: f64 = 10.0;
const TEN_MINUTES: Length<'_> = Length {
    played: Played::ByMujoco { step_s: STEP_S },
    duration_s: 600.0,
    times_s: &[1.0, 3.0, 10.0, 20.0, 60.0, 120.0, 300.0, 599.9],
};

fn main() -> ExitCode {
    let seeds = Seeds::alone(REPORTED_FROM, COUNT);
    run(seeds, |first, count| {
        Ok(MujocoHours {
            step_s: STEP_S,
            halved: match count < COUNT {
                true => Vec::new(),
                false => halved(STEP_S, first),
            },
            hours: study(&length(count), first, count),
        })
    })
}

/// Samples are fewer than all.
fn length(count: u64) -> Length<'static> {
    let duration_s = match count < COUNT {
        true => SAMPLE_S,
        false => TEN_MINUTES.duration_s,
    };
    Length {
        duration_s,
        ..TEN_MINUTES
    }
}
