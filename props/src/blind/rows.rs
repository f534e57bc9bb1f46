//! Outcomes of many sessions: played, in shards that each leave a row a session, and gathered from these.

use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use sixaxis_reference::laboratory::plan::Engine;

use super::{Outcome, run};
use crate::publication::Arguments;

/// Options of a study that is played in shards, each with something behind it.
pub const OPTIONS: [&str; 3] = ["--rows", "--shard", "--merge"];
/// Sessions between two lines of progress.
const PROGRESS: usize = 50;

/// Plays seeds and judges their sessions, in this order.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn play(seeds: &[u64], engine: Engine) -> Result<Vec<Outcome>, String> {
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

/// Plays one shard, all of it unless `--shard 2/8` says otherwise, of seeds from `--first` on, and writes its rows.
///
/// # Errors
/// Arguments that say nothing, a session that cannot be played, a file that cannot be written.
pub fn write_shard(
    arguments: &Arguments,
    (first, count): (u64, u64),
    engine: Engine,
    path: &str,
) -> Result<(), String> {
    let first = arguments.number("--first", first)?;
    let count = arguments.number("--count", count)?;
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

/// Outcomes of so many seeds in their order, from the rows of these files, separated by commas.
///
/// # Errors
/// A file that cannot be read; rows that are not those of the seeds.
pub fn gathered(files: &str, first: u64, count: u64) -> Result<Vec<Outcome>, String> {
    let mut outcomes = files.split(',').try_fold(Vec::new(), |mut all, file| {
        all.extend(read(file)?);
        Ok::<_, String>(all)
    })?;
    outcomes.sort_by_key(|outcome| outcome.seed);
    let wanted = first..first + count;
    if outcomes.iter().map(|outcome| outcome.seed).eq(wanted) {
        return Ok(outcomes);
    }
    Err(format!(
        "{} rows, which are not those of seeds {first} to {}",
        outcomes.len(),
        first + count - 1
    ))
}

fn read(file: &str) -> Result<Vec<Outcome>, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{file}: {e}"))?;
    text.lines()
        .map(|line| serde_json::from_str(line).map_err(|e| format!("{file}: {e}")))
        .collect()
}
