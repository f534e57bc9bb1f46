//! `sixaxis man`: manual pages, one for the command and one for each subcommand.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::Command;
use clap_mangen::Man;
use sixaxis_recordings::draft::write_atomically;

use super::common::print;
use super::output::make_folder;

/// Which pages, and where to.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Subcommand whose page is printed, as in `campaign run`; without it, the page of the command itself
    #[arg(value_name = "SUBCOMMAND", conflicts_with = "out")]
    subcommand: Vec<String>,
    /// Folder to write all pages to: sixaxis.1, sixaxis-decouple.1, sixaxis-campaign-run.1 ...
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

const AFTER_HELP: &str = include_str!("man.txt");

/// Prints a page, or writes all.
pub fn run(arguments: &Arguments, mut command: Command) -> Result<ExitCode> {
    // Gives each subcommand the name under which it is called: `sixaxis-campaign-run`.
    command.build();
    if let Some(folder) = &arguments.out {
        make_folder(folder)?;
        let mut open = vec![command];
        while let Some(command) = open.pop() {
            let (name, page) = page(&command)?;
            let path = folder.join(format!("{name}.1"));
            write_atomically(&path, page.as_bytes())?;
            print(format!("{}\n", path.display()))?;
            open.extend(documented(&command).cloned());
        }
        return Ok(ExitCode::SUCCESS);
    }
    for name in &arguments.subcommand {
        let found = documented(&command).find(|c| c.get_name() == name.as_str());
        match found.cloned() {
            Some(found) => command = found,
            None => bail!("no subcommand {name:?}; `sixaxis help` lists them"),
        }
    }
    print(page(&command)?.1)?;
    Ok(ExitCode::SUCCESS)
}

fn documented(command: &Command) -> impl Iterator<Item = &Command> {
    let subcommands = command.get_subcommands();
    subcommands.filter(|c| c.get_name() != "help" && !c.is_hide_set())
}

/// The name of a command's page and the page, roff.
fn page(command: &Command) -> Result<(String, String)> {
    let name = command.get_display_name().unwrap_or("sixaxis").to_owned();
    let mut page = Vec::new();
    Man::new(command.clone())
        .title(name.to_uppercase())
        .render(&mut page)?;
    Ok((name, String::from_utf8(page)?))
}
