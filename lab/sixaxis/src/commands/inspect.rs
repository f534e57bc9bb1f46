//! `sixaxis inspect`: what is in a recording.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use serde::Serialize;
use sixaxis_calibration::apply::axis_noise::axis_noise_densities;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::LIMBS;
use sixaxis_page::render;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::ingest::columns::BLOCK;
use sixaxis_recordings::inspect::facts::{AxisNoise, ChannelFacts};
use sixaxis_recordings::inspect::{Expected, Inspection, Severity, inspect, listing, page};
use sixaxis_recordings::motion::MOTION_CHANNELS;
use sixaxis_recordings::session::{Role, SessionFile};
use sixaxis_recordings::unit::{self, Unit};

use super::common::{Naming, mention, not_streamed, print, print_json, tell};
use super::output::{PAGE, check_ending, check_outputs};
use crate::progress::Progress;

/// Which recordings, and in what form the answer is wanted.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Recordings: .csv, .txt, .tsv (also .gz), .lvm, .tdms, .parquet, .npy, .npz, .h5, .mat
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// All numbers as JSON on standard output
    #[arg(long)]
    json: bool,
    /// The spectra's densities, too
    #[arg(long, requires = "json")]
    spectra: bool,
    /// Offline page to write: every channel's history and spectrum
    #[arg(long, value_name = "FILE.html")]
    picture: Option<PathBuf>,
    /// Session that the recordings belong to: names, units and full scale where the files do not say
    #[arg(long, value_name = "SESSION")]
    session: Option<PathBuf>,
    /// The recordings are of the sensor at rest: Allan deviation, noise density, bias instability, random walk; with --session those
    /// of role static are
    #[arg(long)]
    at_rest: bool,
    /// Calibration: what the limbs' noise makes of the six accelerations at rest, with the gains that the session states
    #[arg(long, value_name = "FILE", requires = "session")]
    calibration: Option<PathBuf>,
    #[command(flatten)]
    naming: Naming,
    /// Exit with 4 if anything is noticed
    #[arg(long)]
    strict: bool,
}

const AFTER_HELP: &str = include_str!("inspect.txt");

/// One file's part of the JSON document.
#[derive(Serialize)]
#[serde(untagged)]
enum Outcome {
    Read(Box<Inspection>),
    Failed { file: String, error: String },
}

/// Everything that a script is told.
#[derive(Serialize)]
struct Document<'a> {
    sixaxis_version: &'static str,
    files: &'a [Outcome],
}

/// Looks at each file in turn.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    not_streamed(arguments.files.iter().map(PathBuf::as_path))?;
    if let Some(picture) = &arguments.picture {
        let files = arguments.files.iter().map(PathBuf::as_path);
        check_outputs(&[("--picture", picture)], files)?;
        check_ending("--picture", picture, PAGE)?;
    }
    let session = arguments.session.as_deref().map(SessionFile::read);
    let session = session.transpose()?;
    let calibration = arguments.calibration.as_deref().map(Calibration::read);
    let calibration = calibration.transpose()?;
    let mut outcomes = Vec::new();
    for (index, file) in arguments.files.iter().enumerate() {
        let progress = Progress::shown();
        let mut advance = |rows, total| {
            // A recording of a single block is read before a bar could be seen.
            if total > BLOCK as u64 {
                progress.report("inspect", total, rows);
            }
        };
        let expected = expected(arguments, session.as_ref(), file);
        match inspect(file, expected, &mut advance) {
            Ok(mut inspection) => {
                if let Some(calibration) = &calibration {
                    match axis_noise(calibration, session.as_ref(), file, &inspection) {
                        Ok(noise) => inspection.axis_noise = noise,
                        Err(error) => tell("warning", &format!("{error:#}")),
                    }
                }
                if !arguments.json {
                    let between = if index > 0 { "\n" } else { "" };
                    print(format!("{between}{}", listing::text(&inspection)))?;
                }
                if !arguments.spectra && arguments.picture.is_none() {
                    forget_densities(&mut inspection);
                }
                outcomes.push(Outcome::Read(Box::new(inspection)));
            }
            Err(error) => {
                tell("error", &error.to_string());
                outcomes.push(Outcome::Failed {
                    file: file.display().to_string(),
                    error: error.to_string(),
                });
            }
        }
    }
    if let Some(picture) = &arguments.picture {
        draw(picture, &outcomes)?;
        if arguments.json {
            mention(&picture.display().to_string());
        } else {
            print(format!("\n{}\n", picture.display()))?;
        }
    }
    if arguments.json {
        for outcome in &mut outcomes {
            if let Outcome::Read(inspection) = outcome
                && !arguments.spectra
            {
                forget_densities(inspection);
            }
        }
        let document = Document {
            sixaxis_version: env!("CARGO_PKG_VERSION"),
            files: &outcomes,
        };
        print_json(&document)?;
    }
    let failed = outcomes.iter().any(|o| matches!(o, Outcome::Failed { .. }));
    let noticed = outcomes
        .iter()
        .any(|o| matches!(o, Outcome::Read(i) if i.told(Severity::Noticed).next().is_some()));
    Ok(ExitCode::from(
        match (failed, arguments.strict && noticed) {
            (true, _) => 1,
            (false, true) => 4,
            (false, false) => 0,
        },
    ))
}

/// What session and options say of a file.
fn expected(arguments: &Arguments, session: Option<&SessionFile>, file: &Path) -> Option<Expected> {
    let naming = &arguments.naming;
    let mut expected = session.map(|session| Expected::of(session, file));
    if naming.channels.is_some() || naming.unit.is_some() {
        let channels = &mut expected.get_or_insert_default().channels;
        channels.state(naming.channels.as_ref(), naming.unit.as_ref());
    }
    if arguments.at_rest {
        expected.get_or_insert_default().role = Some(Role::Static);
    }
    expected
}

/// Noise of the six accelerations, from that of the nine limbs; of a recording that is not at rest nothing is said.
fn axis_noise(
    calibration: &Calibration,
    session: Option<&SessionFile>,
    file: &Path,
    inspection: &Inspection,
) -> Result<Vec<AxisNoise>> {
    let Some(sensor) = &inspection.sensor else {
        return Ok(Vec::new());
    };
    let channels: Vec<&ChannelFacts> = inspection.groups.iter().flat_map(|g| &g.channels).collect();
    let mut densities = [0.0; LIMBS];
    for (density, name) in densities.iter_mut().zip(&sensor.limbs) {
        let channel = channels.iter().find(|c| &c.name == name);
        let Some((channel, at_rest)) = channel.and_then(|c| Some((c, c.stability.as_ref()?)))
        else {
            return Ok(Vec::new());
        };
        let white = at_rest.noise_density.map(|found| found.value);
        let volts = match unit::named(channel.unit_name()) {
            Some(Unit::Voltage(volts)) => volts,
            _ => 1.0,
        };
        *density = volts
            * white
                .or(channel.noise_density)
                .with_context(|| format!("{}: {name} has no noise density", file.display()))?;
    }
    let setup = Setup::new(calibration, session, Some(file), &Overrides::default())?;
    let axes = axis_noise_densities(&setup, &densities)?;
    let named = MOTION_CHANNELS.iter().zip(axes).enumerate();
    let noise = named.map(|(k, (&(axis, _), noise_density))| AxisNoise {
        axis,
        noise_density,
        unit: if k < 3 { "m/s^2/rtHz" } else { "rad/s^2/rtHz" },
    });
    Ok(noise.collect())
}

fn draw(picture: &Path, outcomes: &[Outcome]) -> Result<()> {
    let read: Vec<&Inspection> = outcomes
        .iter()
        .filter_map(|outcome| match outcome {
            Outcome::Read(inspection) => Some(&**inspection),
            Outcome::Failed { .. } => None,
        })
        .collect();
    if read.is_empty() {
        bail!(
            "no recording could be read: {} is not written",
            picture.display()
        );
    }
    let page = page::page(&read);
    Ok(write_atomically(picture, render(&page)?.as_bytes())?)
}

fn forget_densities(inspection: &mut Inspection) {
    for channel in inspection.groups.iter_mut().flat_map(|g| &mut g.channels) {
        if let Some(spectrum) = &mut channel.spectrum {
            spectrum.densities = Vec::new();
        }
    }
}
