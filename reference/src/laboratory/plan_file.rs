//! A plan as TOML: read with refusals that name file and line, and written whole, with comments, to start from.

use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;
use toml::de::DeTable;

use super::defect::Kind;
use super::plan::{ChainPlan, InstrumentPlan, RigPlan, SessionPlan};

/// A plan file that is refused.
#[derive(Debug, Error)]
#[error("{}{}: {cause}", path.display(), line.map(|l| format!(", line {l}")).unwrap_or_default())]
pub struct PlanFileError {
    /// The file.
    pub path: PathBuf,
    /// Line, from 1, where it is known.
    pub line: Option<usize>,
    /// What is wrong, and what would be right.
    pub cause: String,
}

/// Reads a plan; what it leaves out is as in [`SessionPlan::default`].
///
/// # Errors
/// [`PlanFileError`] for a file that cannot be read, text that is no TOML, keys that are not known and values of the wrong kind.
pub fn read(path: &Path) -> Result<SessionPlan, PlanFileError> {
    let text = std::fs::read_to_string(path).map_err(|e| PlanFileError {
        path: path.to_owned(),
        line: None,
        cause: e.to_string(),
    })?;
    parse(path, &text)
}

/// The same from text; `path` is what errors name.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str) -> Result<SessionPlan, PlanFileError> {
    toml::from_str(text).map_err(|e| PlanFileError {
        path: path.to_owned(),
        line: e.span().map(|span| line_at(text, span.start)),
        cause: e.message().to_owned(),
    })
}

/// Line, from 1, of a key such as `rig.rest_s`. Of a key that is not there, the line of what should hold it.
#[must_use]
pub fn line_of(text: &str, key: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut line = None;
    let mut table = Some(document.get_ref());
    for part in key.split('.') {
        let Some((name, value)) = table.and_then(|t| t.iter().find(|(k, _)| k.get_ref() == part))
        else {
            break;
        };
        line = Some(line_at(text, name.span().start));
        table = value.get_ref().as_table();
    }
    line
}

fn line_at(text: &str, byte: usize) -> usize {
    let before = &text.as_bytes()[..byte.min(text.len())];
    1 + before.iter().filter(|b| **b == b'\n').count()
}

/// A plan file being written.
struct Text(String);

impl Text {
    fn section(&mut self, comment: &str, name: &str) {
        self.0 += &format!("\n# {comment}\n[{name}]\n");
    }

    fn key(&mut self, comment: &str, name: &str, value: &impl Serialize) {
        for line in comment.lines() {
            self.0 += &format!("# {line}\n");
        }
        // What has no form in TOML, a seed above 2^63, is left out, and has its default.
        if let Ok(value) = toml::Value::try_from(value) {
            self.0 += &format!("{name} = {value}\n");
        }
    }
}

const DEFECT: &str = "\
What is wrong: \"none\", \"random\" (one of any kind or none; only the truth folder says which), { kind = \"...\" } with one of
KINDS,
or one in particular, counted from 0, such as
  { exactly = { inverted_channel = { channel = 4, place = \"everywhere\" } } }
  { exactly = { wrong_gain = { channel = 4, place = { trial = 2 }, factor = 10.0 } } }
All of them with their fields: documentation of sixaxis_reference::laboratory::defect::Defect.";

/// The plan with every key and what it means; [`parse`] makes the same plan of it.
#[must_use]
pub fn with_comments(plan: &SessionPlan) -> String {
    let mut text = Text(
        "# A simulated session: sixaxis simulate --plan THIS_FILE --out DIR. What is left out has its default.\n\n".to_owned(),
    );
    text.key(
        "Seed of every random number, 0 to 9223372036854775807.",
        "seed",
        &plan.seed,
    );
    text.key(
        "The sensor: \"paper\" as identified there, \"design\" as designed there, or \"random\", scattered about the design.",
        "sensor",
        &plan.sensor,
    );
    text.key(
        "What moves it: \"mujoco\", or \"rigid\", a closed form with limbs that do not give way (fast; k/m has no effect).",
        "engine",
        &plan.engine,
    );
    text.key(
        "Trials for each of steps 2 to 4; three compound runs come on top.",
        "trials_per_step",
        &plan.trials_per_step,
    );
    text.key(
        "Samples per second of the trials, Hz.",
        "sample_rate_hz",
        &plan.sample_rate_hz,
    );
    text.key(
        "Static record: length, s, and samples per second, Hz.",
        "static_duration_s",
        &plan.static_duration_s,
    );
    text.key("", "static_rate_hz", &plan.static_rate_hz);
    let kinds: Vec<String> = Kind::ALL
        .chunks(5)
        .map(|row| {
            let names: Vec<&str> = row.iter().map(|kind| kind.name()).collect();
            format!("  {}", names.join(", "))
        })
        .collect();
    text.key(
        &DEFECT.replace("KINDS", &kinds.join(",\n")),
        "defect",
        &plan.defect,
    );
    rig(&mut text, &plan.rig);
    chain(&mut text, &plan.chain);
    instruments(&mut text, &plan.instruments);
    text.0
}

fn rig(text: &mut Text, rig: &RigPlan) {
    text.section("The rig.", "rig");
    text.key(
        "Half the slider's stroke, m.",
        "slider_amplitude_m",
        &rig.slider_amplitude_m,
    );
    text.key(
        "Half the pinion's swing, rad.",
        "rotation_amplitude_rad",
        &rig.rotation_amplitude_rad,
    );
    text.key("Rest before and after each run, s.", "rest_s", &rig.rest_s);
    text.key(
        "Run-up and run-down, crank periods each; with steady_periods they make whole turns.",
        "ramp_periods",
        &rig.ramp_periods,
    );
    text.key(
        "Turns at full speed.",
        "steady_periods",
        &rig.steady_periods,
    );
    text.key(
        "How the sensor hangs: \"axis_vertical\", or \"axis_level\", where gravity turns in the sensor.",
        "mounting",
        &rig.mounting,
    );
    text.key(
        "Largest error of a wedge as its workshop made it, degrees.",
        "wedge_error_deg",
        &rig.wedge_error_deg,
    );
    text.key(
        "Crank frequencies of steps 2 and 3, first and last, Hz.",
        "low_band_hz",
        &rig.low_band_hz,
    );
    text.key(
        "Crank frequencies of step 4, first and last, Hz.",
        "high_band_hz",
        &rig.high_band_hz,
    );
    text.key(
        "Taps on the shell, from which k/m is found; played in MuJoCo even with engine \"rigid\".",
        "taps",
        &rig.taps,
    );
}

fn chain(text: &mut Text, chain: &ChainPlan) {
    text.section("The measuring chain of the nine limbs.", "chain");
    text.key(
        "Full-scale sine over the noise of one sample, dB; inf for none.",
        "signal_to_noise_db",
        &chain.signal_to_noise_db,
    );
    text.key(
        "Resolution of the converter, bits; 0 for a perfect one.",
        "resolution_bits",
        &chain.resolution_bits,
    );
    text.key(
        "Limit of the converter, V.",
        "full_scale_v",
        &chain.full_scale_v,
    );
    text.key(
        "Load at rest: \"tared\" away, as a piezo has it, or \"ideal\", the whole of it, which no session file can state and\n`sixaxis calibrate` does not expect.",
        "coupling",
        &chain.coupling,
    );
    text.key(
        "Corner of the charge amplifier's first-order high-pass, Hz, stated in the session file; 0 for none.",
        "amplifier_high_pass_hz",
        &chain.amplifier_high_pass_hz,
    );
    text.key(
        "Standard deviation of the nine stiffnesses over their mean, relative; engine \"rigid\" only.",
        "stiffness_spread",
        &chain.stiffness_spread,
    );
}

fn instruments(text: &mut Text, instruments: &InstrumentPlan) {
    text.section("Standard accelerometer and gyroscope.", "instruments");
    text.key(
        "Class, %: the gain errors are drawn from half of it, either sign.",
        "class_percent",
        &instruments.class_percent,
    );
    text.key(
        "First-order bandwidth of the gyroscope, Hz, stated in the session file; 0: it follows at once.",
        "gyroscope_bandwidth_hz",
        &instruments.gyroscope_bandwidth_hz,
    );
    text.key(
        "Sine of the run's own peak over the noise of one sample, dB; inf for none.",
        "signal_to_noise_db",
        &instruments.signal_to_noise_db,
    );
}
