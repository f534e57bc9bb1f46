//! `sixaxis decouple`: a recording to six accelerations.

use std::process::ExitCode;

use anyhow::{Result, bail};

/// Not there yet.
#[derive(clap::Args)]
pub struct Arguments {}

/// Not there yet.
pub fn run(_arguments: &Arguments) -> Result<ExitCode> {
    bail!("not there yet")
}
