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
    // Its own name is the package's.
    render(&command.clone().name("sixaxis"), &mut pages)?;
    print(&pages)
}

/// A page for a command, then one for each of what it can be asked to do.
fn render(command: &Command, pages: &mut Vec<u8>) -> io::Result<()> {
    clap_mangen::Man::new(command.clone()).render(pages)?;
    for task in command.get_subcommands() {
        let name = format!("{} {}", command.get_name(), task.get_name());
        render(&task.clone().name(name), pages)?;
    }
    Ok(())
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
