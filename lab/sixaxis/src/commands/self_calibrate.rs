//! `sixaxis self-calibrate`: what a recording from the field says of a calibration, without any standard.

mod correction;
mod measured;
mod words;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::self_calibration::{
    KnownChange, Limits, PerLimbs, ScaleRatios, Scales, drifted,
};
use sixaxis_core::{Error, LIMBS};
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::session::SessionFile;

use self::measured::{Measured, Rest};
use self::words::{Finding, Summary};

/// Which calibration is checked with which recording.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Calibration, as `sixaxis calibrate` writes it
    calibration: PathBuf,
    /// Recording of the sensor being tumbled, any format that is read and any length
    recording: PathBuf,
    /// Recording of a tumble at the time of the calibration: changes since then, whatever the limbs' stiffness
    #[arg(long, value_name = "RECORDING")]
    since: Option<PathBuf>,
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
    /// Where down is in the sensor's axes at rest, of any length: for the second order of a tared signal
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    down: Vec<f64>,
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
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Limbs of equal stiffness obey three coordination equations in any motion, and a motion rich enough tells the ratios of all nine
scale factors from them. Turn the sensor about all axes, as fast as you can, for a minute: translation alone, or turning about one
axis, leaves ratios open, and which is said. Zero drifts need not be known, but must stand still.

A common change of all nine does not show: limbs are named as drifted against the others, at most four, which are taken to have
kept their scale. Limbs of unequal stiffness show as a change of that size unless --since is given. Intervals are of 95 % and hold
the recording's noise and, unless --calibration-exact, what the calibration says of its own.

Examples:
  sixaxis self-calibrate calibration.json tumble.tdms --gain 0.05 --down 0,0,-1
  sixaxis self-calibrate calibration.json now.csv --since then.csv --gain 0.05
  sixaxis self-calibrate calibration.json turned.csv --gain 0.05 --known-change 19.6133 --rests 0-2,63-65

Exit codes: 0 no limb has drifted; 3 limbs have drifted and are named; 4 it cannot be said: the motion is too poor, more than four
limbs have drifted, or the equations do not fit; 1 it could not be done; 2 the command line is not understood.";

/// Misfit, as a probability, from which nothing is said of limbs.
const MISFIT: f64 = 1e-6;
/// Correlation of neighbouring blocks in deviations, and as such, from which intervals are said to be too narrow.
const CORRELATED: (f64, f64) = (5.0, 0.1);

/// Largest ln of a common factor that is believed: half as much again.
const LARGEST_COMMON: f64 = 0.4;

/// Checks.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    check_paths(arguments)?;
    let calibration = Calibration::read(&arguments.calibration)?;
    let session = arguments
        .session
        .as_deref()
        .map(SessionFile::read)
        .transpose()?;
    let overrides = Overrides {
        gain_n_per_v: arguments.gain.clone(),
        rate_hz: arguments.rate,
        down: match arguments.down.as_slice() {
            [] => None,
            [x, y, z] => Some([*x, *y, *z]),
            other => bail!("--down: {} numbers, three were expected", other.len()),
        },
    };
    let setup = |path: &Path| Setup::new(&calibration, session.as_ref(), Some(path), &overrides);
    let own = setup(&arguments.recording)?;
    let rests = match (arguments.known_change, arguments.rests.as_slice()) {
        (None, _) => None,
        (Some(_), [a, b]) => Some([*a, *b]),
        (Some(_), other) => bail!("--rests: {} rests, two were expected", other.len()),
    };
    let measured = Measured::of(&arguments.recording, &own, rests)?;
    let mut summary = Summary::new(arguments, &calibration, &measured);
    summary.notes.extend(own.notes.iter().cloned());
    let now = match measured.moments.ratios(&Limits::default()) {
        Ok(ratios) => ratios,
        Err(Error::UnobservableScaleRatios { directions: open }) => {
            summary.finding = Finding::TooPoor;
            summary.open = open.pairs().map(Into::into).collect();
            summary.open_in_words = Some(open.to_string());
            return finish(arguments, &summary);
        }
        Err(error) => return Err(error).with_context(|| arguments.recording.display().to_string()),
    };
    let ratios = match &arguments.since {
        None => now,
        Some(path) => {
            let then = Measured::of(path, &setup(path)?, None)?;
            summary.warnings.extend(then.warnings.iter().cloned());
            let then = then
                .moments
                .ratios(&Limits::default())
                .with_context(|| path.display().to_string())?;
            ScaleRatios {
                ln_ratio: core::array::from_fn(|i| now.ln_ratio[i] - then.ln_ratio[i]),
                covariance: now.covariance + then.covariance,
                ..now
            }
        }
    };
    let calibrated = if arguments.calibration_exact || arguments.since.is_some() {
        PerLimbs::zeros()
    } else {
        correction::covariance_of_ln_scale(&calibration)?
    };
    check_grade(&mut summary, &now);
    let said = drifted(&ratios, &calibrated, arguments.false_alarm).context("--false-alarm")?;
    summary.put(&said)?;
    let scales = match (arguments.known_change, &measured.change) {
        (Some(length_m_s2), Some(change)) => {
            let chain = SignalChain::new(&own.sensor.gains, &own.parameters);
            let known = KnownChange {
                voltage_change_v: change.voltage_v,
                voltage_deviation_v: change.deviation_v,
                length_m_s2,
                length_deviation_m_s2: arguments.known_change_deviation,
            };
            let scales = known.scales(&chain, &now).context("--known-change")?;
            ensure!(
                scales.ln_common.abs() < LARGEST_COMMON,
                "--known-change: between the rests the forces change by {:.2} m/s², not {length_m_s2}; was the sensor at rest there, and turned in between?",
                length_m_s2 * (-scales.ln_common).exp()
            );
            summary.put_scales(&scales)?;
            Some(scales)
        }
        _ => None,
    };
    if let Some(path) = &arguments.write_calibration {
        write(path, calibration, &summary, &said, scales.as_ref())?;
        summary.written = Some(path.display().to_string());
    }
    finish(arguments, &summary)
}

fn check_grade(summary: &mut Summary, ratios: &ScaleRatios) {
    if ratios.misfit.chance() < MISFIT {
        summary.finding = Finding::Misfit;
        summary.warnings.push(format!(
            "the three equations contradict each other: limb 1 would have to count {:+.3} % more in its first row than in its second ({:.0} standard deviations). Crosstalk, a bent frame or a channel that is not linear",
            1e2 * ratios.misfit.ln_ratio,
            ratios.misfit.z().abs()
        ));
    }
    if ratios.lag_one_z() > CORRELATED.0 && ratios.lag_one_correlation > CORRELATED.1 {
        summary.warnings.push(format!(
            "what the equations leave is no white noise (neighbouring blocks correlate by {:.2}): drifts, slow noise or crosstalk; intervals are too narrow",
            ratios.lag_one_correlation
        ));
    }
}

fn write(
    path: &Path,
    calibration: Calibration,
    summary: &Summary,
    said: &sixaxis_core::redundancy::self_calibration::Drifted,
    scales: Option<&Scales>,
) -> Result<()> {
    let (ln_change, deviation): ([f64; LIMBS], [f64; LIMBS]) = match scales {
        Some(scales) => (scales.ln_scale, scales.deviation),
        None => {
            ensure!(
                matches!(summary.finding, Finding::Drifted | Finding::Nothing),
                "--write-calibration: it cannot be said which limbs kept their scale; only --known-change tells all nine"
            );
            let of = |i: usize, x: f64| if said.limbs.contains(i) { x } else { 0.0 };
            (
                core::array::from_fn(|i| of(i, said.ln_change[i])),
                core::array::from_fn(|i| of(i, said.deviation[i])),
            )
        }
    };
    correction::corrected(calibration, &ln_change, &deviation)
        .write(path)
        .with_context(|| format!("cannot write {}", path.display()))
}

fn finish(arguments: &Arguments, summary: &Summary) -> Result<ExitCode> {
    let json = || serde_json::to_string_pretty(summary).map(|text| text + "\n");
    if let Some(path) = &arguments.out {
        write_atomically(path, json()?.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    for warning in &summary.warnings {
        eprintln!("warning: {warning}");
    }
    if arguments.json {
        print!("{}", json()?);
    } else {
        for note in &summary.notes {
            eprintln!("note: {note}");
        }
        print!("{}", summary.text());
    }
    Ok(ExitCode::from(match summary.finding {
        Finding::Nothing => 0,
        Finding::Drifted => 3,
        Finding::TooPoor | Finding::TooMany | Finding::Misfit => 4,
    }))
}

fn check_paths(arguments: &Arguments) -> Result<()> {
    let same = |a: &Path, b: &Path| {
        a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
    };
    let outputs: Vec<(&str, &PathBuf)> = [
        ("--out", &arguments.out),
        ("--write-calibration", &arguments.write_calibration),
    ]
    .into_iter()
    .filter_map(|(name, path)| Some((name, path.as_ref()?)))
    .collect();
    let inputs = [
        Some(&arguments.calibration),
        Some(&arguments.recording),
        arguments.since.as_ref(),
        arguments.session.as_ref(),
    ];
    for (name, output) in &outputs {
        for input in inputs.into_iter().flatten() {
            ensure!(
                !same(output, input),
                "{name}: {} is read and would be written over",
                output.display()
            );
        }
    }
    if let [(_, a), (_, b)] = outputs.as_slice() {
        ensure!(
            !same(a, b),
            "--out and --write-calibration are the same file"
        );
    }
    Ok(())
}
