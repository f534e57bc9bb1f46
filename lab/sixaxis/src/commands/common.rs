//! What several subcommands have in common: arguments, printing.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use clap::error::ErrorKind;
use sixaxis_calibration::Error;
use sixaxis_calibration::apply::setup::Overrides;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::LIMBS;
use sixaxis_recordings::printable::{self, short_numbers};
use sixaxis_recordings::session::SessionFile;
use sixaxis_recordings::unit::{self, Unit};

/// What the limbs' channels are called and measured in, where neither file nor session says it.
#[derive(clap::Args)]
pub struct Naming {
    /// Names of the nine limbs' channels in the file, with commas
    #[arg(long, value_name = "NAMES", value_parser = nine_names)]
    pub channels: Option<[String; LIMBS]>,
    /// Unit of the limbs' channels where the file does not state it: V, mV or uV
    #[arg(long, value_name = "UNIT", value_parser = voltage)]
    pub unit: Option<String>,
}

fn nine_names(text: &str) -> Result<[String; LIMBS], String> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
    if let Some(twice) = names
        .iter()
        .enumerate()
        .find(|(at, name)| names[..*at].contains(name))
    {
        return Err(format!("{:?} stands there twice", twice.1));
    }
    <[String; LIMBS]>::try_from(names)
        .map_err(|other| format!("{} names, nine were expected", other.len()))
}

fn voltage(text: &str) -> Result<String, String> {
    match unit::named(text) {
        Some(Unit::Voltage(_)) => Ok(text.to_owned()),
        _ => Err(format!("a unit of voltage is expected: {}", unit::VOLTAGES)),
    }
}

/// What is known of a recording beside the file itself.
#[derive(clap::Args)]
pub struct Beside {
    /// Session file that has the recording: gains, direction of gravity, channels and rate are taken from it
    #[arg(long, value_name = "FILE")]
    pub session: Option<PathBuf>,
    /// Gains of this recording's amplifier ranges, N/V: one, or nine with commas
    #[arg(
        long,
        value_name = "N/V",
        value_delimiter = ',',
        value_parser = number,
        allow_hyphen_values = true
    )]
    gain: Vec<f64>,
    /// Samples per second, where the file does not state them
    #[arg(long, value_name = "HZ", value_parser = rate, allow_hyphen_values = true)]
    pub rate: Option<f64>,
    /// Direction in which gravity pulls, in the sensor's axes at rest, such as 0,0,-1 with z up; of any length
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    down: Option<[f64; 3]>,
    #[command(flatten)]
    naming: Naming,
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse();
    number.map_err(|_| "a number is expected".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let hz = number(text)?;
    if hz > 0.0 && hz.is_finite() {
        Ok(hz)
    } else {
        Err("a positive number is expected".to_owned())
    }
}

fn vector(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let numbers = numbers.map_err(|_| "three numbers with commas are expected".to_owned())?;
    <[f64; 3]>::try_from(numbers)
        .map_err(|other| format!("{} numbers, three were expected", other.len()))
}

impl Beside {
    /// The options that come before what the session file states.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            gain_n_per_v: self.gain.clone(),
            rate_hz: self.rate,
            down: self.down,
            limbs: self.naming.channels.clone(),
            limbs_unit: self.naming.unit.clone(),
        }
    }

    /// The session file, if one is named.
    pub fn read_session(&self) -> Result<Option<SessionFile>> {
        let path = self.session.as_deref();
        Ok(path.map(SessionFile::read).transpose()?)
    }
}

/// A refusal of options that do not go together, which clap cannot tell: exit code 2, before anything has been read.
pub fn not_understood<T>(cause: impl std::fmt::Display) -> Result<T> {
    Err(clap::Error::raw(ErrorKind::ArgumentConflict, cause).into())
}

/// Refuses `-` where only files are read.
pub fn not_streamed<'a>(inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    ensure!(
        !inputs.into_iter().any(|input| input == Path::new("-")),
        "-: standard input is not read here, files are; only `decouple` takes a recording from it"
    );
    Ok(())
}

/// Refuses a recording that is not there before anything is asked that goes with it.
pub fn check_there(recording: &Path) -> Result<()> {
    let there = recording.metadata();
    there.map_err(|source| sixaxis_recordings::Error::io(recording, source))?;
    Ok(())
}

/// The calibration that a command takes before a recording.
pub fn read_calibration(path: &Path) -> Result<Calibration> {
    Calibration::read(path).map_err(|error| match error {
        Error::Recording(sixaxis_recordings::Error::OtherKind { .. }) => {
            anyhow!("{error}; the calibration comes first, and then the recording")
        }
        other => other.into(),
    })
}

/// Prints to standard output, whatever the names in it. A reader that has gone away, such as `head`, is no error.
pub fn print(text: impl AsRef<str>) -> Result<()> {
    put(&printable::lines(&short_numbers(text.as_ref()), usize::MAX))
}

fn put(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON, its text in escapes where a terminal would not print it.
pub fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let mut json = String::new();
    for c in serde_json::to_string_pretty(value)?.chars() {
        match c {
            '\n' => json.push(c),
            // Outside of strings JSON has none of these, and none is beyond the first plane.
            c if !printable::is_printable(c) => json += &format!("\\u{:04x}", u32::from(c)),
            c => json.push(c),
        }
    }
    put(&(json + "\n"))
}

/// Characters of a message: a file of 20,000 columns has a long list of names.
const MESSAGE: usize = 4000;

/// Prints a message to standard error, whatever the names in it.
pub fn tell(kind: &str, text: &str) {
    let text = printable::lines(&short_numbers(text), MESSAGE);
    mention(&format!("{kind}: {text}"));
}

/// Prints a line to standard error. Where nobody reads it or it cannot be written, the work goes on.
pub fn mention(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Prints to standard error, a line for each text.
pub fn say(kind: &str, texts: &[String]) {
    for text in texts {
        tell(kind, text);
    }
}

/// Width that texts are wrapped to.
const WIDTH: usize = 96;

/// Adds a text, wrapped, with a first line that begins differently from the others.
pub fn wrapped(out: &mut String, first: &str, rest: &str, text: &str) {
    let mut line = first.to_owned();
    let mut empty = true;
    for word in text.split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            out.push_str(&line);
            out.push('\n');
            rest.clone_into(&mut line);
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    out.push_str(&line);
    out.push('\n');
}
