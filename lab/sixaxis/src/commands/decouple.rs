//! `sixaxis decouple`: a recording to six accelerations.

mod summary;

use std::cell::RefCell;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use sixaxis_calibration::apply::aids::AidChoice;
use sixaxis_calibration::apply::attitude::UNTIL_SD_DEG;
use sixaxis_calibration::apply::check_grade::check_grade;
use sixaxis_calibration::apply::columns::Columns;
use sixaxis_calibration::apply::conditioning_stream::{LOW_PASS_ORDER, causal_delay_s};
use sixaxis_calibration::apply::job::Job;
use sixaxis_calibration::apply::setup::Setup;
use sixaxis_calibration::apply::text_stream::{End, Printed, is_closed_pipe, refuse};
use sixaxis_calibration::page;
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_page::render;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::{Channel, Layout, Sink};

use self::summary::{Summary, facts};
use super::choices::{Axes, Integrator};
use super::common::{Beside, check_there, print, print_json, read_calibration, say, tell};
use super::output::{PAGE, check_ending, check_outputs, mention_earlier};
use crate::progress::Progress;

/// What is decoupled with what.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Calibration, as `sixaxis calibrate` writes it
    calibration: PathBuf,
    /// Recording that begins at rest, any format that is read; - for rows of text on standard input, answered at once
    recording: PathBuf,
    /// File to write: .csv, .csv.gz, .parquet, .npz, .npy or .tdms; - for standard output [default: the recording's name with
    /// -decoupled.csv]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    beside: Beside,
    /// How the rate is integrated
    #[arg(long, value_enum, default_value_t = Integrator::HeunSubstepped)]
    scheme: Integrator,
    /// Low-pass on the voltages, Hz: Butterworth of order 4, without phase; on a stream forwards only, which delays
    #[arg(long, value_name = "HZ")]
    low_pass: Option<f64>,
    /// The run ends as it began, at rest in the same place: the drift that contradicts this is taken off
    #[arg(long)]
    rest_to_rest: bool,
    /// Axes of the accelerations: the ground's as far as the attitude is known, the sensor's, or both
    #[arg(long, value_enum, default_value_t = Axes::Both)]
    frame: Axes,
    /// Standard deviation of the attitude, degrees, up to which ground axes are given, NaN where it is larger [default: 5]
    #[arg(long, value_name = "DEGREES", conflicts_with = "rest_to_rest")]
    until_sd: Option<f64>,
    /// What else is known of the motion: rest, velocity=SECONDS,M_PER_S or attitude=FILE,DEGREES; once of each kind
    #[arg(long, value_name = "WHAT", conflicts_with = "rest_to_rest")]
    aid: Vec<AidChoice>,
    /// Decouple each sample by all that --aid tells of the whole recording, what comes later with it; reads it twice
    #[arg(long, requires = "aid", conflicts_with = "watch")]
    smooth: bool,
    /// The accelerations only, without rates and attitude
    #[arg(long)]
    accelerations: bool,
    /// Seven more columns: one standard deviation of each acceleration in ground axes and of the attitude, from the calibration's
    /// covariance and the channels' noise
    #[arg(long, conflicts_with = "rest_to_rest")]
    uncertainty: bool,
    /// Monitor the nine channels for faults: a limb that fails is named and excluded. Two more columns state which
    #[arg(long, conflicts_with_all = ["rest_to_rest", "excluded"])]
    watch: bool,
    /// Expected number of false alarms of --watch
    #[arg(long, value_name = "NUMBER", default_value_t = 1.0, requires = "watch")]
    false_alarms_per_hour: f64,
    /// Excluded limbs, by number, up to three: their channels have failed and are not read
    #[arg(
        long,
        value_name = "LIMBS",
        value_parser = limbs,
        conflicts_with = "rest_to_rest"
    )]
    excluded: Option<LimbSet>,
    /// Picture of the six accelerations: a page that needs no network
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Decouple with a calibration whose verdict is bad
    #[arg(long)]
    force: bool,
    /// Print a summary as JSON
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = include_str!("decouple.txt");

/// Share of the motion that a low-pass takes off from which it is said.
const WORTH_A_WARNING: f64 = 0.01;

/// Limbs by number, with commas.
fn limbs(text: &str) -> core::result::Result<LimbSet, String> {
    let mut set = LimbSet::EMPTY;
    for word in text.split(',').map(str::trim) {
        let number = word
            .parse()
            .map_err(|_| format!("{word:?} is no limb's number"))?;
        let one = LimbSet::from_numbers([number]).map_err(|error| error.to_string())?;
        if set.minus(one) != set {
            return Err(format!("limb {number} stands there twice"));
        }
        set = set.union(one);
    }
    Ok(set)
}

/// Decouples.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let calibration = read_calibration(&arguments.calibration)?;
    let name = arguments.calibration.display().to_string();
    if let Some(doubt) = check_grade(&name, &calibration, arguments.force)? {
        tell("warning", &doubt);
    }
    let session = arguments.beside.read_session()?;
    let streams = arguments.recording == Path::new("-");
    let recording = (!streams).then_some(arguments.recording.as_path());
    if let Some(recording) = recording {
        check_there(recording)?;
    }
    let overrides = arguments.beside.overrides();
    let mut setup = Setup::new(&calibration, session.as_ref(), recording, &overrides)?;
    setup.conditioning.low_pass_hz = arguments.low_pass;
    setup.conditioning.causal = streams;
    ensure!(
        !setup.detrends || arguments.rest_to_rest,
        "the session takes a line off its runs (preprocessing.detrend), which this does not: --rest-to-rest takes off the drift that \
         contradicts rest, or use a session without detrend"
    );
    if let (Some(corner_hz), Some(drive_hz)) = (arguments.low_pass, setup.drive_hz) {
        // Forwards and backwards, as the square of a Butterworth filter.
        let left = 1.0 / (1.0 + (drive_hz / corner_hz).powi(2 * LOW_PASS_ORDER as i32));
        if left < 1.0 - WORTH_A_WARNING {
            tell(
                "warning",
                &format!(
                    "--low-pass {corner_hz} takes {:.0} % of the motion itself: by the session the drive turns at {drive_hz} Hz",
                    100.0 * (1.0 - left)
                ),
            );
        }
    }
    if arguments.watch && setup.conditioning.outliers.take().is_some() {
        setup
            .notes
            .push("--watch sees the channels as they are: outliers are not replaced".to_owned());
    }
    ensure!(
        !(arguments.watch && arguments.uncertainty && arguments.aid.is_empty()),
        "--watch with --uncertainty goes with --aid only: without one, deviations are those of nine limbs"
    );
    let until_sd_deg = arguments.until_sd.unwrap_or(UNTIL_SD_DEG);
    ensure!(
        until_sd_deg > 0.0,
        "--until-sd {until_sd_deg}: must be positive"
    );
    ensure!(
        arguments.picture.is_none() || arguments.frame != Axes::Sensor,
        "--picture draws ground axes, which --frame sensor leaves out"
    );
    say("note", &setup.notes);
    let excluded = arguments.excluded.unwrap_or(LimbSet::EMPTY);
    if !excluded.is_empty() {
        tell("note", &format!("without {excluded:#}"));
    }
    let job = Job {
        calibration: &calibration,
        calibration_name: &arguments.calibration,
        setup: &setup,
        columns: Columns {
            frame: arguments.frame.frame(),
            accelerations_only: arguments.accelerations,
        },
        scheme: arguments.scheme.scheme(),
        rest_to_rest: arguments.rest_to_rest,
        uncertainty: arguments.uncertainty,
        false_alarms_per_hour: arguments.watch.then_some(arguments.false_alarms_per_hour),
        excluded,
        until_sd_deg,
        aids: &arguments.aid,
        smooth: arguments.smooth,
        picture: arguments.picture.is_some(),
    };
    let done = if streams {
        stream(arguments, &job)
    } else {
        file(arguments, &job)
    };
    match done {
        // Whoever read the rows has seen enough.
        Err(error) if is_closed_pipe(&error) => Ok(ExitCode::SUCCESS),
        other => other.map(|()| ExitCode::SUCCESS),
    }
}

fn default_out(recording: &Path) -> PathBuf {
    let name = recording.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    recording.with_file_name(format!("{stem}-decoupled.csv"))
}

fn file(arguments: &Arguments, job: &Job) -> Result<()> {
    let started = Instant::now();
    let path = arguments.recording.as_path();
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => default_out(path),
    };
    let to_output = out == Path::new("-");
    ensure!(
        !(to_output && arguments.json),
        "--json and --out - would both print to standard output"
    );
    let mut outputs = vec![("--out", out.as_path())];
    outputs.extend(arguments.picture.as_deref().map(|p| ("--picture", p)));
    let session = arguments.beside.session.as_deref();
    let attitudes = arguments.aid.iter().filter_map(AidChoice::file);
    let inputs = [path, &arguments.calibration]
        .into_iter()
        .chain(session)
        .chain(attitudes);
    check_outputs(&outputs, inputs)?;
    if let Some(picture) = &arguments.picture {
        check_ending("--picture", picture, PAGE)?;
    }
    // Of results nobody asks; a recording is not to be had again, whatever its channels are called.
    let is_result = |name: &str| ["ax", "fx", "ax_m_s2", "fx_m_s2"].contains(&name);
    let recorded = out.is_file()
        && sixaxis_recordings::open(&out).is_ok_and(|there| {
            let channels = &there.layout().channels;
            let last = |c: &Channel| c.name.rsplit('/').next().is_some_and(is_result);
            channels.len() >= LIMBS && !channels.iter().any(last)
        });
    ensure!(
        !recorded,
        "--out: {} is a recording and no result of this command, and would be written over; name another file",
        out.display()
    );
    let create = |layout: &Layout| -> Result<Box<dyn Sink>> {
        if to_output {
            let output = io::BufWriter::new(io::stdout());
            return Ok(Box::new(Printed::create(output, layout)?));
        }
        Ok(sixaxis_recordings::create(&out, layout)?)
    };
    let nameless = out
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("npy"));
    let columns = RefCell::new(Vec::new());
    let create = |layout: &Layout| {
        if nameless {
            let names = layout.channels.iter().map(|c| c.name.clone());
            *columns.borrow_mut() = names.collect();
        }
        create(layout)
    };
    let progress = Progress::shown();
    let decoupled = job
        .run(path, &create, &progress.callback("decoupling"))
        .inspect_err(|_| mention_earlier(&out))?;
    drop(progress);
    let summary = Summary {
        recording: path.display().to_string(),
        calibration: arguments.calibration.display().to_string(),
        verdict: job.calibration.verdict,
        out: out.display().to_string(),
        decoupled: &decoupled,
        duration_s: started.elapsed().as_secs_f64(),
        notes: &job.setup.notes,
    };
    if let (Some(picture), Some(curves)) = (&arguments.picture, &decoupled.curves) {
        let page = page::comparison::picture(&summary.recording, curves, facts(&summary));
        write_atomically(picture, render(&page)?.as_bytes())?;
    }
    say("warning", &decoupled.warnings);
    if nameless {
        let columns = columns.borrow().join(", ");
        tell(
            "note",
            &format!("a .npy file has no names of its columns: {columns}"),
        );
    }
    let aided = decoupled.attitude.filter(|_| !arguments.aid.is_empty());
    if let Some(attitude) = aided {
        tell("note", &attitude.sentence());
    }
    match (arguments.json, to_output) {
        (true, _) => print_json(&summary),
        (false, true) => Ok(()),
        (false, false) => print(summary.out + "\n"),
    }
}

fn stream(arguments: &Arguments, job: &Job) -> Result<()> {
    let to_file = arguments
        .out
        .as_deref()
        .is_some_and(|o| o != Path::new("-"));
    refuse(&[
        (
            arguments.rest_to_rest,
            "--rest-to-rest, which needs the whole run,",
        ),
        (arguments.uncertainty, "--uncertainty"),
        (arguments.smooth, "--smooth, which reads a recording twice,"),
        (arguments.picture.is_some(), "--picture"),
        (
            arguments.watch && !arguments.aid.is_empty(),
            "--watch with --aid, which reads a recording twice,",
        ),
        (
            arguments.watch && arguments.low_pass.is_some(),
            "--watch with --low-pass, which reads a recording twice,",
        ),
        (
            arguments
                .aid
                .iter()
                .any(|aid| matches!(aid, AidChoice::Attitude { .. })),
            "--aid attitude, which needs the recording's clock,",
        ),
        (
            arguments.beside.session.is_some(),
            "--session, which knows recordings by their files,",
        ),
        (arguments.json, "--json"),
        (to_file, "--out"),
    ])?;
    let rate_hz = arguments
        .beside
        .rate
        .context("--rate: a stream does not state how fast it is sampled")?;
    if let Some(corner_hz) = job.setup.conditioning.low_pass_hz {
        let note = format!(
            "--low-pass runs forwards only on a stream and delays by {:.2e} s; `time` is the sample's, not the motion's",
            causal_delay_s(corner_hz)
        );
        tell("note", &note);
    }
    // Lines may be long in coming: nothing may wait in a buffer.
    let mut input = BufReader::new(io::stdin());
    let mut output = io::BufWriter::new(io::stdout().lock());
    let warn = |text: String| tell("warning", &text);
    match job.live(rate_hz)?.run(&mut input, &mut output, &warn)? {
        End::Input { rows: 0 } => {
            warn("standard input: a row needs three samples, there is none".to_owned());
        }
        End::Input { .. } => {}
        // The buffer's remains have no reader; dropping it would try once more, and is silent.
        End::Closed => {}
    }
    Ok(())
}
