//! k/m from taps played in MuJoCo, by the hundred: `cargo run --release -p sixaxis-props --example tap`.
//!
//! Prints how the errors compare with the Cramér-Rao bound, and with `--publish` writes what README and the report show.

use std::process::ExitCode;

use rayon::prelude::*;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::Taps;
use sixaxis_props::taps::{Case, NOISE_SHARE, Outcome, Tally, bound_ln};
use sixaxis_reference::mujoco::model::DAMPING_RATIO;
use sixaxis_reference::rig::tap::{DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE};

/// Seeds below were looked at while the fit was written.
const REPORTED_FROM: u64 = 1_000;
/// Other dampings than the reference's, each with a fifth of the taps.
const OTHER_DAMPINGS: [f64; 3] = [0.005, 0.01, 0.05];
/// Taps of which the reference's own error is measured.
const HALVED: u64 = 20;

fn main() -> ExitCode {
    let (first, count) = (REPORTED_FROM, 500);
    run(
        Seeds {
            first,
            count,
            sample: 5,
        },
        study,
    )
}

fn study(first: u64, count: u64) -> Result<Taps, String> {
    println!(
        "seeds {first} to {}, noise {NOISE_SHARE} of the peak",
        first + count - 1
    );
    let halved: Vec<f64> = (first..first + HALVED.min(count))
        .into_par_iter()
        .map(reference_error)
        .collect::<Result<_, String>>()?;
    let reference_error_over_bound = halved.into_iter().fold(0.0, f64::max);
    println!(
        "halving MuJoCo's step moves ln k/m by at most {reference_error_over_bound:.1e} of the bound"
    );
    println!(
        "{:>8} {:>6} {:>8} {:>10} {:>10} {:>10} {:>8} {:>8} {:>8} {:>8}",
        "damping",
        "taps",
        "refused",
        "rms error",
        "med bound",
        "max bound",
        "in bar",
        "sd/bnd",
        "bias/bnd",
        "cover"
    );
    let mut tallies = Vec::new();
    for damping in [DAMPING_RATIO].into_iter().chain(OTHER_DAMPINGS) {
        let taps = if damping == DAMPING_RATIO {
            count
        } else {
            count / 5
        };
        let outcomes: Vec<Result<Outcome, String>> = (first..first + taps)
            .into_par_iter()
            .map(|seed| Outcome::of(seed, damping, NOISE_SHARE))
            .collect();
        for error in outcomes.iter().filter_map(|o| o.as_ref().err()) {
            println!("refused: {error}");
        }
        let known: Vec<Outcome> = outcomes.into_iter().flatten().collect();
        for outcome in known.iter().filter(|o| !o.determined) {
            println!("undetermined: {outcome:?}");
        }
        let t = Tally::of(damping, taps as usize, &known);
        println!(
            "{:>8} {:>6} {:>8} {:>10.2e} {:>10.2e} {:>10.2e} {:>8.3} {:>8.3} {:>8.3} {:>8.3}",
            t.damping_ratio,
            t.taps,
            t.refused,
            t.rms_error_ln,
            t.median_bound_ln,
            t.largest_bound_ln,
            t.share_within_bar,
            t.deviation_over_bound,
            t.bias_over_bound,
            t.coverage_95
        );
        tallies.push(t);
    }
    Ok(Taps {
        first_seed: first,
        noise_over_peak: NOISE_SHARE,
        sample_rate_hz: SAMPLE_RATE_HZ,
        duration_s: DURATION_S,
        reference_error_over_bound,
        tallies,
    })
}

/// Change of ln k/m from the same noise on forces simulated with half the step, over the bound.
fn reference_error(seed: u64) -> Result<f64, String> {
    let at = |error: &dyn core::fmt::Display| format!("seed {seed}: {error}");
    let case = Case::random(seed);
    let coarse = case.record(NOISE_SHARE).map_err(|e| at(&e))?;
    let fine = case
        .record_stepped(NOISE_SHARE, 2 * STEPS_PER_SAMPLE)
        .map_err(|e| at(&e))?;
    let tap = case.identify(&coarse).map_err(|e| at(&e))?;
    let finer = case.identify(&fine).map_err(|e| at(&e))?;
    let change = case.error_ln(&tap) - case.error_ln(&finer);
    Ok(change.abs() / bound_ln(&case, &coarse, &tap.fitted))
}
