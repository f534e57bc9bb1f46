//! The `sixaxis` command.

// What cannot be written to standard output is an error in words, `commands::common::print`; what cannot be written to standard error
// is lost, and nothing else: `commands::common::tell`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

mod commands;
mod progress;
use commands::common::{print, tell};
use commands::{
    calibrate, campaign, compare, completions, decouple, inspect, man, panel, self_calibrate,
    simulate,
};
#[cfg(feature = "harness")]
use commands::{model, report};

/// Calibrates, decouples and simulates a parallel six-axis accelerometer.
#[derive(Parser)]
#[command(name = "sixaxis", version, after_help = after_help())]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
}

/// Where to start, and what scripts want to know.
fn after_help() -> String {
    let report = if cfg!(feature = "harness") {
        "  sixaxis report                                 the paper's campaign against MuJoCo\n"
    } else {
        ""
    };
    format!("Start with:\n{report}{AFTER_HELP}")
}

const AFTER_HELP: &str = include_str!("main.txt");

#[derive(Subcommand)]
enum Task {
    /// Simulate the paper's calibration campaign with MuJoCo and write an offline HTML report
    ///
    /// Writes report.html, results.json (every number in it; the same seed gives the same file, bit for bit on one kind of processor), run.json
    /// (machine, duration), figures/*.svg and evidence.csv (random motions and, once the tests have been run at the same commit, those of their
    /// comparisons that leave a row) to the output folder.
    #[cfg(feature = "harness")]
    Report(report::Arguments),
    /// Simulate a laboratory's calibration day: recordings, session file and, in a folder apart, the truth
    Simulate(simulate::Arguments),
    /// List what is in a recording: channels, rate, noise, clipping, gaps, spectrum; draw a picture
    Inspect(inspect::Arguments),
    /// Identify 25 parameters from a session's recordings, with intervals and a verdict
    Calibrate(calibrate::Arguments),
    /// Compute six accelerations from a recording's nine voltages
    Decouple(decouple::Arguments),
    /// Check a calibration in the field without a standard: find limbs whose scale has drifted, from a tumble
    SelfCalibrate(self_calibrate::Arguments),
    /// Run thousands of seeded calibrations in parallel and in shards, and sum up whether the intervals hold
    Campaign(campaign::Arguments),
    /// Show the instrument live in a browser: acquire, preprocess, identify, decouple
    ///
    /// Serves one page on the loopback address and prints its link. Without another source a simulated laboratory is run by hand.
    Panel(panel::Arguments),
    /// Compare a decoupled recording with the truth, or with another
    Compare(compare::Arguments),
    /// Write the simulated sensor as MJCF; `python -m mujoco.viewer --mjcf=FILE` opens it
    #[cfg(feature = "harness")]
    Model(model::Arguments),
    /// Write a shell's completions to standard output
    ///
    /// For example: sixaxis completions bash > ~/.local/share/bash-completion/completions/sixaxis
    Completions(completions::Arguments),
    /// Write manual pages: that of the command, of a subcommand, or all
    Man(man::Arguments),
}

fn main() -> ExitCode {
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(answer) => return answered(&answer),
    };
    let done = match command {
        None => print(Arguments::command().render_help().to_string()).map(|()| ExitCode::SUCCESS),
        #[cfg(feature = "harness")]
        Some(Task::Report(arguments)) => report::run(&arguments),
        Some(Task::Simulate(arguments)) => simulate::run(&arguments),
        Some(Task::Inspect(arguments)) => inspect::run(&arguments),
        Some(Task::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(Task::Decouple(arguments)) => decouple::run(&arguments),
        Some(Task::SelfCalibrate(arguments)) => self_calibrate::run(&arguments),
        Some(Task::Campaign(arguments)) => campaign::run(&arguments),
        Some(Task::Panel(arguments)) => panel::run(&arguments),
        Some(Task::Compare(arguments)) => compare::run(&arguments),
        #[cfg(feature = "harness")]
        Some(Task::Model(arguments)) => model::run(&arguments),
        Some(Task::Completions(arguments)) => completions::run(&arguments, Arguments::command()),
        Some(Task::Man(arguments)) => man::run(&arguments, Arguments::command()),
    };
    done.unwrap_or_else(failed)
}

fn failed(error: anyhow::Error) -> ExitCode {
    if let Some(answer) = error.downcast_ref() {
        return answered(answer);
    }
    tell("error", &in_words(&error));
    ExitCode::FAILURE
}

/// Help that was asked for, or what is not understood: printed as everything else is, without commands to the terminal and with an
/// error where standard output takes nothing.
fn answered(answer: &clap::Error) -> ExitCode {
    let text = answer.render().to_string();
    if answer.use_stderr() {
        let (kind, text) = text.split_once(": ").unwrap_or(("error", &text));
        tell(kind, text.trim_end());
        return ExitCode::from(2);
    }
    print(text).map_or_else(failed, |()| ExitCode::SUCCESS)
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
