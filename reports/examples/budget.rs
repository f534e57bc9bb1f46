//! The budget of 7.479 %: what imperfections do to the decoupled accelerations of Tables 4 to 6, in MuJoCo, one at a time and together.
//!
//! ```text
//! cargo run --release -p sixaxis-reports --example budget [-- --first SEED] [--count N] [--publish]
//! ```
//!
//! A seed is one laboratory of the study's list. `--publish` writes `props/results/budget.json`.

use std::process::ExitCode;

use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{Budget, Errors, headline};
use sixaxis_reports::study::budget::{FIRST_SEED, laboratories, study};

fn main() -> ExitCode {
    let seeds = Seeds::alone(FIRST_SEED, laboratories());
    run(seeds, |first, count| {
        let found = study(first, count, &shown);
        print(&found);
        Ok(found)
    })
}

fn shown(laboratory: &sixaxis_props::results::Imperfect) {
    let parts = laboratory.parts.iter();
    let parts: Vec<String> = parts
        .map(|p| format!("{} {:e} {}", p.name, p.size, p.unit))
        .collect();
    let errors = match (&laboratory.errors, &laboratory.refused) {
        (Some(errors), _) => cells(errors),
        (None, why) => format!("refused: {}", why.as_deref().unwrap_or_default()),
    };
    println!("{} [{}] {errors}", laboratory.seed, parts.join(", "));
}

/// Largest and median of 18 cells, %: true parameters open loop, corrected; identified open loop, corrected.
fn cells(errors: &Errors) -> String {
    let all = [errors.with_truth, errors.identified];
    let cells = all.iter().flat_map(|t| [t.open_loop, t.corrected]);
    let texts = cells.map(|c| format!("{:.4} ({:.4})", 100.0 * c.largest, 100.0 * c.median));
    texts.collect::<Vec<_>>().join("  ")
}

fn print(found: &Budget) {
    for ladder in found.ladders() {
        match ladder.alone(headline) {
            Some([less, more]) => println!(
                "{}: 7.479 % alone between {less:e} and {more:e} {}",
                ladder.name, ladder.unit
            ),
            None => println!("{}: never 7.479 % alone", ladder.name),
        }
    }
}
