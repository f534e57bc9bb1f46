//! The Rust side of `benches/peers`: hands out the problem, and answers and times it on request.
//!
//! `serve export DIR` plays the compound run at 5 Hz and writes what every peer reads, in whatever language:
//! `problem.json` (and its numbers as `problem.bin`) and `voltage.bin`; for engines, which do not decode, `states.bin`
//! and `wrench.bin`; and two answers, `oracle.bin` from the oracle and `truth.bin` from MuJoCo. `serve NAME DIR` stays
//! resident and obeys lines on its standard input:
//!
//! * `answer FILE` decodes once and writes six numbers a sample: linear, then angular acceleration, ground axes;
//! * `time R` decodes the record once and then R times, and prints the mean seconds of one of these;
//! * `quit`.
//!
//! Binary files are rows of little-endian f64. An implementation is one line in [`PEERS`].

mod decoders;
mod engines;
mod export;
mod peer;
mod problem;

use std::error::Error;
use std::io::{BufRead, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use decoders::{lanes, paper, push, record};
use engines::mujoco_inverse;
use export::{export, write_rows};
use peer::{Input, Peer};

/// How an implementation is made ready for a record.
type Ready = fn(&Input) -> Box<dyn Peer>;

/// Every implementation by its name.
const PEERS: &[(&str, Ready)] = &[
    ("push", push),
    ("record", |input| record(input, false)),
    ("record_portable", |input| record(input, true)),
    ("lanes", lanes),
    ("paper", paper),
    ("mujoco_inverse", mujoco_inverse),
];

fn serve(mut peer: Box<dyn Peer>) -> Result<(), Box<dyn Error>> {
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_once(' ') {
            Some(("answer", file)) => {
                peer.decode();
                let rows = peer.rows();
                write_rows(Path::new(file), rows.as_flattened())?;
                println!("{}", rows.len());
            }
            Some(("time", repeats)) => {
                let repeats: u32 = repeats.parse()?;
                // Another peer has had the caches.
                peer.decode();
                let start = Instant::now();
                for _ in 0..repeats {
                    peer.decode();
                }
                println!(
                    "{:e}",
                    start.elapsed().as_secs_f64() / f64::from(repeats * peer.records())
                );
            }
            None if line == "quit" => break,
            _ => return Err(format!("no such request: {line}").into()),
        }
        std::io::stdout().flush()?;
    }
    Ok(())
}

fn run(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let names = || {
        PEERS
            .iter()
            .map(|(name, _)| *name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let [task, dir] = arguments else {
        return Err(format!(
            "usage: serve export DIR | serve NAME DIR, NAME one of {}",
            names()
        )
        .into());
    };
    let dir = Path::new(dir);
    if task == "export" {
        return export(dir);
    }
    let Some((_, ready)) = PEERS.iter().find(|(name, _)| name == task) else {
        return Err(format!("no implementation {task}: there are {}", names()).into());
    };
    serve(ready(&Input::read(dir)?))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("serve: {error}");
            ExitCode::FAILURE
        }
    }
}
