//! `sixaxis simulate`: a campaign as a laboratory would have it: recordings, session file and, apart, the truth.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::de::DeserializeOwned;
use serde::de::value::{Error as ValueError, StrDeserializer};
use sixaxis_core::LIMBS;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::session::line_of;
use sixaxis_reference::laboratory::check::check;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::error::SessionError;
use sixaxis_reference::laboratory::plan::{DefectChoice, Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::plan_file;
use sixaxis_reference::laboratory::session::{simulate_session_watched, work_ms};
use sixaxis_reference::laboratory::tumble::record_tumble;
use sixaxis_reference::laboratory::write::{SESSION_FILE, TRUTH_FOLDER, write, write_beside};

use super::common::print;
use super::output::claim_folder;
use crate::progress::Progress;

/// What to play and where to write.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Folder to write to
    #[arg(long, value_name = "DIR", default_value = "sixaxis-session")]
    out: PathBuf,
    /// Plan to play, TOML; options given here come before what it says
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// Print the complete plan, with comments, and play nothing
    #[arg(long)]
    print_plan: bool,
    /// Seed of every random number; the same seed gives the same files, bit for bit on one kind of processor [default: 1]
    #[arg(long, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// Format of the recordings; .npy is not among them because it has no channel names
    #[arg(long, default_value = "csv",
        value_parser = PossibleValuesParser::new(["csv", "csv.gz", "parquet", "tdms", "npz"]))]
    format: String,
    /// The sensor: as the paper identified it, as it was designed, or scattered about the design [default: paper]
    #[arg(long, value_parser = choice::<SensorChoice>(&["paper", "design", "random"]))]
    sensor: Option<SensorChoice>,
    #[arg(long, help = ENGINE_HELP, value_parser = choice::<Engine>(ENGINES))]
    engine: Option<Engine>,
    /// What is wrong with the session; `random`: one of these or nothing, and only the truth folder tells. Its size is drawn, for most kinds from
    /// where nothing could notice it, a share of the day from where it holds no recording [default: none]
    #[arg(long, value_name = "KIND", value_parser = defect_choice())]
    defect: Option<DefectChoice>,
    /// Trials for each of steps 2 to 4 [default: 10]
    #[arg(long, value_name = "N")]
    trials: Option<usize>,
    /// Samples per second of the trials, Hz [default: 2000]
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Taps on the shell, from which k/m is found; always played in MuJoCo, an eighth of a second of processor time each [default: 0]
    #[arg(long, value_name = "N")]
    taps: Option<usize>,
    /// A recording from the field, too: the sensor tumbled by hand for so many seconds at 10 kHz, in closed form
    #[arg(long, value_name = "SECONDS")]
    tumble: Option<f64>,
    /// A limb whose scale factor has drifted before the tumble, as in 4=0.3%; several with commas
    #[arg(long, value_name = "LIMB=PER CENT", value_delimiter = ',', value_parser = drift, requires = "tumble",
        allow_hyphen_values = true)]
    drift_limb: Vec<(usize, f64)>,
    /// Replace the session that the folder holds
    #[arg(long)]
    force: bool,
}

/// Engines that were compiled in, the default first.
pub const ENGINES: &[&str] = if cfg!(feature = "harness") {
    &["mujoco", "rigid"]
} else {
    &["rigid"]
};

/// The engine where nobody asks for one.
pub const USUAL_ENGINE: Engine = if cfg!(feature = "harness") {
    Engine::Mujoco
} else {
    Engine::Rigid
};

const ENGINE_HELP: &str = if cfg!(feature = "harness") {
    "What computes the motions: MuJoCo, which takes some 40 to 70 s of processor time for the paper's campaign, shared by all cores, or a \
     closed form with rigid limbs, which takes 0.3 s and agrees to some 1e-5 of the largest force up to 5 Hz [default: mujoco]"
} else {
    "What computes the motions: a closed form with rigid limbs, which agrees with MuJoCo to some 1e-5 of the largest force up to 5 Hz; MuJoCo itself is \
     not compiled in [default: rigid]"
};

const AFTER_HELP: &str = include_str!("simulate.txt");

/// One of some words.
pub fn choice<T>(words: &'static [&'static str]) -> impl TypedValueParser<Value = T> + use<T>
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(words.iter().copied())
        .try_map(|word| T::deserialize(StrDeserializer::<ValueError>::new(&word)))
}

/// Limb from 0 and drift, from `4=0.3%`.
fn drift(text: &str) -> Result<(usize, f64), String> {
    let wrong = || format!("{text:?} is not LIMB=PER CENT, as in 4=0.3%");
    let (limb, percent) = text.split_once('=').ok_or_else(wrong)?;
    let limb: usize = limb.trim().parse().map_err(|_| wrong())?;
    let percent: f64 = percent
        .trim()
        .trim_end_matches('%')
        .trim()
        .parse()
        .map_err(|_| wrong())?;
    if (1..=LIMBS).contains(&limb) && percent.abs() < 100.0 {
        Ok((limb - 1, percent / 100.0))
    } else {
        Err(format!("{text:?}: limbs are 1 to 9, drifts below 100 %"))
    }
}

fn defect_choice() -> impl TypedValueParser<Value = DefectChoice> {
    let words = ["none", "random"]
        .into_iter()
        .chain(Kind::ALL.iter().map(|kind| kind.name()));
    PossibleValuesParser::new(words).map(|word| match word.as_str() {
        "none" => DefectChoice::None,
        "random" => DefectChoice::Random,
        _ => Kind::ALL
            .iter()
            .find(|kind| kind.name() == word)
            .map_or(DefectChoice::None, |kind| DefectChoice::Kind(*kind)),
    })
}

/// Plays and writes a session.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let plan = plan(arguments)?;
    if arguments.print_plan {
        print(plan_file::with_comments(&plan))?;
        return Ok(ExitCode::SUCCESS);
    }
    let out = &arguments.out;
    // Before minutes of work, not after them.
    if let Some(duration_s) = arguments.tumble {
        ensure!(
            (LEAST_TUMBLE_S..=LONGEST_TUMBLE_S).contains(&duration_s),
            "--tumble: {duration_s} s; give {LEAST_TUMBLE_S} to {LONGEST_TUMBLE_S}"
        );
    }
    let _ours_alone = claim_folder(out)?;
    ensure!(
        arguments.force || !out.join(SESSION_FILE).exists(),
        "{} holds a session already; give another folder, or --force to replace it",
        out.display()
    );
    let recorded = files_in(out)?.into_iter().find(|file| {
        let written = arguments.format.as_str();
        file.to_string_lossy().ends_with(&format!(".{written}"))
    });
    if let Some(recorded) = recorded.filter(|_| !arguments.force) {
        bail!(
            "{} holds recordings already, {} among them; give another folder, or --force to write over those of the same names",
            out.display(),
            recorded.display()
        );
    }
    let progress = Progress::shown();
    let work = work_ms(&plan)?;
    let played = simulate_session_watched(&plan, &|ms| progress.report("simulating", work, ms))
        .context("cannot play the session")?;
    drop(progress);
    let session = write(&played, out, &arguments.format)?;
    let field = match arguments.tumble {
        Some(duration_s) => Some(from_the_field(arguments, &plan, duration_s)?),
        None => None,
    };
    let field = field.map_or(String::new(), |command| format!("then: {command}\n"));
    print(format!(
        "{}: {} recordings, .{}, and {SESSION_FILE}\nnext: sixaxis calibrate {}\n{field}{} holds what a laboratory does not know: not to be looked at before the verdict\n",
        out.display(),
        played.recordings.len(),
        arguments.format,
        quoted(&session),
        out.join(TRUTH_FOLDER).display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// Names of the files in a folder.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut names = Vec::new();
    for entry in entries {
        let entry = entry.with_context(|| folder.display().to_string())?;
        if entry.file_type().is_ok_and(|kind| kind.is_file()) {
            names.push(PathBuf::from(entry.file_name()));
        }
    }
    names.sort();
    Ok(names)
}

/// Writes a tumble beside the session and says how to check the calibration with it.
fn from_the_field(arguments: &Arguments, plan: &SessionPlan, duration_s: f64) -> Result<String> {
    let mut drift = [0.0; LIMBS];
    for &(limb, share) in &arguments.drift_limb {
        drift[limb] = share;
    }
    let played = record_tumble(plan, duration_s, &drift).context("cannot play the tumble")?;
    let path = write_beside(&played, &arguments.out, &arguments.format)?;
    let truth = arguments.out.join(TRUTH_FOLDER).join("tumble.json");
    let drifted = serde_json::json!({ "drift_of_scale": drift });
    write_atomically(&truth, drifted.to_string().as_bytes())?;
    let gains = played.gain_n_per_v.map(|gain| gain.to_string());
    Ok(format!(
        "sixaxis self-calibrate {} {} --down 0,0,-1 --gain {}",
        quoted(&arguments.out.join("calibration.json")),
        quoted(&path),
        gains.join(",")
    ))
}

/// Lengths of a tumble, s: it is held in the memory.
const LEAST_TUMBLE_S: f64 = 1.0;
const LONGEST_TUMBLE_S: f64 = 600.0;

/// The plan file, if there is one, with the command line's options put in.
fn plan(arguments: &Arguments) -> Result<SessionPlan> {
    let mut plan = match &arguments.plan {
        Some(path) => plan_file::read(path)?,
        None => SessionPlan {
            engine: USUAL_ENGINE,
            ..SessionPlan::default()
        },
    };
    let in_file = plan.clone();
    let Arguments {
        seed,
        sensor,
        engine,
        defect,
        trials,
        rate,
        taps,
        ..
    } = arguments;
    plan.seed = seed.unwrap_or(plan.seed);
    plan.sensor = sensor.unwrap_or(plan.sensor);
    plan.engine = engine.unwrap_or(plan.engine);
    if let Some(defect) = defect {
        plan.defect = defect.clone();
    }
    plan.trials_per_step = trials.unwrap_or(plan.trials_per_step);
    plan.rig.taps = taps.unwrap_or(plan.rig.taps);
    plan.sample_rate_hz = rate.unwrap_or(plan.sample_rate_hz);
    match (check(&plan), &arguments.plan) {
        (Ok(()), _) => Ok(plan),
        (Err(error), Some(path)) if check(&in_file).is_err() => Err(located(path, error)),
        (Err(error), _) => Err(error.into()),
    }
}

/// A refusal with the file and line that it is about.
fn located(path: &Path, error: SessionError) -> anyhow::Error {
    #[cfg_attr(
        not(feature = "harness"),
        expect(irrefutable_let_patterns, reason = "the other errors are MuJoCo's")
    )]
    let SessionError::Plan { key, cause } = &error else {
        return error.into();
    };
    // `defect.exactly: factor` stands in the table `defect.exactly`.
    let line = std::fs::read_to_string(path)
        .ok()
        .and_then(|text| line_of(&text, key.split(':').next().unwrap_or(key)))
        .map(|line| format!(", line {line}"))
        .unwrap_or_default();
    anyhow!("{}{line}: {key}: {cause}", path.display())
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:=@%,".contains(c);
    if text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}
