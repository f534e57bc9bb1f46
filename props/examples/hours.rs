//! Hours of motion, open loop and with aids: `cargo run --release -p sixaxis-props --example hours`.
//!
//! With `--publish` it writes what the report shows; its samples, which `--check` plays again, are the first [`SAMPLE_S`] seconds of motions.

use std::process::ExitCode;

use sixaxis_props::aided::Played;
use sixaxis_props::aided::hours::{Length, study};
use sixaxis_props::publication::{Seeds, run};

/// Seeds below were looked at while the filter was written.
const REPORTED_FROM: u64 = 30_000;
/// Motions of a sample, and how long they are, s.
const SAMPLE: u64 = 1;
const SAMPLE_S: f64 = 600.0;
const HOUR: Length<'_> = Length {
    played: Played::InEquilibrium,
    duration_s: 3600.0,
    times_s: &[
        1.0, 3.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 3599.9,
    ],
};

fn main() -> ExitCode {
    let seeds = Seeds {
        first: REPORTED_FROM,
        count: 32,
        sample: SAMPLE,
    };
    run(seeds, |first, count| {
        let duration_s = match count == SAMPLE {
            true => SAMPLE_S,
            false => HOUR.duration_s,
        };
        let length = Length { duration_s, ..HOUR };
        Ok(study(&length, first, count))
    })
}
