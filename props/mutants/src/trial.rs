//! Mutant by mutant, the tests that come by it, until one fails.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use serde::{Deserialize, Serialize};

use crate::draw::Drawn;
use crate::suites::Test;

/// What became of a mutant.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Result {
    /// [`crate::sites::Mutant::name`].
    pub mutant: String,
    /// The test that failed; none for a survivor.
    pub caught_by: Option<String>,
    /// Tests run.
    pub tests: usize,
    /// Tests that come by its place.
    pub reached_by: usize,
    /// Processor time, s.
    pub cost_s: f64,
}

/// How often a test was run against a mutant and how often it failed: who catches much for little goes first.
#[derive(Clone, Copy, Default)]
struct Record {
    tried: f64,
    failed: f64,
}

/// Runs one.
fn try_one(out: &Path, one: &Drawn, tests: &[Test], records: &Mutex<Vec<Record>>) -> Result {
    let mut left: BTreeSet<usize> = (0..tests.len())
        .filter(|&i| tests[i].reached.contains(&one.id))
        .collect();
    let reached_by = left.len();
    let id = one.id.to_string();
    let mut cost_s = 0.0;
    let mut run = 0;
    loop {
        let price = |&i: &usize| {
            let Record { tried, failed } = records.lock().expect("no job panics")[i];
            // As if it had failed once in three before.
            (tests[i].cost_s + 0.03) * (tried + 3.0) / (failed + 1.0)
        };
        let next = left
            .iter()
            .copied()
            .min_by(|a, b| price(a).total_cmp(&price(b)));
        let Some(next) = next else { break };
        left.remove(&next);
        let test = &tests[next];
        let limit_s = 5.0 + 6.0 * test.cost_s;
        let ended = test.run(out, ("SIXAXIS_MUTANT", &id), limit_s);
        run += 1;
        cost_s += ended.cost_s;
        let mut records = records.lock().expect("no job panics");
        records[next].tried += 1.0;
        if !ended.passed {
            records[next].failed += 1.0;
            return Result {
                mutant: one.mutant.name(),
                caught_by: Some(test.label.clone()),
                tests: run,
                reached_by,
                cost_s,
            };
        }
    }
    Result {
        mutant: one.mutant.name(),
        caught_by: None,
        tests: run,
        reached_by,
        cost_s,
    }
}

/// One by itself.
pub fn run_one(out: &Path, one: &Drawn, tests: &[Test]) -> Result {
    try_one(
        out,
        one,
        tests,
        &Mutex::new(vec![Record::default(); tests.len()]),
    )
}

/// Results kept by an earlier run.
pub fn known(out: &Path) -> BTreeMap<String, Result> {
    let text = fs::read_to_string(out.join("results.jsonl")).unwrap_or_default();
    text.lines()
        .filter_map(|line| serde_json::from_str::<Result>(line).ok())
        .map(|result| (result.mutant.clone(), result))
        .collect()
}

/// Tries all of `mutants`, writing each result as it comes.
pub fn run(out: &Path, mutants: &[&Drawn], tests: &[Test], jobs: usize) -> Vec<Result> {
    let records = Mutex::new(vec![Record::default(); tests.len()]);
    let results = Mutex::new(Vec::new());
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                while let Some(one) = mutants.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let result = try_one(out, one, tests, &records);
                    let mut results = results.lock().expect("no job panics");
                    append(out, &result);
                    println!(
                        "{}/{} {:6.1} s, {} of {} tests: {}: {}",
                        results.len() + 1,
                        mutants.len(),
                        result.cost_s,
                        result.tests,
                        result.reached_by,
                        result.mutant,
                        result.caught_by.as_deref().unwrap_or("SURVIVES")
                    );
                    results.push(result);
                }
            });
        }
    });
    results.into_inner().expect("no job panics")
}

fn append(out: &Path, result: &Result) {
    let line = serde_json::to_string(result).expect("plain data");
    OpenOptions::new()
        .append(true)
        .create(true)
        .open(out.join("results.jsonl"))
        .and_then(|mut file| writeln!(file, "{line}"))
        .expect("results can be written");
}
