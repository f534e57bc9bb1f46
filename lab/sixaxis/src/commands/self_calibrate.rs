//! `sixaxis self-calibrate`: what a recording from the field says of a calibration, without any standard.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail, ensure};
use sixaxis_calibration::apply::check_grade::check_grade;
use sixaxis_calibration::apply::setup::Setup;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::report::Grade;
use sixaxis_calibration::self_calibrate::{Check, Finding, Known, Rest};
use sixaxis_recordings::draft::write_atomically;

use super::common::{Beside, check_there, not_streamed, print, print_json, read_calibration, say};
use super::output::{JSON, check_ending, check_outputs, mention_earlier, same_file};
use crate::progress::Progress;

/// Which calibration is checked with which recording.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Calibration, as `sixaxis calibrate` writes it
    calibration: PathBuf,
    /// Recording of the sensor being tumbled, any format that is read
    recording: PathBuf,
    /// Recording of a tumble at the time of the calibration: changes since then, whatever the limbs' stiffness
    #[arg(long, value_name = "RECORDING")]
    since: Option<PathBuf>,
    #[command(flatten)]
    beside: Beside,
    /// Known change of acceleration between two rests, m/s^2 (19.6133 for a sensor that is turned over): all nine scale factors
    #[arg(long, value_name = "M/S2", requires = "rests")]
    known_change: Option<f64>,
    /// Standard deviation of that, m/s^2
    #[arg(
        long,
        value_name = "M/S2",
        default_value_t = 0.0,
        requires = "known_change"
    )]
    known_change_deviation: f64,
    /// The two rests, seconds from the recording's beginning: FROM-TO,FROM-TO
    #[arg(long, value_name = "S", value_delimiter = ',', value_parser = Rest::parse, requires = "known_change")]
    rests: Vec<Rest>,
    /// How often a sensor that has not drifted may be said to have
    #[arg(long, value_name = "RATE", default_value_t = 0.01)]
    false_alarm: f64,
    /// Take the calibration's ratios for exact, without the errors that it states
    #[arg(long)]
    calibration_exact: bool,
    /// Write the result as JSON to a file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the calibration with the scale factors that were found: of the limbs that drifted, or of all with --known-change
    #[arg(long, value_name = "FILE")]
    write_calibration: Option<PathBuf>,
    /// Check a calibration that is not good, too, and write one even where limbs would have changed by more than 10 %, which a wrong gain
    /// does and drift hardly ever
    #[arg(long)]
    force: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = include_str!("self_calibrate.txt");

/// Checks.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let outputs: Vec<_> = [
        ("--out", &arguments.out),
        ("--write-calibration", &arguments.write_calibration),
    ]
    .into_iter()
    .filter_map(|(name, path)| Some((name, path.as_deref()?)))
    .collect();
    let optional = [&arguments.since, &arguments.beside.session];
    let inputs = [&arguments.calibration, &arguments.recording].into_iter();
    let inputs = inputs.chain(optional.into_iter().flatten());
    check_outputs(&outputs, inputs.map(PathBuf::as_path))?;
    for (option, path) in &outputs {
        check_ending(option, path, JSON)?;
    }
    if let Some(out) = &arguments.out {
        ensure!(
            Calibration::read(out).is_err(),
            "--out: {} is a calibration and would be written over; name another file",
            out.display()
        );
    }
    if let Some(since) = &arguments.since
        && same_file(since, &arguments.recording)
    {
        bail!("--since {}: the recording itself", since.display());
    }
    not_streamed([arguments.recording.as_path()])?;
    let calibration = read_calibration(&arguments.calibration)?;
    check_there(&arguments.recording)?;
    let name = arguments.calibration.display().to_string();
    let doubt = check_grade(&name, &calibration, arguments.force)?;
    let doubt = doubt.filter(|_| calibration.verdict == Grade::Bad);
    let session = arguments.beside.read_session()?;
    let overrides = arguments.beside.overrides();
    let known_change = match (arguments.known_change, arguments.rests.as_slice()) {
        (None, _) => None,
        (Some(length_m_s2), &[before, after]) => Some(Known {
            length_m_s2,
            deviation_m_s2: arguments.known_change_deviation,
            rests: [before, after],
        }),
        (Some(_), other) => bail!("--rests: {} rests, two were expected", other.len()),
    };
    let check = Check {
        calibration: &calibration,
        calibration_name: &arguments.calibration,
        recording: &arguments.recording,
        since: arguments.since.as_deref(),
        setup: &|path| Setup::new(&calibration, session.as_ref(), Some(path), &overrides),
        known_change,
        false_alarm: arguments.false_alarm,
        calibration_exact: arguments.calibration_exact,
        force: arguments.force,
    };
    let progress = Progress::shown();
    let correct = arguments.write_calibration.is_some();
    let advance = progress.callback("self-calibrating");
    let (mut summary, corrected) = check.run(correct, &advance)?;
    drop(advance);
    drop(progress);
    match (&arguments.write_calibration, corrected) {
        (Some(path), Some(corrected)) => {
            corrected.write(path)?;
            summary.written = Some(path.display().to_string());
        }
        (Some(path), None) => mention_earlier(path),
        (None, _) => {}
    }
    if let Some(path) = &arguments.out {
        let text = serde_json::to_string_pretty(&summary)? + "\n";
        write_atomically(path, text.as_bytes())?;
    }
    summary.warnings.extend(doubt);
    say("warning", &summary.warnings);
    if arguments.json {
        print_json(&summary)?;
    } else {
        say("note", &summary.notes);
        print(summary.text())?;
    }
    Ok(ExitCode::from(match summary.finding {
        Finding::Nothing => 0,
        Finding::Drifted => 3,
        Finding::TooPoor | Finding::TooMany | Finding::Misfit => 4,
    }))
}
