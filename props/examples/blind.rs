//! Blind trials of the verdict, by the hundred: `cargo run --release -p sixaxis-props --example blind`.
//!
//! Prints what became of each kind of defect, every session that was judged wrongly in full, and with `--publish` writes the
//! table that README and the report show.

use std::collections::BTreeMap;
use std::process::ExitCode;

use rayon::prelude::*;
use sixaxis_props::blind::{Outcome, REPORTED_FROM, run};
use sixaxis_props::publication::{Arguments, Seeds, run as publish};
use sixaxis_props::results::{Blind, BlindKind};
use sixaxis_reference::laboratory::plan::Engine;

fn main() -> ExitCode {
    let (first, count) = (REPORTED_FROM, 300);
    publish(
        Seeds {
            first,
            count,
            sample: 3,
        },
        try_all,
    )
}

fn try_all(first: u64, count: u64) -> Result<Blind, String> {
    let engine = if Arguments::given().has("--mujoco") {
        Engine::Mujoco
    } else {
        Engine::Rigid
    };
    let folder = std::env::temp_dir().join(format!("sixaxis-blind-{}", std::process::id()));
    let outcomes: Result<Vec<Outcome>, String> = (first..first + count)
        .into_par_iter()
        .map(|seed| run(seed, engine, &folder))
        .collect();
    let _ = std::fs::remove_dir(&folder);
    let outcomes = outcomes?;
    let mut kinds: BTreeMap<String, BlindKind> = BTreeMap::new();
    for outcome in &outcomes {
        let name = outcome
            .kind
            .map_or_else(|| "healthy".to_owned(), |kind| format!("{kind:?}"));
        let row = kinds.entry(name).or_default();
        row.sessions += 1;
        row.right_verdict += usize::from(outcome.verdict_is_right());
        row.right_cause += usize::from(outcome.cause_is_right());
    }
    println!(
        "{:<20} {:>8} {:>14} {:>12}",
        "defect", "sessions", "right verdict", "right cause"
    );
    for (name, row) in &kinds {
        println!(
            "{name:<20} {:>8} {:>14} {:>12}",
            row.sessions, row.right_verdict, row.right_cause
        );
    }
    let wrong: Vec<Outcome> = outcomes
        .iter()
        .filter(|o| !o.verdict_is_right() || !o.cause_is_right())
        .cloned()
        .collect();
    for outcome in &wrong {
        println!(
            "\nseed {}: {:?} {}\n  {:?}: {}",
            outcome.seed, outcome.kind, outcome.particulars, outcome.grade, outcome.sentence
        );
        for line in outcome.evidence.iter().chain(&outcome.reservations).take(5) {
            println!("  {line}");
        }
    }
    let tally = |of: fn(&Outcome) -> bool| outcomes.iter().filter(|o| of(o)).count();
    let published = Blind {
        first_seed: first,
        sessions: outcomes.len(),
        engine,
        right_verdict: tally(Outcome::verdict_is_right),
        right_cause: tally(Outcome::cause_is_right),
        broken_promises: tally(Outcome::is_broken_promise),
        healthy: tally(|o| o.kind.is_none()),
        false_alarms: tally(Outcome::is_false_alarm),
        kinds,
        wrong,
    };
    println!(
        "\n{} sessions from seed {first}: verdict right {} ({:.2} %), cause right {} ({:.2} %), defects called good {}, false alarms {} of {}",
        published.sessions,
        published.right_verdict,
        100.0 * published.right_verdict as f64 / published.sessions as f64,
        published.right_cause,
        100.0 * published.right_cause as f64 / published.sessions as f64,
        published.broken_promises,
        published.false_alarms,
        published.healthy,
    );
    Ok(published)
}
