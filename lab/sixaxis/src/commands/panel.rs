//! `sixaxis panel`: the virtual instrument in a browser.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};

use anyhow::Result;
use sixaxis_calibration::apply::check_grade::check_grade;
use sixaxis_calibration::apply::statements::same_sensor;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_panel::source::settings::Settings;
use sixaxis_panel::{Options, SourceChoice, start};
use sixaxis_recordings::session::SessionFile;
use sixaxis_reference::laboratory::plan::Engine;

use super::common::{mention, print, tell};
use super::output::make_folder;
use super::simulate::{ENGINES, USUAL_ENGINE, choice};

/// Where samples come from, and who may look.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Take samples from this port of the loopback address instead of the simulated laboratory
    #[arg(long, value_name = "PORT", group = "source")]
    tcp: Option<u16>,
    /// Take samples from standard input
    #[arg(long, group = "source")]
    stdin: bool,
    /// Follow a growing CSV or TDMS file
    #[arg(long, value_name = "FILE", group = "source")]
    follow: Option<PathBuf>,
    /// Play a recording
    #[arg(long, value_name = "FILE", group = "source")]
    play: Option<PathBuf>,
    /// Times the recording's own speed
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, requires = "play", value_parser = speed)]
    speed: f64,
    /// Samples per second: of the simulated laboratory, or where a file does not say
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<f64>,
    /// Seed of the simulated laboratory: its sensor, instruments and noise
    #[arg(long, value_name = "N", default_value_t = 7)]
    seed: u64,
    /// Trials of each of steps 2 to 4 in the simulated laboratory's calibration day
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u8).range(3..=30))]
    trials: u8,
    /// What computes the simulated laboratory's runs [default: mujoco, where it is compiled in]
    #[arg(long, value_parser = choice::<Engine>(ENGINES))]
    engine: Option<Engine>,
    /// Session file: sensor, gains, instruments, and the recordings that the calibration day makes anew; a file that is played or followed has
    /// the gains and the direction of its own entry
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// Calibration to decode with
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Decode with a calibration whose verdict is bad
    #[arg(long, requires = "calibration")]
    force: bool,
    /// Folder for recordings and the calibration day
    #[arg(long, value_name = "FOLDER", default_value = "sixaxis-panel")]
    out: PathBuf,
    /// Port of the page; 0 for any that is free
    #[arg(long, value_name = "PORT", default_value_t = 8765)]
    port: u16,
    /// Address of the page; beyond the loopback address only with --token, and unencrypted
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    listen: IpAddr,
    /// Token of the link, at least 16 letters and digits; drawn afresh if left out
    #[arg(long, value_name = "TOKEN")]
    token: Option<String>,
    /// Print the link and open no browser
    #[arg(long)]
    no_open: bool,
}

const AFTER_HELP: &str = include_str!("panel.txt");

fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(times) if (0.01..=1e4).contains(&times) => Ok(times),
        _ => Err("a number from 0.01 to 10000 is expected".to_owned()),
    }
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hz) if (10.0..=100_000.0).contains(&hz) => Ok(hz),
        _ => Err("a number of samples per second from 10 to 100000 is expected".to_owned()),
    }
}

/// Samples per second of the simulated laboratory, where nobody says others.
const LABORATORY_HZ: f64 = 2000.0;

/// Serves the panel until it is interrupted.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let session = arguments
        .session
        .as_deref()
        .map(SessionFile::read)
        .transpose()?;
    let calibration = match &arguments.calibration {
        Some(path) => {
            let calibration = Calibration::read(path)?;
            let name = path.display().to_string();
            if let Some(doubt) = check_grade(&name, &calibration, arguments.force)? {
                tell("warning", &doubt);
            }
            if let Some(session) = &session {
                same_sensor(&calibration, session)?;
            }
            Some(calibration)
        }
        None => None,
    };
    let source = match arguments {
        Arguments {
            tcp: Some(port), ..
        } => SourceChoice::Port(SocketAddr::from((Ipv4Addr::LOCALHOST, *port))),
        Arguments { stdin: true, .. } => SourceChoice::StandardInput,
        Arguments {
            follow: Some(path), ..
        } => SourceChoice::Follow(path.clone()),
        Arguments {
            play: Some(path),
            speed,
            ..
        } => SourceChoice::Play(path.clone(), *speed),
        _ => SourceChoice::Laboratory(Settings {
            seed: arguments.seed,
            sample_rate_hz: arguments.rate.unwrap_or(LABORATORY_HZ),
            trials_per_step: usize::from(arguments.trials),
            engine: arguments.engine.unwrap_or(USUAL_ENGINE),
        }),
    };
    make_folder(&arguments.out)?;
    let file = arguments.play.as_deref().or(arguments.follow.as_deref());
    let entry = file.and_then(|file| session.as_ref()?.entry(file).cloned());
    let mut panel = start(Options {
        source,
        rate_hz: arguments.rate,
        listen: SocketAddr::new(arguments.listen, arguments.port),
        token: arguments.token.clone(),
        out: arguments.out.clone(),
        session: session.map(|file| file.session),
        entry,
        calibration,
        tell: |text| tell("panel", text),
    })?;
    print(format!("panel: {}\n", panel.link))?;
    if let Some(input) = panel.input {
        print(format!("samples: {input}\n"))?;
    }
    if !arguments.no_open && !open(&panel.link) {
        mention("no browser could be opened; open the link yourself");
    }
    panel.wait();
    Ok(ExitCode::SUCCESS)
}

/// Opens a link in whatever the system takes for that; false if there is no such program.
fn open(link: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(target_os = "windows") {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(link);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.spawn().is_ok()
}
