//! `sixaxis simulate`: a campaign as a laboratory would have it: recordings, session file and, apart, the truth.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use sixaxis_reference::session::plan::{DefectChoice, Engine, SensorChoice, SessionPlan};
use sixaxis_reference::session::{play::play, write::write};

/// What to play and where to write.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder to write to
    #[arg(long, value_name = "DIR", default_value = "sixaxis-session")]
    out: PathBuf,
    /// Seed of every random number
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Plays and writes a session.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let plan = SessionPlan {
        seed: arguments.seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        defect: DefectChoice::None,
        ..SessionPlan::default()
    };
    let played = play(&plan).context("cannot play the session")?;
    let session = write(&played, &arguments.out, "npz")?;
    println!("{}", session.display());
    Ok(ExitCode::SUCCESS)
}
