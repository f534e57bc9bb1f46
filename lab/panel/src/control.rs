//! What a browser may say: typed, bounded, and nothing else.

use anyhow::{Result, anyhow, ensure};
use serde::{Deserialize, Serialize};
use sixaxis_core::LIMBS;

use crate::columns::COLUMNS;

/// Longest message, bytes.
pub const LONGEST_MESSAGE: usize = 4096;
/// Most columns and points of a picture.
const MOST_COLUMNS: usize = 24;
const MOST_POINTS: u16 = 4096;

/// How the rig moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Along the wedge's direction.
    Linear,
    /// About it.
    Angular,
    /// Both.
    Compound,
}

/// A run that a person asks for.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FreeRun {
    /// How the rig moves.
    pub motion: Motion,
    /// Which wedge, from 0.
    pub wedge: usize,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// Share of the rig's amplitude.
    pub amplitude: f64,
    /// Time at full speed, s.
    pub seconds: f64,
}

/// What may go wrong in the simulated laboratory. Limbs are counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Defect {
    /// A channel shows no load any more.
    Dead {
        /// Which.
        limb: usize,
    },
    /// A channel's zero drifts by 5 mV/s.
    Drift {
        /// Which.
        limb: usize,
    },
    /// The wedge is off by 3 degrees, from the next run on.
    Slip {},
}

/// For the simulated laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LabCommand {
    /// A run.
    Run(FreeRun),
    /// A recording of the calibration day, 0 the static one.
    Trial(usize),
    /// The rig stands still.
    Stop,
    /// A defect, or none any more.
    Defect(Option<Defect>),
    /// Laboratory time over real time.
    Speed(f64),
}

/// The stages before the decoder.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Stages {
    /// Corner of the causal low-pass, Hz.
    pub low_pass_hz: Option<f64>,
    /// Single wild samples are replaced (Hampel's test, 5 samples on either side, 5 standard deviations).
    pub outliers: bool,
    /// Corner of the amplifiers' high-pass that is undone, Hz.
    pub high_pass_hz: Option<f64>,
    /// Rate and attitude are held at zero while the sensor rests.
    pub hold_at_rest: bool,
}

impl Default for Stages {
    fn default() -> Self {
        Self {
            low_pass_hz: Some(100.0),
            outliers: false,
            high_pass_hz: None,
            hold_at_rest: true,
        }
    }
}

/// Whose 25 parameters are decoded with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameters {
    /// The design's, with the zeros of the last second.
    Design,
    /// Those of the calibration file that the command was given.
    File,
    /// Those of the calibration day so far.
    Day,
}

/// Format of a finished recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    /// LabVIEW's.
    Tdms,
    /// Columns.
    Parquet,
    /// Text.
    Csv,
}

impl FileFormat {
    /// Ending of a file's name.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Tdms => "tdms",
            Self::Parquet => "parquet",
            Self::Csv => "csv",
        }
    }
}

/// What a browser wants drawn: any may say that.
#[derive(Debug, Clone, PartialEq, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Columns.
    pub columns: Vec<usize>,
    /// Time from left to right, s.
    pub span_s: f64,
    /// Time at the right edge, s; none for now.
    pub end_s: Option<f64>,
    /// Points from left to right.
    pub points: u16,
}

/// A message, as it is written: the first four for the server, all others for the instrument.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Message {
    /// What is to be drawn.
    View(View),
    /// A picture has been drawn.
    Seen {
        /// Its number.
        picture: u32,
    },
    /// The browser wants to hold the controls: only one that holds them may say what follows below.
    Take {},
    /// It does not any more.
    Release {},
    /// A run of the simulated laboratory.
    Run {
        /// Which.
        run: FreeRun,
    },
    /// The simulated rig stands still.
    Stop {},
    /// A defect of the simulated laboratory.
    Defect {
        /// Which, or none any more.
        defect: Option<Defect>,
    },
    /// Laboratory time over real time.
    Speed {
        /// That ratio.
        speed: f64,
    },
    /// Start a recording.
    Record {
        /// Its name without ending.
        name: String,
        /// Its format.
        format: FileFormat,
    },
    /// End it.
    StopRecording {},
    /// Other stages.
    Stages {
        /// Which.
        stages: Stages,
    },
    /// Other parameters.
    Parameters {
        /// Whose.
        parameters: Parameters,
    },
    /// The fault monitor on or off.
    Watch {
        /// Whether it is on.
        on: bool,
    },
    /// Decode from rest, identity attitude, zero rate; take the zeros of the last second for the design's parameters.
    Restart {},
    /// Record a trial of the calibration day: begin, or with `done` end.
    Capture {
        /// Which, 0 the static one.
        trial: usize,
        /// Whether it is to end.
        done: bool,
    },
    /// Take a trial out of the calibration day.
    Discard {
        /// Which.
        trial: usize,
    },
    /// Clear counts of clipped samples.
    ClearCounts {},
}

impl Message {
    /// Reads a message and checks its bounds.
    ///
    /// # Errors
    /// No message of the protocol, or one with a number or a name out of bounds: why it is refused.
    pub fn parse(text: &str) -> Result<Self> {
        let short = text.len() <= LONGEST_MESSAGE;
        ensure!(short, "a message is at most 4096 bytes");
        let message: Self =
            serde_json::from_str(text).map_err(|e| anyhow!("not understood: {e}"))?;
        message.check()?;
        Ok(message)
    }

    fn check(&self) -> Result<()> {
        let within = |ok: bool, cause: &'static str| {
            ensure!(ok, cause);
            Ok(())
        };
        match self {
            Self::View(view) => {
                within(view.columns.len() <= MOST_COLUMNS, "at most 24 columns")?;
                within(view.columns.iter().all(|c| *c < COLUMNS), "no such column")?;
                let span = (1e-3..=3600.0).contains(&view.span_s);
                within(span, "a span is 1 ms to 1 h")?;
                let end = view.end_s.is_none_or(|s| (0.0..=1e9).contains(&s));
                within(end, "no such time")?;
                within((2..=MOST_POINTS).contains(&view.points), "2 to 4096 points")
            }
            Self::Run { run } => {
                let turns = (0.1..=5.0).contains(&run.frequency_hz);
                within(turns, "the rig turns at 0.1 to 5 Hz")?;
                let amplitude = (0.001..=1.0).contains(&run.amplitude);
                within(amplitude, "an amplitude is 0.1 % to 100 %")?;
                within((0.0..=60.0).contains(&run.seconds), "a run is at most 60 s")?;
                within(run.wedge < 6, "there are six wedges")
            }
            Self::Defect {
                defect: Some(Defect::Dead { limb } | Defect::Drift { limb }),
            } => within((1..=LIMBS).contains(limb), "limbs are 1 to 9"),
            Self::Speed { speed } => within((0.1..=100.0).contains(speed), "a speed is 0.1 to 100"),
            Self::Record { name, .. } => within(
                is_name(name),
                "a name is 1 to 80 letters, digits, - _ or .; the first no dot",
            ),
            Self::Stages { stages } => {
                let corner = |hz: Option<f64>| hz.is_none_or(|hz| (1e-3..=5e4).contains(&hz));
                let both = corner(stages.low_pass_hz) && corner(stages.high_pass_hz);
                within(both, "a corner is 0.001 to 50000 Hz")
            }
            Self::Capture { trial, .. } | Self::Discard { trial } => {
                within(*trial < 1000, "no such trial")
            }
            _ => Ok(()),
        }
    }
}

/// Whether a recording may be called so: one part of a path that hides nowhere and leads nowhere else.
pub fn is_name(name: &str) -> bool {
    (1..=80).contains(&name.len())
        && !name.starts_with('.')
        && name
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b"-_.".contains(&b))
}

#[cfg(test)]
mod tests;
