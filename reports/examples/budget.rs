//! The budget of 7.479 %: what one imperfection at a time does to the decoupled accelerations of Tables 4 to 6, in MuJoCo.
//!
//! ```text
//! cargo run --release -p sixaxis-reports --example budget [-- --first SEED] [--publish]
//! ```
//!
//! `--publish` writes `props/results/budget.json`.

use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use sixaxis_props::publication::{Arguments, end};
use sixaxis_props::results::Errors;
use sixaxis_reports::study::budget;

fn main() -> ExitCode {
    end(run())
}

fn run() -> Result<(), String> {
    let arguments = Arguments::given();
    let first = arguments.number("--first", 1)?;
    let done = AtomicU64::new(0);
    let progress = |_: &str, total, more| {
        let done = done.fetch_add(more, Ordering::Relaxed) + more;
        eprintln!("{done} of {total} laboratories");
    };
    let result = budget::study(first, &progress).map_err(|error| format!("{error:#}"))?;
    println!(
        "largest (median) of 18 cells, %: true parameters open, corrected; identified open, corrected"
    );
    println!("nothing: {}", shown(&result.nothing));
    for ladder in &result.ladders {
        println!("{} ({})", ladder.name, ladder.unit);
        for step in &ladder.steps {
            println!("  {:>7}: {}", step.size, shown(&step.errors));
        }
        match ladder.alone {
            Some(size) => println!("  alone makes the paper's error at {size:.3e}"),
            None => println!("  alone does not make the paper's error"),
        }
    }
    for combination in &result.combinations {
        println!("{}: {}", combination.name, shown(&combination.errors));
        for part in &combination.parts {
            println!("  {} {:.3e} ({})", part.name, part.size, part.unit);
        }
    }
    arguments.publish(&result)
}

fn shown(errors: &Errors) -> String {
    let all = [errors.with_truth, errors.identified];
    let cells = all.iter().flat_map(|t| [t.open_loop, t.corrected]);
    let texts = cells.map(|c| format!("{:9.4} ({:8.4})", 100.0 * c.largest, 100.0 * c.median));
    texts.collect::<Vec<_>>().join(" ")
}
