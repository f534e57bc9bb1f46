//! How the core's time depends on what it is asked: on scheme and sample rate, on the length of a record, on the number of
//! streams. What the report's section on speed shows.
//!
//! `cargo run --release -p sixaxis-benches -F studies --example speed` writes `target/speed/speed.json` in a few minutes. With
//! `--publish` it then merges that with what `benches/peers/run` left in `target/peers` and with the instruction counts
//! into `benches/results/speed.json`, which the report embeds, and a digest of core's sources, by which a test refuses the
//! file once the core has changed. Both must have been measured at one commit with nothing changed since. `--quick` shows
//! whether it works; its times are rough.
//!
//! Nothing is timed before its answer has been held against the truth, or against push, which was. Times
//! are medians over rounds in which everything that is compared takes its turn, there and back.

mod comparison;
mod length;
mod precision;
mod streams;
mod timing;

use std::env;
use std::error::Error;
use std::fs;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use serde::Serialize;
use sixaxis_core::Scheme;
use sixaxis_props::results::{CoreSpeed, Instructions, Peers, Published, Speed};

use length::{LONG_SCHEME, length};
use precision::{validated, work_precision};
use sixaxis_benches::machine::machine;
use sixaxis_props::provenance::{date_utc, output, workspace};
use streams::streams;
use timing::{FULL, Progress, QUICK};

/// Where cargo builds, and where `benches/peers/run` leaves its results.
fn target() -> PathBuf {
    workspace().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// What the peers took, as `benches/peers/run` left it.
///
/// # Errors
/// If that was not this commit's core.
fn peers(commit: &str, core_changed: bool) -> Result<Peers, Box<dyn Error>> {
    let path = target().join("peers/results.json");
    let text = fs::read_to_string(path).map_err(|e| {
        format!("no target/peers/results.json ({e}); `benches/peers/run` writes it")
    })?;
    let peers: Peers = serde_json::from_str(&text)?;
    if core_changed || peers.changed_since_commit || peers.commit.as_deref() != Some(commit) {
        return Err(
            "core and peers must be measured at the same commit, with nothing changed since: \
                    commit, then run benches/peers/run"
                .into(),
        );
    }
    Ok(peers)
}

/// The counts that `.ci/instructions` holds the core to; none if there is no such file.
fn instructions() -> Result<Option<Instructions>, Box<dyn Error>> {
    match fs::read_to_string(workspace().join("benches/instructions.json")) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(_) => Ok(None),
    }
}

fn write(path: &Path, value: &impl Serialize) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(path.parent().unwrap_or(path))?;
    fs::write(path, serde_json::to_string_pretty(value)? + "\n")?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut quick, mut publish) = (false, false);
    for argument in env::args().skip(1) {
        match &argument[..] {
            "--quick" => quick = true,
            "--publish" => publish = true,
            _ => return Err("arguments are --quick and --publish, both or none".into()),
        }
    }
    let commit = output("git", &["rev-parse", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let core_changed = output("git", &["diff", "--quiet", "HEAD", "--", "core"]).is_none();
    // Before minutes of work, not after them.
    let peers = publish.then(|| peers(&commit, core_changed)).transpose()?;
    let effort = if quick { &QUICK } else { &FULL };
    let progress = Progress {
        shown: std::io::stderr().is_terminal(),
    };
    let scheme = Scheme::default();
    progress.say("simulating the compound run");
    let recorded = validated(scheme);
    validated(LONG_SCHEME);
    // First, while the program's memory is small.
    let length = length(&recorded, LONG_SCHEME, effort, &progress);
    let streams = streams(&recorded, scheme, effort, &progress);
    let speed = CoreSpeed {
        date_utc: date_utc(),
        commit,
        core_changed_since_commit: core_changed,
        quick,
        rounds: effort.rounds,
        machine: machine(),
        work_precision: work_precision(effort, &progress)?,
        length,
        streams,
    };
    progress.say("");
    write(&target().join("speed/speed.json"), &speed)?;
    println!("target/speed/speed.json");
    if let Some(peers) = peers {
        let all = Speed {
            speed,
            peers,
            instructions: instructions()?,
        };
        // With its keys in order, as the file has always been.
        write(&workspace().join(Speed::FILE), &serde_json::to_value(all)?)?;
        println!("{}", Speed::FILE);
    }
    Ok(())
}
