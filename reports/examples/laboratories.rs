//! The largest error of Tables 4 to 6 in many laboratories, before and after identification, open loop and corrected alike.
//!
//! ```text
//! cargo run --release -p sixaxis-reports --example laboratories [-- --count N] [--first SEED] [--publish]
//! ```
//!
//! `--publish` writes `props/results/laboratories.json`.

use std::process::ExitCode;

use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::Laboratories;
use sixaxis_reports::study::plan::Plan;
use sixaxis_reports::study::{laboratories, simulations};

fn main() -> ExitCode {
    run(Seeds::alone(1, 100), study)
}

fn study(first: u64, count: u64) -> Result<Laboratories, String> {
    let plan = Plan {
        seed: 1,
        quick: false,
    };
    let silent = |_: &str, _, _| {};
    let say = |error: anyhow::Error| format!("{error:#}");
    let simulations = simulations::simulate_recorded(&plan, &silent).map_err(say)?;
    let result = laboratories::study(&simulations, first, count, &silent).map_err(say)?;
    println!(
        "largest of 18 cells, seeds {first} to {}",
        first + count - 1
    );
    for (name, way) in result.ways() {
        for (standard, errors) in [("instruments", &way.instruments), ("truth", &way.truth)] {
            let Some(quantiles) = Laboratories::quantiles(errors) else {
                continue;
            };
            println!("{name}, against the {standard}: {quantiles}");
        }
    }
    Ok(result)
}
