//! The `sixaxis` command.

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

mod commands;
mod progress;
use commands::{
    calibrate, campaign, compare, completions, decouple, inspect, man, model, report,
    self_calibrate, simulate,
};

/// Mathematics of a parallel six-axis accelerometer, verified against MuJoCo.
#[derive(Parser)]
#[command(name = "sixaxis", version, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
}

/// Where to start, and what scripts want to know.
const AFTER_HELP: &str = "\
Start with:
  sixaxis report                                 the paper's campaign against MuJoCo
  sixaxis simulate --out day                     a laboratory's day: recordings and session file
  sixaxis calibrate day/session.toml             25 parameters, their intervals, a verdict
  sixaxis decouple calibration.json run.tdms     six accelerations from nine voltages
  sixaxis campaign --help                        thousands of calibrations: do the intervals hold?

Exit codes: 0 done, and the verdict is good; 1 it could not be done; 2 the command line says something that is not understood;
3 done, good with reservations; 4 done, not good.";

#[derive(Subcommand)]
enum Task {
    /// Play the paper's calibration campaign on MuJoCo and write an offline HTML report
    ///
    /// Writes report.html, results.json (every number in it; the same seed gives the same file, bit for bit), run.json
    /// (machine, duration), figures/*.svg and evidence.csv (random motions and, once the tests have been run, every
    /// comparison they made) to the output folder.
    Report(report::Arguments),
    /// Write a campaign as a laboratory would have it: recordings, session file and, in a folder apart, the truth
    Simulate(simulate::Arguments),
    /// Say what is in a recording: channels, rate, noise, clipping, gaps, spectrum, and a picture
    Inspect(inspect::Arguments),
    /// Turn a session's recordings into 25 parameters, their intervals and a verdict
    Calibrate(calibrate::Arguments),
    /// Turn a recording's nine voltages into six accelerations
    Decouple(decouple::Arguments),
    /// Check a calibration in the field, without a standard: which limbs' scale has drifted, from a tumble
    SelfCalibrate(self_calibrate::Arguments),
    /// Calibrate by the thousand: seeded sessions in memory, in parallel, in shards, and what they say of the method
    Campaign(campaign::Arguments),
    /// Hold a decoupled recording against the truth, or against another
    Compare(compare::Arguments),
    /// Write the simulated sensor as MJCF; `python -m mujoco.viewer --mjcf=FILE` opens it
    Model(model::Arguments),
    /// Write a shell's completions to standard output
    ///
    /// For example: sixaxis completions bash > ~/.local/share/bash-completion/completions/sixaxis
    Completions(completions::Arguments),
    /// Write manual pages: that of the command, of a subcommand, or all
    Man(man::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        None => Arguments::command()
            .print_help()
            .map(|()| ExitCode::SUCCESS)
            .map_err(anyhow::Error::from),
        Some(Task::Report(arguments)) => report::run(&arguments),
        Some(Task::Simulate(arguments)) => simulate::run(&arguments),
        Some(Task::Inspect(arguments)) => inspect::run(&arguments),
        Some(Task::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(Task::Decouple(arguments)) => decouple::run(&arguments),
        Some(Task::SelfCalibrate(arguments)) => self_calibrate::run(&arguments),
        Some(Task::Campaign(arguments)) => campaign::run(&arguments),
        Some(Task::Compare(arguments)) => compare::run(&arguments),
        Some(Task::Model(arguments)) => model::run(&arguments),
        Some(Task::Completions(arguments)) => completions::run(&arguments, Arguments::command()),
        Some(Task::Man(arguments)) => man::run(&arguments, Arguments::command()),
    };
    done.unwrap_or_else(|error| {
        eprintln!("error: {}", in_words(&error));
        ExitCode::FAILURE
    })
}

/// An error with its causes, each once: some errors say their cause themselves.
fn in_words(error: &anyhow::Error) -> String {
    let mut words = error.to_string();
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !words.ends_with(&cause) {
            words = format!("{words}: {cause}");
        }
    }
    words
}
