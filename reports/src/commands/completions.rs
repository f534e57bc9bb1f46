//! `sixaxis completions` and `sixaxis man`: what a shell and a manual reader want to know of the command.

use std::io::{self, Write};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Command;
use clap_complete::Shell;

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
    print(&script)
}

/// Writes the manual page of a command and of everything it can be asked to do, as roff, to standard output.
pub fn manual(command: &Command) -> Result<ExitCode> {
    let mut pages = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut pages)?;
    for task in command.get_subcommands() {
        let named = task.clone().name(format!("sixaxis {}", task.get_name()));
        clap_mangen::Man::new(named).render(&mut pages)?;
    }
    print(&pages)
}

fn print(text: &[u8]) -> Result<ExitCode> {
    match io::stdout().write_all(text) {
        // Whoever reads may have seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(ExitCode::SUCCESS),
        written => {
            written.context("cannot write to standard output")?;
            Ok(ExitCode::SUCCESS)
        }
    }
}
