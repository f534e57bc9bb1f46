//! Errors in variables: what noise in the channels does to plain least squares and what it does to the joint fit.
//!
//! ```text
//! cargo run --release -p sixaxis-props --example joint [-- --count N] [--first SEED] [--publish]
//! ```
//!
//! `--publish` writes `props/results/joint.json`.

use std::process::ExitCode;

use sixaxis_props::joint::bias_of_scale;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{Joint, JointLevel};
use sixaxis_props::tolerance::{JOINT_BIAS, PLAIN_BIAS};

/// Ratios of signal to noise of the channels, dB. At 60 dB plain least squares shows a quarter of a standard deviation only.
const NOISE_DB: [f64; 2] = [40.0, 34.0];

fn main() -> ExitCode {
    let (first, count) = (1, 1_000);
    run(
        Seeds {
            first,
            count,
            sample: 5,
        },
        study,
    )
}

fn study(first: u64, count: u64) -> Result<Joint, String> {
    println!(
        "{count} campaigns a level, seeds from {first}; bias in standard deviations, ± {:.3}",
        1.0 / (count as f64).sqrt()
    );
    let mut levels = Vec::new();
    for noise_db in NOISE_DB {
        let [plain, joint] = bias_of_scale(first..first + count, noise_db)?;
        println!("{noise_db:.0} dB  plain least squares {plain:+.2?}");
        println!("       joint fit           {joint:+.3?}");
        levels.push(JointLevel {
            noise_db,
            plain_least_squares: plain,
            joint_fit: joint,
        });
    }
    let largest = |of: &dyn Fn(&JointLevel) -> [f64; 9]| {
        levels
            .iter()
            .flat_map(of)
            .fold(0.0_f64, |a, b| a.max(b.abs()))
    };
    println!(
        "largest: plain {:.1} (to be shown: above {PLAIN_BIAS}), joint {:.3} (bar {JOINT_BIAS})",
        largest(&|l| l.plain_least_squares),
        largest(&|l| l.joint_fit)
    );
    Ok(Joint {
        first_seed: first,
        campaigns: count,
        scatter: 1.0 / (count as f64).sqrt(),
        levels,
    })
}
