//! `sixaxis campaign`: calibrations by the thousand, and what they say of the method.

mod run;
mod summary;

use std::process::ExitCode;

use anyhow::Result;
use clap::Subcommand;

/// What to do.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    #[command(subcommand)]
    task: Task,
}

const AFTER_HELP: &str = include_str!("campaign.txt");

#[derive(Subcommand)]
enum Task {
    /// Play and calibrate one session for each seed and write a row for each, as Parquet
    Run(run::Arguments),
    /// Sum up: bias, attained over stated errors and coverage of each of the 25 parameters
    Summary(summary::Arguments),
}

/// Runs or sums up.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    match &arguments.task {
        Task::Run(arguments) => run::run(arguments),
        Task::Summary(arguments) => summary::run(arguments),
    }
}
