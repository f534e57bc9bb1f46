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
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Result {
    /// [`crate::sites::Mutant::name`].
    pub mutant: String,
    /// The test that failed.
    pub caught_by: Option<String>,
    /// Tests that passed, each with when its program was written.
    pub passed: Vec<(String, String)>,
    /// Whether no test that comes by its place is left.
    pub complete: bool,
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

/// Goes on with one, starting no test that is expected to spend more than `budget_s` of processor time in all.
fn go_on(
    out: &Path,
    one: &Drawn,
    tests: &[Test],
    known: &Result,
    budget_s: f64,
    records: &Mutex<Vec<Record>>,
) -> Result {
    let mut result = known.clone();
    result.mutant = one.mutant.name();
    let key = |test: &Test| (test.label.clone(), test.written.to_string());
    let reached = |&i: &usize| tests[i].reached.contains(&one.id);
    let mut left: BTreeSet<usize> = (0..tests.len()).filter(reached).collect();
    result.reached_by = left.len();
    left.retain(|&i| !result.passed.contains(&key(&tests[i])));
    loop {
        let price = |&i: &usize| {
            let Record { tried, failed } = records.lock().expect("no job panics")[i];
            // As if it had failed once in three before.
            (tests[i].cost_s + 0.03) * (tried + 3.0) / (failed + 1.0)
        };
        result.complete = left.is_empty();
        let affordable = |&i: &usize| result.cost_s + tests[i].cost_s <= budget_s;
        let next = left
            .iter()
            .copied()
            .filter(affordable)
            .min_by(|a, b| price(a).total_cmp(&price(b)));
        let Some(next) = next else { return result };
        left.remove(&next);
        let test = &tests[next];
        let limit_s = 5.0 + 6.0 * test.cost_s;
        let ended = test.run(out, ("SIXAXIS_MUTANT", &one.id.to_string()), limit_s);
        result.cost_s += ended.cost_s;
        let mut records = records.lock().expect("no job panics");
        records[next].tried += 1.0;
        if !ended.passed {
            records[next].failed += 1.0;
            result.caught_by = Some(test.label.clone());
            result.complete = true;
            return result;
        }
        result.passed.push(key(test));
    }
}

/// One by itself.
pub fn run_one(out: &Path, one: &Drawn, tests: &[Test]) -> Result {
    let records = Mutex::new(vec![Record::default(); tests.len()]);
    go_on(out, one, tests, &Result::default(), f64::INFINITY, &records)
}

/// Results kept by an earlier run.
pub fn known(out: &Path) -> BTreeMap<String, Result> {
    let text = fs::read_to_string(out.join("results.jsonl")).unwrap_or_default();
    text.lines()
        .filter_map(|line| serde_json::from_str::<Result>(line).ok())
        .map(|result| (result.mutant.clone(), result))
        .collect()
}

/// Tries all of `mutants`, writing each result as it comes: all with a second of processor time, those left with five, and so on up
/// to `budget_s`, so that whatever time there is decides on as many as it can.
pub fn run(
    out: &Path,
    mutants: &[&Drawn],
    tests: &[Test],
    jobs: usize,
    budget_s: f64,
    results: &mut BTreeMap<String, Result>,
) {
    let records = Mutex::new(vec![Record::default(); tests.len()]);
    let mut budget = 1.0_f64;
    loop {
        budget = budget.min(budget_s);
        let open = |one: &&&Drawn| {
            let known = results.get(&one.mutant.name());
            known.is_none_or(|r| !r.complete)
        };
        let open: Vec<&Drawn> = mutants.iter().filter(open).copied().collect();
        println!("{} with {budget} s", open.len());
        let new = round(out, &open, tests, jobs, budget, results, &records);
        results.extend(new.into_iter().map(|r| (r.mutant.clone(), r)));
        if budget >= budget_s {
            return;
        }
        budget *= 5.0;
    }
}

fn round(
    out: &Path,
    open: &[&Drawn],
    tests: &[Test],
    jobs: usize,
    budget_s: f64,
    known: &BTreeMap<String, Result>,
    records: &Mutex<Vec<Record>>,
) -> Vec<Result> {
    let done = Mutex::new(Vec::new());
    let next = AtomicUsize::new(0);
    let nothing = Result::default();
    thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                while let Some(one) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let before = known.get(&one.mutant.name()).unwrap_or(&nothing);
                    let result = go_on(out, one, tests, before, budget_s, records);
                    let mut done = done.lock().expect("no job panics");
                    append(out, &result);
                    let fate = match &result.caught_by {
                        Some(test) => test,
                        None if result.complete => "SURVIVES",
                        None => "open",
                    };
                    println!(
                        "{}/{} {:6.1} s, {} of {} tests: {}: {fate}",
                        done.len() + 1,
                        open.len(),
                        result.cost_s,
                        result.passed.len(),
                        result.reached_by,
                        result.mutant,
                    );
                    done.push(result);
                }
            });
        }
    });
    done.into_inner().expect("no job panics")
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
