//! Calibrations by the thousand, summed up: `cargo run --release -p sixaxis-props --example campaign`.
//!
//! Plays and calibrates the sessions of `props/results/campaign.toml` in memory, as `sixaxis campaign` does, and with `--publish` writes
//! what README and the report show.

use std::process::ExitCode;

use sixaxis_props::campaign::played;
use sixaxis_props::publication::{Seeds, run};

/// What is varied.
const PLAN: &str = include_str!("../results/campaign.toml");

fn main() -> ExitCode {
    let seeds = Seeds {
        first: 1,
        count: 2_000,
        sample: 10,
    };
    run(seeds, |first, count| Ok(played(PLAN, first, count)?.1))
}
