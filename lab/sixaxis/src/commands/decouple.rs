//! `sixaxis decouple`: a recording to six accelerations.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use super::integrator::Integrator;
use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;
use sixaxis_calibration::apply::check_grade::check_grade;
use sixaxis_calibration::apply::conditioning_stream::{
    ConditioningConfig, ConditioningStream, causal_delay_s,
};
use sixaxis_calibration::apply::decoding::{Columns, DEVIATIONS, Decoding};
use sixaxis_calibration::apply::fault_watch::{Watching, flags};
use sixaxis_calibration::apply::pipeline::Busy;
use sixaxis_calibration::apply::recording::Recording;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::apply::text_stream::{End, Live, Printed, is_closed_pipe, refuse};
use sixaxis_calibration::apply::{pipeline, rest_to_rest};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::page;
use sixaxis_calibration::report::Grade;
use sixaxis_core::{Decoupler, LimbSet, Scheme, Settings};
use sixaxis_page::render;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::session::SessionFile;
use sixaxis_recordings::{Channel, Sink};
use sixaxis_reports::progress::Progress;

/// What is decoupled with what.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Calibration, as `sixaxis calibrate` writes it
    calibration: PathBuf,
    /// Recording, any format that is read; - for rows of text on standard input, answered at once
    recording: PathBuf,
    /// File to write: .csv, .csv.gz, .parquet, .npz, .npy or .tdms; - for standard output [default: the recording's name with
    /// -decoupled.csv]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Session file that has the recording: gains, direction of gravity, channels and rate are taken from it
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// Gains of this recording's amplifier ranges, N/V: one, or nine with commas
    #[arg(
        long,
        value_name = "N/V",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    gain: Vec<f64>,
    /// Samples per second, where the file does not say
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Where down is in the sensor's axes at rest, of any length
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    down: Vec<f64>,
    /// How the rate is integrated
    #[arg(long, value_enum, default_value_t = Integrator::HeunSubstepped)]
    scheme: Integrator,
    /// Low-pass on the voltages, Hz: Butterworth of order 4, without phase; on a stream forwards only, which delays
    #[arg(long, value_name = "HZ")]
    low_pass: Option<f64>,
    /// The run ends as it began, at rest in the same place: take off the drift that keeps it from doing so
    #[arg(long, visible_alias = "close")]
    rest_to_rest: bool,
    /// The six accelerations only, without rates and attitude: about twice as fast
    #[arg(long)]
    accelerations: bool,
    /// Six more columns: one standard deviation of each acceleration, from the calibration's covariance and the channels' noise
    #[arg(long, conflicts_with = "rest_to_rest")]
    uncertainty: bool,
    /// Watch the nine channels: name a limb that fails and go on without it. Two more columns say which
    #[arg(long, conflicts_with_all = ["rest_to_rest", "uncertainty", "failed"])]
    watch: bool,
    /// Expected number of false alarms of --watch
    #[arg(long, value_name = "NUMBER", default_value_t = 1.0, requires = "watch")]
    false_alarms_per_hour: f64,
    /// Limbs to do without, by number: their channels have failed and are not looked at
    #[arg(
        long,
        value_name = "LIMBS",
        value_delimiter = ',',
        conflicts_with_all = ["rest_to_rest", "uncertainty"]
    )]
    failed: Vec<usize>,
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

const AFTER_HELP: &str = "\
Columns: time in s; ax, ay, az in m/s^2 and alpha_x, alpha_y, alpha_z in rad/s^2, ground axes; wx, wy, wz in rad/s, the sensor's
axes; qw, qx, qy, qz, the sensor's axes to the ground's. A sample is decoupled from itself and its two neighbours: the first and
the last have no row, the first row is that of sample 1 (counted from 0), and `time` says which is which.

--uncertainty adds sd_ax to sd_alpha_z, one standard deviation each, to first order: noise of the calibration and of this recording,
gains of the standards. The attitude is integrated without a reference and its error grows; once it is some hundredths of a
radian, the deviations are estimates of a size. Wedges are not in them, nor what --rest-to-rest would take off.

--watch holds the three sums of limb forces that are zero in any motion to the noise and the uncertainty that the calibration
states. A limb that fails is named with how and since when; rate and attitude go on as if it had not been there. `without_limbs`
and `suspected_limbs` have the limbs' numbers as digits, 0 for none; rows with suspected limbs are not to be trusted. Limbs 2 and
4, 3 and 7, 6 and 8 show alike: which of the two it is, forces alone do not say.

--failed does without up to three limbs, if the others still tell six accelerations; an error says which load they would not.
Noise of the others counts up to three times as much.

A recording may be of any length: it passes through in blocks. Only --rest-to-rest holds the whole run in the memory, 2 million
samples at most. A result appears whole or not at all: it is written to a neighbour named .NAME.PROCESS.part, which takes
its name at the end. A killed run may leave such a neighbour; it is never read and can be deleted.

A stream has nine numbers a line, or a line of headings first; --rate is needed. Each row goes out when its successor has come
in. The first line that cannot be read ends it with exit code 1; all rows before it are out by then.

Examples:
  sixaxis decouple calibration.json run.tdms --gain 0.05 --down 0,0,-1
  sixaxis decouple calibration.json day/compound-03.npz --session day/session.toml --rest-to-rest --low-pass 30
  acquire | sixaxis decouple calibration.json - --rate 2000 --gain 0.05 | display";

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    recording: String,
    calibration: String,
    verdict: Grade,
    out: String,
    samples: u64,
    rows: u64,
    first_row_sample: u64,
    first_row_time_s: Option<f64>,
    sample_rate_hz: f64,
    scheme: Scheme,
    gain_n_per_v: [f64; 9],
    gravity_ground_m_s2: [f64; 3],
    low_pass_hz: Option<f64>,
    failed_limbs: Vec<usize>,
    clipped_samples: [u64; 9],
    /// --rest-to-rest: how far the run was from ending as it began.
    end_rate_before_rad_s: Option<[f64; 3]>,
    end_rotation_before_rad: Option<[f64; 3]>,
    duration_s: f64,
    busy: Option<Busy>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

fn warn(text: &str) {
    eprintln!("warning: {text}");
}

/// Decouples.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let started = Instant::now();
    let calibration = Calibration::read(&arguments.calibration)?;
    let name = arguments.calibration.display().to_string();
    if let Some(doubt) = check_grade(&name, &calibration, arguments.force)? {
        warn(&doubt);
    }
    let session = match &arguments.session {
        Some(path) => Some(SessionFile::read(path)?),
        None => None,
    };
    let streams = arguments.recording == Path::new("-");
    let overrides = Overrides {
        gain_n_per_v: arguments.gain.clone(),
        rate_hz: arguments.rate,
        down: match arguments.down.as_slice() {
            [] => None,
            [x, y, z] => Some([*x, *y, *z]),
            other => bail!("--down: {} numbers, three were expected", other.len()),
        },
    };
    let recording = (!streams).then_some(arguments.recording.as_path());
    let mut setup = Setup::new(&calibration, session.as_ref(), recording, &overrides)?;
    setup.conditioning.low_pass_hz = arguments.low_pass;
    let columns = if arguments.accelerations {
        Columns::Accelerations
    } else {
        Columns::All
    };
    if streams {
        return stream(arguments, &calibration, setup, columns);
    }
    for note in &setup.notes {
        eprintln!("note: {note}");
    }
    let summary = file(arguments, &calibration, setup, columns, started);
    let summary = match summary {
        // Whoever read the rows has seen enough.
        Err(error) if is_closed_pipe(&error) => return Ok(ExitCode::SUCCESS),
        other => other?,
    };
    for warning in &summary.warnings {
        warn(warning);
    }
    let to_output = summary.out == "-";
    let text = if arguments.json {
        serde_json::to_string_pretty(&summary)?
    } else {
        summary.out
    };
    if arguments.json || !to_output {
        println!("{text}");
    }
    Ok(ExitCode::SUCCESS)
}

/// The limbs to do without, said once on the way.
fn failed(arguments: &Arguments) -> Result<LimbSet> {
    let set = LimbSet::from_numbers(arguments.failed.iter().copied()).context("--failed")?;
    match set.len() {
        0 => {}
        1 => eprintln!("note: without limb {set}"),
        _ => eprintln!("note: without limbs {set}"),
    }
    Ok(set)
}

fn default_out(recording: &Path) -> PathBuf {
    let name = recording.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    recording.with_file_name(format!("{stem}-decoupled.csv"))
}

fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

fn file(
    arguments: &Arguments,
    calibration: &Calibration,
    setup: Setup,
    columns: Columns,
    started: Instant,
) -> Result<Summary> {
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => default_out(&arguments.recording),
    };
    let to_output = out == Path::new("-");
    ensure!(
        !(to_output && arguments.json),
        "--json and --out - would both print to standard output"
    );
    let mut inputs = vec![
        (arguments.recording.as_path(), "recording"),
        (arguments.calibration.as_path(), "calibration"),
    ];
    if let Some(session) = &arguments.session {
        inputs.push((session, "session file"));
    }
    let mut outputs = vec![("--out", out.as_path())];
    if let Some(picture) = &arguments.picture {
        ensure!(
            !same_file(&out, picture),
            "--picture and --out are the same file"
        );
        outputs.push(("--picture", picture));
    }
    for (option, output) in outputs {
        for (input, what) in &inputs {
            ensure!(
                !same_file(output, input),
                "{option}: {} is the {what} itself",
                output.display()
            );
        }
    }
    let mut recording = Recording::open(
        &arguments.recording,
        &setup.channels,
        setup.rate_hz,
        setup.full_scale_v,
    )?;
    let rate_hz = recording.sample_rate_hz;
    let scheme = arguments.scheme.scheme();
    let settings = setup.settings(rate_hz, scheme);
    let conditioning = ConditioningStream::new(&setup.conditioning, rate_hz)?;
    let failed = failed(arguments)?;
    recording.without = failed;
    recording.watched = arguments.watch;
    let decoupler = Decoupler::new(&setup.sensor, &setup.parameters, &settings)
        .with_context(|| format!("{}", arguments.calibration.display()))?
        .excluding(failed)
        .context("--failed")?;
    let mut decoding = Decoding::new(decoupler, columns, arguments.picture.is_some());
    let mut layout = columns.layout(rate_hz);
    if arguments.uncertainty {
        decoding = decoding.with_uncertainty(setup.uncertainty(calibration, &settings)?);
        layout
            .channels
            .extend(DEVIATIONS.map(|(name, unit)| Channel {
                sample_rate_hz: Some(rate_hz),
                ..Channel::new(name, Some(unit))
            }));
    }
    if let Some(watching) = watching(arguments, calibration, &setup, &settings)? {
        decoding = decoding.with_watching(watching);
        layout.channels.extend(flags(rate_hz));
    }
    for (key, value) in [
        ("sixaxis_version", env!("CARGO_PKG_VERSION").to_owned()),
        ("recording", name_of(&arguments.recording)),
        ("calibration", name_of(&arguments.calibration)),
        ("verdict", calibration.verdict.word().to_owned()),
        ("first_row_sample", "1".to_owned()),
    ] {
        layout.properties.insert(key.to_owned(), value);
    }
    if !failed.is_empty() {
        let limbs = failed.to_string();
        layout.properties.insert("failed_limbs".to_owned(), limbs);
    }
    let sink = || -> Result<Box<dyn Sink>> {
        if to_output {
            let printed = Printed::create(io::BufWriter::new(io::stdout()), &layout)?;
            return Ok(Box::new(printed));
        }
        Ok(sixaxis_recordings::create(&out, &layout)?)
    };
    let mut trend = None;
    let mut busy = None;
    if arguments.rest_to_rest {
        let mut stamps = Vec::new();
        let (rows, found) =
            rest_to_rest::read(&mut recording, conditioning, &setup, &settings, &mut stamps)?;
        rest_to_rest::write(&recording, &rows, &stamps, &mut decoding, sink()?)?;
        trend = Some(found);
    } else {
        let stage = Progress::shown().stage("decoupling", recording.samples.unwrap_or(0));
        busy = Some(pipeline::run(
            &mut recording,
            conditioning,
            &mut decoding,
            sink()?,
            &|samples| stage.advance(samples),
        )?);
    }
    let mut warnings = recording.warnings();
    warnings.extend(decoding.messages());
    if decoding.rows == 0 {
        warnings.push(format!(
            "{}: {} samples; a row needs three, the result is empty",
            arguments.recording.display(),
            recording.seen.samples
        ));
    }
    let summary = Summary {
        recording: arguments.recording.display().to_string(),
        calibration: arguments.calibration.display().to_string(),
        verdict: calibration.verdict,
        out: out.display().to_string(),
        samples: recording.seen.samples,
        rows: decoding.rows,
        first_row_sample: 1,
        first_row_time_s: decoding.first_s,
        sample_rate_hz: rate_hz,
        scheme,
        gain_n_per_v: setup.sensor.gains.gain_n_per_v,
        gravity_ground_m_s2: setup.gravity_ground_m_s2.to_array(),
        low_pass_hz: arguments.low_pass,
        failed_limbs: failed.numbers().collect(),
        clipped_samples: recording.seen.clipped,
        end_rate_before_rad_s: trend.map(|t| t.end_rate_before_rad_s.to_array()),
        end_rotation_before_rad: trend.map(|t| t.end_rotation_before_rad.to_array()),
        duration_s: started.elapsed().as_secs_f64(),
        busy,
        notes: setup.notes,
        warnings,
    };
    if let (Some(path), Some(curves)) = (&arguments.picture, &decoding.picture) {
        let page = page::comparison::picture(&summary.recording, curves, facts(&summary));
        write_atomically(path, render(&page)?.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(summary)
}

fn name_of(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn facts(summary: &Summary) -> Vec<(String, String)> {
    let mut facts = vec![
        ("sixaxis", env!("CARGO_PKG_VERSION").to_owned()),
        ("recording", summary.recording.clone()),
        ("calibration", summary.calibration.clone()),
        ("verdict", summary.verdict.word().to_owned()),
        ("samples", summary.samples.to_string()),
        ("sample rate", format!("{} Hz", summary.sample_rate_hz)),
        ("scheme", summary.scheme.name().to_owned()),
    ];
    if let Some(corner_hz) = summary.low_pass_hz {
        facts.push(("low-pass", format!("{corner_hz} Hz, without phase")));
    }
    if !summary.failed_limbs.is_empty() {
        let numbers: Vec<String> = summary.failed_limbs.iter().map(usize::to_string).collect();
        facts.push(("without limbs", numbers.join(", ")));
    }
    if summary.end_rate_before_rad_s.is_some() {
        facts.push(("corrected", "from rest to rest".to_owned()));
    }
    facts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn watching(
    arguments: &Arguments,
    calibration: &Calibration,
    setup: &Setup,
    settings: &Settings,
) -> Result<Option<Watching>> {
    arguments
        .watch
        .then(|| {
            Watching::new(
                setup,
                calibration,
                settings,
                arguments.false_alarms_per_hour,
            )
        })
        .transpose()
}

fn stream(
    arguments: &Arguments,
    calibration: &Calibration,
    setup: Setup,
    columns: Columns,
) -> Result<ExitCode> {
    refuse(&[
        (
            arguments.rest_to_rest,
            "--rest-to-rest, which needs the whole run,",
        ),
        (arguments.uncertainty, "--uncertainty"),
        (arguments.picture.is_some(), "--picture"),
        (
            arguments.session.is_some(),
            "--session, which knows recordings by their files,",
        ),
        (arguments.json, "--json"),
        (
            arguments
                .out
                .as_deref()
                .is_some_and(|out| out != Path::new("-")),
            "--out",
        ),
    ])?;
    for note in &setup.notes {
        eprintln!("note: {note}");
    }
    let rate_hz = arguments
        .rate
        .context("--rate: a stream does not say how fast it is sampled")?;
    let config = ConditioningConfig {
        causal: true,
        ..setup.conditioning
    };
    if let Some(corner_hz) = config.low_pass_hz {
        eprintln!(
            "note: --low-pass goes forwards only on a stream and delays by {:.2e} s; `time` is the sample's, not the motion's",
            causal_delay_s(corner_hz)
        );
    }
    let settings = setup.settings(rate_hz, arguments.scheme.scheme());
    let live = Live {
        conditioning: ConditioningStream::new(&config, rate_hz)?,
        watching: watching(arguments, calibration, &setup, &settings)?,
        decoupler: Decoupler::new(&setup.sensor, &setup.parameters, &settings)
            .with_context(|| format!("{}", arguments.calibration.display()))?
            .excluding(failed(arguments)?)
            .context("--failed")?,
        columns,
        sample_rate_hz: rate_hz,
        channels: setup.channels,
        full_scale_v: setup.full_scale_v,
    };
    // Lines may be long in coming: nothing may wait in a buffer.
    let mut input = BufReader::new(io::stdin());
    let mut output = io::BufWriter::new(io::stdout().lock());
    match live.run(&mut input, &mut output, &|text| warn(&text))? {
        End::Input { rows: 0 } => warn("standard input: a row needs three samples, there is none"),
        End::Input { .. } => {}
        // The buffer's remains have no reader; dropping it would try once more, and is silent.
        End::Closed => {}
    }
    Ok(ExitCode::SUCCESS)
}
