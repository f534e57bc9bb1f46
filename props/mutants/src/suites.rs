//! The tests: what each costs, and which mutants it comes by.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

use crate::tree::Program;

/// One test of one program.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Test {
    /// Program's file.
    pub program: PathBuf,
    /// When it was written: a younger one is traced afresh.
    pub written: u128,
    /// Package's folder.
    pub folder: PathBuf,
    /// Package, program and test.
    pub label: String,
    /// Test.
    pub name: String,
    /// Processor time without a mutant, s.
    pub cost_s: f64,
    /// Whether it passes without a mutant.
    pub passes: bool,
    /// Mutants whose place it comes by.
    pub reached: BTreeSet<u32>,
}

/// Cases of a property: the same for the run without mutants and with.
const CASES: &str = "4";
/// Tests that hold published files against the sources' digests: those of the copy are others.
const ABOUT_FILES: &str = "results::tests::";
/// Address space of a test, KiB: a mutant may ask for any amount.
const MEMORY_KIB: &str = "8000000";

/// How a run ended.
pub struct Ended {
    /// No failure.
    pub passed: bool,
    /// Processor time, s.
    pub cost_s: f64,
}

impl Test {
    /// Runs it with one variable set, for at most `limit_s` of processor time.
    pub fn run(&self, out: &Path, variable: (&str, &str), limit_s: f64) -> Ended {
        let processor = format!("{:.0}", limit_s.ceil());
        // A wait that never ends costs no processor time.
        let wall = format!("{:.0}", 30.0 + 12.0 * limit_s);
        let script = "ulimit -c 0; ulimit -t \"$1\"; ulimit -v \"$2\"; w=$3; shift 3; \
                      timeout -k 5 \"$w\" \"$@\" >/dev/null 2>&1; code=$?; times; exit $code";
        let output = Command::new("bash")
            .args(["-c", script, "bash", &processor, MEMORY_KIB, &wall])
            .arg(&self.program)
            .args(["--exact", &self.name, "--test-threads=1"])
            .current_dir(&self.folder)
            .env("CARGO_MANIFEST_DIR", &self.folder)
            .env("SIXAXIS_CASES", CASES)
            .env("SIXAXIS_EVIDENCE", out.join("evidence"))
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("RAYON_NUM_THREADS", "1")
            .env("RUST_BACKTRACE", "0")
            .env(variable.0, variable.1)
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output()
            .expect("bash runs");
        Ended {
            passed: output.status.success(),
            cost_s: children_s(&String::from_utf8_lossy(&output.stdout)),
        }
    }
}

/// User and system time of the second line of `times`, such as 0m1.230s 0m0.010s.
fn children_s(times: &str) -> f64 {
    let line = times.lines().nth(1).unwrap_or_default();
    let seconds = |word: &str| -> Option<f64> {
        let (minutes, rest) = word.trim_end_matches('s').split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + rest.parse::<f64>().ok()?)
    };
    line.split_whitespace().filter_map(seconds).sum()
}

/// All tests, each run once without a mutant. What an earlier run knows of an unchanged program stays.
pub fn trace(out: &Path, programs: &[Program], jobs: usize, longest_s: f64) -> Vec<Test> {
    let kept = out.join("tests.json");
    let old: Vec<Test> = fs::read(&kept)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let old: BTreeMap<(PathBuf, u128, String), Test> = old
        .into_iter()
        .map(|t| ((t.program.clone(), t.written, t.name.clone()), t))
        .collect();
    let listed: Vec<Test> = programs.iter().flat_map(list).collect();
    let done = Mutex::new(Vec::new());
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        for job in 0..jobs {
            let (listed, old, done, next, kept) = (&listed, &old, &done, &next, &kept);
            scope.spawn(move || {
                while let Some(test) = listed.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let key = (test.program.clone(), test.written, test.name.clone());
                    let known = old
                        .get(&key)
                        .filter(|t| t.passes || t.cost_s >= 0.9 * longest_s);
                    let test = known
                        .cloned()
                        .unwrap_or_else(|| traced(out, test.clone(), job, longest_s));
                    let mut done = done.lock().expect("no job panics");
                    done.push(test);
                    if done.len() % 20 == 0 {
                        keep(kept, &done);
                    }
                }
            });
        }
    });
    let mut tests = done.into_inner().expect("no job panics");
    tests.sort_by(|a, b| a.label.cmp(&b.label));
    keep(&kept, &tests);
    tests
}

fn keep(path: &Path, tests: &[Test]) {
    let bytes = serde_json::to_vec(tests).expect("tests are plain data");
    fs::write(path, bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

fn list(program: &Program) -> Vec<Test> {
    let names = |extra: &[&str]| -> Vec<String> {
        let output = Command::new(&program.path)
            .args(["--list", "--format", "terse"])
            .args(extra)
            .current_dir(&program.folder)
            .output()
            .unwrap_or_else(|e| panic!("{}: {e}", program.path.display()));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let tests = text.lines().filter_map(|l| l.strip_suffix(": test"));
        tests.map(ToOwned::to_owned).collect()
    };
    let ignored: BTreeSet<String> = names(&["--ignored"]).into_iter().collect();
    let written = fs::metadata(&program.path)
        .and_then(|m| m.modified())
        .ok()
        .and_then(|t| t.duration_since(UNIX_EPOCH).ok())
        .map_or(0, |d| d.as_nanos());
    names(&[])
        .into_iter()
        .filter(|name| !ignored.contains(name) && !name.starts_with(ABOUT_FILES))
        .map(|name| Test {
            program: program.path.clone(),
            written,
            folder: program.folder.clone(),
            label: format!("{} {name}", program.name),
            name,
            cost_s: 0.0,
            passes: false,
            reached: BTreeSet::new(),
        })
        .collect()
}

fn traced(out: &Path, mut test: Test, job: usize, longest_s: f64) -> Test {
    let trace = out.join(format!("trace-{job}"));
    let _ = fs::remove_file(&trace);
    let ended = test.run(
        out,
        ("SIXAXIS_MUTANT_TRACE", &trace.to_string_lossy()),
        longest_s,
    );
    let text = fs::read_to_string(&trace).unwrap_or_default();
    // To be traced takes memory, which some tests count.
    test.passes = ended.passed
        || (ended.cost_s < 0.9 * longest_s
            && test.run(out, ("SIXAXIS_MUTANT", "0"), longest_s).passed);
    test.cost_s = ended.cost_s;
    test.reached = text.lines().filter_map(|l| l.parse().ok()).collect();
    test
}
