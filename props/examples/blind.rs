//! Blind trials of the verdict, by the thousand: `cargo run --release -p sixaxis-props --example blind -- --publish`.
//!
//! `--first` and `--count` say which seeds. In shards: `--shard 2/8 --rows FILE` plays every eighth of them from the second on and
//! writes a row a session; `--merge FILE,FILE,...` plays nothing and counts the rows of all. The published file is the same bytes
//! either way. `--mujoco` plays with MuJoCo.

use std::io::Write;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use sixaxis_props::blind::{CYCLE, Outcome, REPORTED_FROM, run, table};
use sixaxis_props::publication::{self, Arguments, Seeds};
use sixaxis_props::results::{Blind, BlindTally};
use sixaxis_reference::laboratory::plan::Engine;

/// Sessions that are played unless told otherwise: whole cycles.
const COUNT: u64 = 44 * CYCLE;
/// Sessions between two lines of progress.
const PROGRESS: usize = 50;

fn main() -> ExitCode {
    let arguments = Arguments::given();
    let engine = match arguments.has("--mujoco") {
        true => Engine::Mujoco,
        false => Engine::Rigid,
    };
    if let Some(path) = arguments.text("--rows") {
        return publication::end(shard(&arguments, engine, path));
    }
    let (first, count) = (REPORTED_FROM, COUNT);
    publication::run(
        Seeds {
            first,
            count,
            sample: 3,
        },
        |first, count| study(first, count, engine, &arguments),
    )
}

/// All sessions, or samples of them: from the rows that shards left where these are all of them, played where not.
fn study(first: u64, count: u64, engine: Engine, arguments: &Arguments) -> Result<Blind, String> {
    let wanted = first..first + count;
    let mut outcomes = match arguments.text("--merge") {
        Some(files) if count >= CYCLE => {
            files.split(',').try_fold(Vec::new(), |mut all, file| {
                all.extend(read(file)?);
                Ok::<_, String>(all)
            })?
        }
        _ => play(&wanted.clone().collect::<Vec<_>>(), engine)?,
    };
    outcomes.sort_by_key(|outcome| outcome.seed);
    if !outcomes
        .iter()
        .map(|outcome| outcome.seed)
        .eq(wanted.clone())
    {
        return Err(format!(
            "{} rows, which are not those of seeds {} to {}",
            outcomes.len(),
            wanted.start,
            wanted.end - 1
        ));
    }
    let table = table::of(outcomes, engine);
    print(&table);
    Ok(table)
}

fn shard(arguments: &Arguments, engine: Engine, path: &str) -> Result<(), String> {
    let first = arguments.number("--first", REPORTED_FROM)?;
    let count = arguments.number("--count", COUNT)?;
    let (shard, of) = match arguments.text("--shard") {
        None => (1, 1),
        Some(text) => text
            .split_once('/')
            .and_then(|(shard, of)| Some((shard.parse::<u64>().ok()?, of.parse::<u64>().ok()?)))
            .filter(|(shard, of)| (1..=*of).contains(shard))
            .ok_or_else(|| format!("--shard wants 1/8 to 8/8, say, and has {text:?}"))?,
    };
    let seeds: Vec<u64> = (first..first + count)
        .filter(|seed| (seed - first) % of == shard - 1)
        .collect();
    let mut lines = Vec::new();
    for outcome in play(&seeds, engine)? {
        serde_json::to_writer(&mut lines, &outcome).map_err(|e| e.to_string())?;
        lines.push(b'\n');
    }
    std::fs::write(path, lines).map_err(|e| format!("{path}: {e}"))
}

fn play(seeds: &[u64], engine: Engine) -> Result<Vec<Outcome>, String> {
    let folder = std::env::temp_dir().join(format!("sixaxis-blind-{}", std::process::id()));
    let done = AtomicUsize::new(0);
    let outcomes: Result<Vec<Outcome>, String> = seeds
        .par_iter()
        .map(|seed| {
            let outcome = run(*seed, engine, &folder);
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            if done.is_multiple_of(PROGRESS) {
                let _ = writeln!(std::io::stderr(), "{done} of {} sessions", seeds.len());
            }
            outcome
        })
        .collect();
    let _ = std::fs::remove_dir(&folder);
    outcomes
}

fn read(file: &str) -> Result<Vec<Outcome>, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{file}: {e}"))?;
    text.lines()
        .map(|line| serde_json::from_str(line).map_err(|e| format!("{file}: {e}")))
        .collect()
}

fn print(published: &Blind) {
    let row = |name: &str, t: &BlindTally| {
        let percent =
            |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{:.3}", 100.0 * x));
        println!(
            "{name:<34} {:>5} | {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4} {:>4} | {:>4} | {:>9} {:>9}",
            t.sessions,
            t.good.count,
            t.reserved.count,
            t.not_good.count,
            t.refused.count,
            t.right_cause.count,
            t.no_cause.count,
            t.wrong_cause.count,
            t.false_good.count,
            percent(t.median_parameter_error),
            percent(t.median_decoupling_error),
        );
    };
    println!(
        "{:<34} {:>5} | {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4} {:>4} | {:>4} | {:>9} {:>9}",
        "", "n", "good", "res.", "bad", "ref.", "cau.", "none", "wrg.", "f.g.", "par. %", "dec. %"
    );
    for cell in &published.healthy {
        row(&format!("{:?}", cell.cell), &cell.tally);
    }
    for kind in &published.kinds {
        for bin in &kind.bins {
            let name = format!("{} {:.1e}..{:.1e}", kind.kind.name(), bin.from, bin.to);
            row(&name, &bin.tally);
        }
    }
    for (what, share) in [
        ("good, and should not be, of all", published.false_good),
        ("of those called good", published.false_good_of_good),
        (
            "wrong cause, of all that name one",
            published.wrong_cause_of_named,
        ),
    ] {
        println!(
            "{what}: {} of {}, {:.2} % ({:.2} to {:.2} %)",
            share.count,
            share.of,
            100.0 * share.value(),
            100.0 * share.low_95,
            100.0 * share.high_95
        );
    }
}
