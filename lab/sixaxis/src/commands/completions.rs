//! `sixaxis completions`: what a shell wants to know of the command.

use std::process::ExitCode;

use anyhow::Result;
use clap::Command;
use clap_complete::Shell;

use super::common::print;

/// Which shell.
#[derive(clap::Args)]
pub struct Arguments {
    /// Shell to write for
    shell: Shell,
}

/// Writes the completions of a command to standard output.
pub fn run(arguments: &Arguments, mut command: Command) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "sixaxis", &mut script);
    print(String::from_utf8(script)?)?;
    Ok(ExitCode::SUCCESS)
}
