//! A plan as TOML: read with refusals that name file and line, and written whole, with comments, to start from.

use std::path::{Path, PathBuf};

use sixaxis_recordings::session::line_at;
use sixaxis_recordings::whole::read_text;
use thiserror::Error;
use toml::{Table, Value};

use super::defect::Kind;
use super::plan::SessionPlan;

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
    let text = read_text(path).map_err(|error| PlanFileError {
        path: path.to_owned(),
        line: None,
        cause: match error {
            sixaxis_recordings::Error::Io { source, .. } => source.to_string(),
            other => other.to_string(),
        },
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

/// A complete plan file: a line that is no comment, section or blank is a key, whose value is still to come.
const TEMPLATE: &str = "\
# A simulated session: sixaxis simulate --plan THIS_FILE --out DIR. What is left out has its default.

# Seed of every random number, 0 to 9223372036854775807.
seed
# The sensor: \"paper\" as identified there, \"design\" as designed there, or \"random\", scattered about the design.
sensor
# From the cube's centre to that of its mass, sensor axes, mm.
mass_centre_mm
# What moves it: \"mujoco\", or \"rigid\", a closed form with limbs that do not give way (fast; k/m has no effect).
engine
# Trials for each of steps 2 to 4; three compound runs come on top.
trials_per_step
# Samples per second of the trials, Hz.
sample_rate_hz
# Static record: length, s, and samples per second, Hz.
static_duration_s
static_rate_hz
# What is wrong: \"none\", \"random\" (one of any kind or none; only the truth folder says which), { kind = \"...\" } with one of
KINDS
# or one in particular, counted from 0, such as
#   { exactly = { kind = \"dead_limb\", magnitude = 1.0, channel = 4 } }
#   { exactly = { kind = \"wrong_gain_in_trial\", magnitude = 2.3, channel = 4, place = { trial = 2 } } }
# Magnitudes, their units and ranges: documentation of sixaxis_reference::laboratory::defect::Kind.
defect

# The rig.
[rig]
# Half the slider's stroke, m.
slider_amplitude_m
# Half the pinion's swing, rad.
rotation_amplitude_rad
# Rest before and after each run, s.
rest_s
# Run-up and run-down, crank periods each; with steady_periods they make whole turns, or rest_s is 0.3 and more.
ramp_periods
# Turns at full speed.
steady_periods
# How the sensor hangs: \"axis_vertical\", or \"axis_level\", where gravity turns in the sensor.
mounting
# Largest error of a wedge as its workshop made it, degrees.
wedge_error_deg
# Angle of the axis off the plumb line (or off the level, where it is level), towards another side on each wedge, degrees.
axis_tilt_deg
# Length of the vector from the axis to the sensor's centre, in another direction on each wedge, of which only what is across the axis counts, mm.
centre_offset_mm
# Length of the crank over that of the connecting rod; 0 for an endless rod.
crank_over_rod
# Crank frequencies of steps 2 and 3, first and last, Hz.
low_band_hz
# Crank frequencies of step 4, first and last, Hz.
high_band_hz
# Taps on the shell, from which k/m is found; simulated in MuJoCo even with engine \"rigid\".
taps

# The limbs beside their axial stiffness; engine \"mujoco\" only.
[limbs]
# Stiffness of a limb square to its axis, of flexures that bend, over its axial one.
lateral_stiffness
# Damping in the same directions over the critical damping of one limb under the whole mass.
lateral_damping
# Mass of a limb over the seismic mass.
mass

# The measuring chain of the nine limbs.
[chain]
# Full-scale sine over the noise of one sample, dB; inf for none.
signal_to_noise_db
# Resolution of the converter, bits; 0 for a perfect one.
resolution_bits
# Limit of the converter, V.
full_scale_v
# Load at rest: \"tared\" away, as a piezo has it, or \"ideal\", the whole of it, which no session file can state and
# `sixaxis calibrate` does not expect.
coupling
# Corner of the charge amplifier's first-order high-pass, Hz, stated in the session file; 0 for none.
amplifier_high_pass_hz
# Standard deviation of the nine stiffnesses over their mean, relative.
stiffness_spread
# Share of its neighbour's charge that a channel shows at most; evenly drawn for each channel.
cross_talk
# Amplitude of 50 Hz on every channel of the trials, V.
hum_v
# Standard deviation of each channel's zero in each trial about the static record's, V.
zero_spread_v
# Standard deviation of the change of each channel's sensitivity over the day, relative.
sensitivity_drift

# Standard accelerometer and gyroscope.
[instruments]
# Class, %: the gain errors are drawn from half of it, either sign.
class_percent
# First-order bandwidth of the gyroscope, Hz, stated in the session file; 0: it follows at once.
gyroscope_bandwidth_hz
# Sine of the run's own peak over the noise of one sample, dB; inf for none.
signal_to_noise_db
";

/// The plan with every key and what it means; [`parse`] makes the same plan of it.
pub fn with_comments(plan: &SessionPlan) -> String {
    // A seed above 2^63 has no form in TOML: it is left out, and has its default.
    let writable = SessionPlan {
        seed: plan.seed.min(i64::MAX as u64),
        ..plan.clone()
    };
    let mut values = Table::try_from(writable).unwrap_or_default();
    if i64::try_from(plan.seed).is_err() {
        values.remove("seed");
    }
    let kinds: Vec<String> = Kind::ALL
        .chunks(5)
        .map(|row| {
            let names: Vec<&str> = row.iter().map(|kind| kind.name()).collect();
            format!("#   {}", names.join(", "))
        })
        .collect();
    let mut text = String::new();
    let mut section = &values;
    for line in TEMPLATE.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            section = values
                .get(name)
                .and_then(Value::as_table)
                .unwrap_or(&values);
        }
        if line == "KINDS" {
            text += &(kinds.join(",\n") + ",\n");
        } else if line.is_empty() || line.starts_with(['#', '[']) {
            text += &format!("{line}\n");
        } else if let Some(value) = section.get(line) {
            text += &format!("{line} = {value}\n");
        }
    }
    text
}
