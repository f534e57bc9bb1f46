//! Blind sessions played by MuJoCo, and the same seeds by the engine with rigid limbs:
//! `cargo run --release -p sixaxis-props --example blind_mujoco -- --publish`.
//!
//! MuJoCo takes some 40 s of processor time a session. In shards: `--rows FILE` with `--shard 1/2`, say, plays with MuJoCo alone and
//! writes a row a session; `--merge FILE,FILE,...` takes these instead of playing.

use std::process::ExitCode;

use sixaxis_props::blind::{CYCLE, REPORTED_FROM, pairs, rows};
use sixaxis_props::publication::{self, Arguments, Seeds};
use sixaxis_props::results::BlindPairs;
use sixaxis_reference::laboratory::plan::Engine;

fn main() -> ExitCode {
    let arguments = Arguments::given();
    let (first, count) = (REPORTED_FROM, CYCLE);
    if let Some(path) = arguments.text("--rows") {
        let played = rows::write_shard(&arguments, (first, count), Engine::Mujoco, path);
        return publication::end(played);
    }
    publication::run(
        Seeds {
            first,
            count,
            sample: 1,
        },
        |first, count| study(first, count, &arguments),
    )
}

/// All sessions, or a sample: only rows that are all of them are taken for played.
fn study(first: u64, count: u64, arguments: &Arguments) -> Result<BlindPairs, String> {
    let seeds: Vec<u64> = (first..first + count).collect();
    let mujoco = match arguments.text("--merge") {
        Some(files) if count > 1 => rows::gathered(files, first, count)?,
        _ => rows::play(&seeds, Engine::Mujoco)?,
    };
    let pairs = pairs::of(mujoco, &rows::play(&seeds, Engine::Rigid)?);
    for (what, share) in [
        ("same grade", pairs.same_grade),
        ("same cause", pairs.same_cause),
        ("promise kept or broken alike", pairs.same_promise),
    ] {
        println!("{what}: {} of {}", share.count, share.of);
    }
    for pair in &pairs.differing {
        println!("{pair:?}");
    }
    Ok(pairs)
}
