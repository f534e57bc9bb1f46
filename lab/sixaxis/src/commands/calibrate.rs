//! `sixaxis calibrate`: a session's recordings to 25 parameters, their intervals and a verdict.

mod format;
mod joint;
mod repetition;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use serde::Serialize;
use sixaxis_calibration::calibrate::{CalibratedSession, Options, calibrate};
use sixaxis_calibration::calibration;
use sixaxis_calibration::finding::{Cause, Finding};
use sixaxis_calibration::iteration::Criterion;
use sixaxis_calibration::page;
use sixaxis_calibration::report::{Estimator, Grade};
use sixaxis_page::render;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::session::{self, SessionFile};

use super::common::{not_streamed, not_understood, print, print_json, wrapped};
use super::output::{PAGE, check_ending, check_outputs, mention_earlier};
use crate::progress::Progress;

use format::Format;
use repetition::Repetition;

/// Which session and where to write.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Session file
    #[arg(required_unless_present = "schema")]
    session: Option<PathBuf>,
    /// Calibration to write [default: calibration.json, or calibration.rs, next to the session file]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Format of the calibration
    #[arg(long, value_enum, default_value_t = Format::Json)]
    format: Format,
    /// Report to write, one HTML file that needs no network [default: FILE.html beside --out FILE.json; calibration.html next to the session file with --format rust]
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Repeat steps 2 to 4 with the limbs' compliance kept, up to N times, and say whether k/m stands still. Shown only: the
    /// calibration is the same without
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_PASSES))]
    iterate: Option<u16>,
    /// Whose 25 parameters are written: the paper's four steps', or those of all trials at once by maximum likelihood, which
    /// finds wedges, axis, centre, limbs' stiffness, cross-talk and the standards' errors along with them [default: joint where it
    /// leaves no more over than noise, or with a reservation half as much again, and finds ordinary limbs; four-steps where it does not]
    #[arg(long, value_enum)]
    estimator: Option<Method>,
    /// Keep wild samples from bending the joint fit (Huber's loss): needs --estimator joint; takes up to twice as long, more with many of them
    #[arg(long)]
    robust: bool,
    /// Print a summary for scripts instead of the one for people
    #[arg(long)]
    json: bool,
    /// Print nothing but errors, and the summary only with --json
    #[arg(long, short)]
    quiet: bool,
    /// Print the JSON schema of a file format and do nothing else
    #[arg(long, value_name = "FORMAT", conflicts_with_all = ["session", "out", "format", "report", "iterate", "estimator", "robust", "json"])]
    schema: Option<Schema>,
}

/// A pass takes about as long as the four steps; one that converges needs four.
const MOST_PASSES: i64 = 1000;

const AFTER_HELP: &str = include_str!("calibrate.txt");

/// An estimator by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// The paper's four steps, one after the other
    FourSteps,
    /// All trials at once
    Joint,
}

/// A file format with a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Schema {
    /// The session file; its TOML has the structure of this JSON
    Session,
    /// The calibration
    Calibration,
}

/// Calibrates and judges.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    if let Some(schema) = arguments.schema {
        let schema = match schema {
            Schema::Session => session::schema(),
            Schema::Calibration => calibration::schema(),
        };
        print_json(&schema)?;
        return Ok(ExitCode::SUCCESS);
    }
    let estimator = match (arguments.estimator, arguments.robust) {
        (None, false) => None,
        (Some(Method::FourSteps), false) => Some(Estimator::FourSteps),
        (Some(Method::Joint), false) => Some(Estimator::Joint),
        (Some(Method::Joint), true) => Some(Estimator::JointRobust),
        (None | Some(Method::FourSteps), true) => {
            return not_understood(
                "--robust is a loss of the joint fit: add --estimator joint; the four steps mend wild samples as the session's \
             preprocessing.outliers says",
            );
        }
    };
    let path = arguments
        .session
        .as_deref()
        .context("no session file was named")?;
    not_streamed([path])?;
    let within = path.join("session.toml");
    ensure!(
        !within.is_file(),
        "{}: a folder, where a file was expected; its session file is {}",
        path.display(),
        within.display()
    );
    if let Some(out) = &arguments.out {
        arguments.format.check(out)?;
    }
    let beside = |name: &str| path.with_file_name(name);
    let calibration = arguments
        .out
        .clone()
        .unwrap_or_else(|| match arguments.format {
            Format::Json => beside("calibration.json"),
            Format::Rust => beside("calibration.rs"),
        });
    let targets = Targets {
        report: arguments
            .report
            .clone()
            .unwrap_or_else(|| match arguments.format {
                Format::Json => calibration.with_extension("html"),
                // No page among a firmware's sources.
                Format::Rust => beside("calibration.html"),
            }),
        calibration,
    };
    let earlier = || mention_earlier(&targets.calibration);
    let file = SessionFile::read(path).inspect_err(|_| earlier())?;
    targets.check(&file)?;
    let calibrated = judge(arguments, &file, estimator, &targets).inspect_err(|_| earlier())?;
    if arguments.json {
        print_json(&Summary::new(&calibrated, &targets))?;
    } else if !arguments.quiet {
        print(summary(&calibrated, &targets))?;
    }
    if calibrated.calibration.is_none() {
        earlier();
        let cause = calibrated.obstacle.as_ref().unwrap_or(&calibrated.sentence);
        // What was not read is why little is left; nothing else says it where findings are not printed.
        let unread = calibrated
            .findings
            .iter()
            .find(|f| f.cause == Cause::Unreadable);
        let unread = unread.filter(|_| arguments.quiet);
        let unread = unread.map_or(String::new(), |f| format!("{}; ", f.evidence));
        bail!(
            "{}: no calibration is written: {unread}{cause}",
            path.display()
        );
    }
    Ok(ExitCode::from(match calibrated.grade {
        Grade::Good => 0,
        Grade::Reserved => 3,
        Grade::Bad => 4,
    }))
}

/// Calibrates and writes report and calibration.
fn judge(
    arguments: &Arguments,
    file: &SessionFile,
    estimator: Option<Estimator>,
    targets: &Targets,
) -> Result<CalibratedSession> {
    let calibrated = {
        let progress = Progress::new(arguments.quiet);
        let repeat = arguments.iterate.map(|passes| Criterion {
            passes: usize::from(passes),
            ..Criterion::default()
        });
        calibrate(file, &Options { repeat, estimator }, &progress)?
    };
    let page = render(&page::calibration::page(file, &calibrated))?;
    // The calibration last: whoever sees a new one finds its report beside it.
    write_atomically(&targets.report, page.as_bytes())?;
    if let Some(calibration) = &calibrated.calibration {
        match arguments.format {
            Format::Json => calibration.write(&targets.calibration),
            Format::Rust => calibration.write_rust(&targets.calibration),
        }?;
    }
    Ok(calibrated)
}

/// What is written where.
struct Targets {
    calibration: PathBuf,
    report: PathBuf,
}

impl Targets {
    /// Refuses to write one over the other, or over what is read.
    fn check(&self, file: &SessionFile) -> Result<()> {
        let entries = file.session.recording.iter();
        let names = entries.flat_map(|e| std::iter::once(&e.file).chain(&e.reference_file));
        let read: Vec<PathBuf> = names.map(|name| file.resolve(name)).collect();
        let inputs = std::iter::once(&file.path).chain(&read);
        check_outputs(
            &[("--out", &self.calibration), ("--report", &self.report)],
            inputs.map(PathBuf::as_path),
        )?;
        check_ending("--report", &self.report, PAGE)?;
        check_ending("--out", &self.calibration, &["json", "rs"])
    }
}

/// The summary for scripts.
#[derive(Serialize)]
struct Summary<'a> {
    verdict: Grade,
    sentence: &'a str,
    findings: &'a [Finding],
    reservations: &'a [String],
    remarks: &'a [String],
    next: &'a [String],
    parameters_determined: usize,
    parameters: usize,
    /// Where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    iteration: Option<Repetition<'a>>,
    estimator: Estimator,
    /// None where the four steps could not be done, from whose answer it starts.
    joint: Option<joint::Summary<'a>>,
    files: Files<'a>,
}

/// What was written.
#[derive(Serialize)]
struct Files<'a> {
    /// None where the four steps, or the joint fit that was asked for, could not be done.
    calibration: Option<&'a Path>,
    report: &'a Path,
}

impl<'a> Summary<'a> {
    fn new(calibrated: &'a CalibratedSession, targets: &'a Targets) -> Self {
        Self {
            verdict: calibrated.grade,
            sentence: &calibrated.sentence,
            findings: &calibrated.findings,
            reservations: &calibrated.reservations,
            remarks: &calibrated.remarks,
            next: &calibrated.next,
            parameters_determined: determined(calibrated),
            parameters: calibrated.parameters.len(),
            iteration: calibrated.iteration.as_ref().map(Repetition::of),
            estimator: calibrated.estimator,
            joint: joint::Summary::of(calibrated),
            files: Files {
                calibration: calibrated
                    .calibration
                    .as_ref()
                    .map(|_| targets.calibration.as_path()),
                report: &targets.report,
            },
        }
    }
}

fn determined(calibrated: &CalibratedSession) -> usize {
    calibrated
        .parameters
        .iter()
        .filter(|p| p.determined)
        .count()
}

/// The summary for people.
fn summary(calibrated: &CalibratedSession, targets: &Targets) -> String {
    let mut out = String::new();
    wrapped(&mut out, "", "", &calibrated.sentence);
    if !calibrated.findings.is_empty() {
        out += "\nFound\n";
        for finding in &calibrated.findings {
            let place = page::calibration::place(finding);
            wrapped(
                &mut out,
                "  - ",
                "    ",
                &format!("{}: {place}", finding.cause.name()),
            );
            wrapped(&mut out, "    ", "    ", &finding.evidence);
        }
    }
    out += "\nParameters\n";
    let parameters = &calibrated.parameters;
    if parameters.is_empty() {
        out += "  none: the four steps could not be done\n";
    } else {
        let _ = writeln!(
            out,
            "  {} of {} determined",
            determined(calibrated),
            parameters.len()
        );
        joint::print(&mut out, calibrated);
        for parameter in parameters.iter().filter(|p| !p.determined) {
            wrapped(
                &mut out,
                "  ",
                "  ",
                &format!("{}: {}", parameter.parameter, parameter.remark),
            );
        }
    }
    if let Some(iteration) = &calibrated.iteration {
        repetition::print(&mut out, iteration);
    }
    if !calibrated.remarks.is_empty() {
        out += "\nRemarks\n";
        for remark in &calibrated.remarks {
            wrapped(&mut out, "  - ", "    ", remark);
        }
    }
    let (actions, consequences) = page::calibration::split(calibrated);
    if !actions.is_empty() {
        out += "\nNext\n";
        for next in actions {
            wrapped(&mut out, "  - ", "    ", next);
        }
    }
    if !consequences.is_empty() {
        let _ = writeln!(
            out,
            "  - then calibrate again: {} (see the report)",
            match consequences.len() {
                1 => "another finding may be a consequence of the above".to_owned(),
                n => format!("{n} more findings may be consequences of the above"),
            }
        );
    }
    out += "\nWritten\n";
    let _ = writeln!(out, "  {}", targets.report.display());
    match (&calibrated.calibration, calibrated.grade) {
        (Some(_), Grade::Good) => {
            let _ = writeln!(out, "  {}", targets.calibration.display());
        }
        (Some(_), grade) => {
            let _ = writeln!(
                out,
                "  {} (its verdict is in it: {})",
                targets.calibration.display(),
                grade.word()
            );
        }
        (None, _) if targets.calibration.exists() => {
            let _ = writeln!(
                out,
                "  no calibration; {} is from an earlier run",
                targets.calibration.display()
            );
        }
        (None, _) => out += "  no calibration\n",
    }
    out
}
