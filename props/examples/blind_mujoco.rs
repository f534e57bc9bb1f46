//! Blind trials whose sessions MuJoCo and the engine with rigid limbs both play: `cargo run --release -p sixaxis-props --example blind_mujoco`.
//!
//! One session of each sort of laboratory and of each kind of defect, of which MuJoCo takes half a minute each. `--rows FILE`, with `--shard 2/8`, leaves MuJoCo's rows, and
//! `--merge FILE,FILE,...` takes them up, as in the example `blind`. `--publish` writes `props/results/blind_mujoco.json`.

use std::process::ExitCode;

use sixaxis_props::blind::{CYCLE, pairs, rows};
use sixaxis_props::publication::{self, Arguments, Seeds};
use sixaxis_props::results::BlindPairs;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::Engine;

/// No seed of the example `blind` is among these. The second half of a cycle's defects begins here, and the laboratories of the next
/// follow.
const FIRST: u64 = 9_600_089;
/// Each laboratory of a cycle, and each kind of defect once.
const COUNT: u64 = CYCLE - Kind::ALL.len() as u64;

fn main() -> ExitCode {
    publication::end(asked())
}

fn asked() -> Result<(), String> {
    let arguments = Arguments::given(&rows::OPTIONS)?;
    if let Some(path) = arguments.text("--rows") {
        return rows::write_shard(&arguments, (FIRST, COUNT), Engine::Mujoco, path);
    }
    let seeds = Seeds::alone(FIRST, COUNT);
    arguments.obey(seeds, |first, count| study(first, count, &arguments))
}

fn study(first: u64, count: u64, arguments: &Arguments) -> Result<BlindPairs, String> {
    let seeds: Vec<u64> = (first..first + count).collect();
    let mujoco = match arguments.text("--merge") {
        Some(files) if count >= COUNT => rows::gathered(files, first, count)?,
        _ => rows::play(&seeds, Engine::Mujoco)?,
    };
    let found = pairs::of(mujoco, &rows::play(&seeds, Engine::Rigid)?);
    for (what, share) in [
        ("same grade", found.same_grade),
        ("same cause", found.same_cause),
        ("promise kept or broken by both", found.same_promise),
        (
            "by MuJoCo: good, and should not be, of all",
            found.mujoco.false_good,
        ),
    ] {
        println!(
            "{what}: {} of {} ({:.1} to {:.1} %)",
            share.count,
            share.of,
            100.0 * share.low_95,
            100.0 * share.high_95
        );
    }
    for pair in &found.differing {
        println!("{pair:?}");
    }
    Ok(found)
}
