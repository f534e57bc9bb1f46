//! Errors in variables: what noise in the channels does to plain least squares and what it does to the joint fit.
//!
//! ```text
//! cargo run --release -p sixaxis-props --example joint [-- --count N] [--first SEED] [--publish]
//! ```
//!
//! `--publish` writes `props/results/joint.json`.

use std::process::ExitCode;

use sixaxis_props::joint::{Fitted, bias_of_scale, small};
use sixaxis_props::publication::{Arguments, end};
use sixaxis_props::results::{Joint, JointLevel};
use sixaxis_props::tolerance::{JOINT_BIAS, PLAIN_BIAS};
use sixaxis_reference::laboratory::plan::SessionPlan;

/// Ratios of signal to noise of the channels, dB. At 60 dB plain least squares shows a quarter of a standard deviation only, and the
/// reference's gyroscope, which takes the rate for straight between samples of 500 Hz, is itself off by a tenth.
const NOISE_DB: [f64; 2] = [40.0, 34.0];
/// Sample rates at which the time of a fit is measured, Hz.
const RATES_HZ: [f64; 2] = [2_000.0, 10_000.0];

fn main() -> ExitCode {
    end(run())
}

fn run() -> Result<(), String> {
    let arguments = Arguments::given();
    let first = arguments.number("--first", 1)?;
    let count = arguments.number("--count", 1_000)?;
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
    for sample_rate_hz in RATES_HZ {
        let plan = SessionPlan {
            sample_rate_hz,
            trials_per_step: 10,
            ..small(first)
        };
        let case = Fitted::of(&plan)?;
        let knowledge = sixaxis_calibration::joint::Knowledge::of(&case.session);
        let start = std::time::Instant::now();
        let again = sixaxis_calibration::joint::fit(
            &case.campaign,
            &case.steps,
            &knowledge,
            sixaxis_calibration::joint::Loss::Squares,
        );
        let seconds = start.elapsed().as_secs_f64();
        let steps = again.map_or(0, |report| report.estimate.iterations);
        println!(
            "30 trials at {sample_rate_hz:.0} Hz fitted in {seconds:.2} s, {steps} Gauss-Newton steps"
        );
    }
    let published = Joint {
        first_seed: first,
        campaigns: count,
        scatter: 1.0 / (count as f64).sqrt(),
        levels,
    };
    arguments.publish(&published)
}
