//! Coverage of calibrations whose sessions MuJoCo played: `cargo run --release -p sixaxis-props --example campaign_mujoco`.
//!
//! The sessions of `props/results/campaign_mujoco.toml`, some ten seconds of processor time each. `--publish` writes
//! `props/results/campaign_mujoco.json`.

use std::process::ExitCode;

use sixaxis_props::campaign::played;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{MujocoCampaign, Pooled, four_steps_hold, joint_holds};

/// What is varied.
const PLAN: &str = include_str!("../results/campaign_mujoco.toml");

fn main() -> ExitCode {
    let seeds = Seeds::alone(710_001, 48);
    run(seeds, study)
}

fn study(first: u64, count: u64) -> Result<MujocoCampaign, String> {
    let (rows, summary) = played(PLAN, first, count)?;
    let coverage = vec![
        Pooled::of("four steps", &rows, four_steps_hold),
        Pooled::of("joint fit", &rows, joint_holds),
    ];
    for pooled in &coverage {
        let (low, high) = pooled.wilson_95;
        let (from, to) = pooled.by_case_95;
        println!(
            "{}: {} of {} intervals hold, {:.2} %; Wilson {:.2} to {:.2} %, by case {:.2} to {:.2} %",
            pooled.estimator,
            pooled.inside,
            pooled.intervals,
            100.0 * pooled.share(),
            100.0 * low,
            100.0 * high,
            100.0 * from,
            100.0 * to,
        );
    }
    Ok(MujocoCampaign { coverage, summary })
}
