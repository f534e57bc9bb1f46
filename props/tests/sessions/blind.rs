//! The verdict, tried blind on sessions on disk. By the hundred: `cargo run --release -p sixaxis-props --example blind`.

use rayon::prelude::*;
use sixaxis_props::blind::{Outcome, TUNING_SEEDS, defect_of, run};
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::Engine;

/// Every kind of defect once or twice, and healthy sessions between them.
const SESSIONS: u64 = 27;
/// First seed: beyond those that thresholds were chosen with.
const FIRST: u64 = TUNING_SEEDS.end + 1;

#[test]
fn stat_verdicts_are_right() {
    let seeds = FIRST..FIRST + SESSIONS;
    for kind in Kind::ALL {
        assert!(
            seeds.clone().any(|s| defect_of(s) == Some(kind)),
            "{kind:?} is not tried"
        );
    }
    let folder = std::env::temp_dir().join(format!("sixaxis-blind-test-{}", std::process::id()));
    let outcomes: Vec<Outcome> = seeds
        .into_par_iter()
        .map(|seed| run(seed, Engine::Rigid, &folder).expect("a session plays and is judged"))
        .collect();
    let _ = std::fs::remove_dir(&folder);
    for outcome in &outcomes {
        assert!(
            outcome.verdict_is_right() && outcome.cause_is_right(),
            "{outcome:#?}"
        );
    }
}
