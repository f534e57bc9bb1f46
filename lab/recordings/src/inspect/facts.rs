//! Everything about a recording, as plain data. A number that does not exist is null, and `absent` says why.
//!
//! Numbers of a channel are in the channel's own unit unless their name says otherwise; samples count from 0. JSON is these
//! structures; a terminal's text and a page print [`NUMBERS`] and [`Inspection::facts`].

use std::collections::BTreeMap;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::allan::Stability;
use super::jumps::Jump;
use crate::envelope::Envelope;
use crate::ingest::clock::Stamps;
use crate::runs::Runs;
use crate::unit::{self, Unit};

/// Everything about one file.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection {
    /// The file.
    pub file: String,
    /// Its format and dialect, as found.
    pub format: String,
    /// What it says of itself.
    pub properties: BTreeMap<String, String>,
    /// How it was cut short, if it was.
    pub cut: Option<String>,
    /// Channels that go side by side: of one length, one rate and one start.
    pub groups: Vec<Group>,
    /// Channels that cannot be read.
    pub unreadable: Vec<Unreadable>,
    /// Channels that are one signal.
    pub twins: Vec<Twins>,
    /// The nine limbs and the standards, where they can be told.
    pub sensor: Option<Sensor>,
    /// Root density of the noise of the six accelerations that the limbs' noise makes, where somebody has a calibration.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axis_noise: Vec<AxisNoise>,
    /// What a person should know, in sentences: `noticed` and `remarks` in JSON.
    #[serde(flatten, serialize_with = "noticed_and_remarks")]
    pub facts: Vec<Fact>,
}

impl Inspection {
    /// The facts of one weight, in their order.
    pub fn told(&self, severity: Severity) -> impl Iterator<Item = &Fact> {
        self.facts.iter().filter(move |f| f.severity == severity)
    }
}

/// Weight of a fact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Noticed: a defect of the recording, or the look of one.
    Noticed,
    /// To be known: no defect, or none that one recording can prove.
    Remark,
}

/// One sentence about a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fact {
    /// One word for scripts: `clipped`, `constant`, `still`, `not_finite`, `drift`, `mains`, `identical`, `opposite`, `gap`, `jump`,
    /// `not_advancing`, `jitter`, `rate`, `unreadable`, `empty`, `cut`; `remark` for what is no defect.
    pub kind: &'static str,
    /// Channels concerned.
    pub channels: Vec<String>,
    /// The sentence with its numbers.
    pub text: String,
    /// Its weight.
    #[serde(skip)]
    pub severity: Severity,
}

fn noticed_and_remarks<S: Serializer>(facts: &[Fact], to: S) -> Result<S::Ok, S::Error> {
    let of = |severity| facts.iter().filter(move |f| f.severity == severity);
    let noticed: Vec<&Fact> = of(Severity::Noticed).collect();
    let remarks: Vec<&str> = of(Severity::Remark).map(|f| f.text.as_str()).collect();
    let mut map = to.serialize_map(Some(2))?;
    map.serialize_entry("noticed", &noticed)?;
    map.serialize_entry("remarks", &remarks)?;
    map.end()
}

/// White noise of one decoupled acceleration at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisNoise {
    /// Axis: `ax` to `alpha_z`.
    pub axis: &'static str,
    /// One-sided root density.
    pub noise_density: f64,
    /// Its unit: m/s^2 or rad/s^2 per root(Hz).
    pub unit: &'static str,
}

/// A channel that cannot be read.
#[derive(Debug, Clone, Serialize)]
pub struct Unreadable {
    /// Its name.
    pub channel: String,
    /// Why.
    pub cause: String,
}

/// Who says the sample rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RateOrigin {
    /// The file.
    File,
    /// The time stamps' mean step without gaps.
    TimeStamps,
    /// The session file.
    Session,
    /// Nobody.
    Unknown,
}

impl RateOrigin {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::File => "says the file",
            Self::TimeStamps => "from the time stamps",
            Self::Session => "says the session",
            Self::Unknown => "unknown",
        }
    }
}

/// Channels of one length, one rate and one start.
#[derive(Debug, Clone, Serialize)]
pub struct Group {
    /// Samples of each channel.
    pub samples: u64,
    /// Samples per second.
    pub sample_rate_hz: Option<f64>,
    /// Who says so.
    pub sample_rate_origin: RateOrigin,
    /// Samples over rate; with time stamps, from the first to the last and one step more, gaps included.
    pub duration_s: Option<f64>,
    /// What the time stamps say, if there are any.
    pub time_stamps: Option<Stamps>,
    /// The channels but the time stamps.
    pub channels: Vec<ChannelFacts>,
    /// How they go together; none for a single channel and for too many.
    pub correlations: Option<Correlations>,
}

impl Group {
    /// Seconds from one sample to the next.
    pub fn step_s(&self) -> Option<f64> {
        self.sample_rate_hz.map(|rate| 1.0 / rate)
    }
}

/// Correlation coefficients of all channels of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlations {
    /// Row by row, in the channels' order; null where a channel does not move. Samples at which any channel is not finite are
    /// left out, but for channels that are not finite for a whole block.
    pub coefficients: Vec<Vec<Option<f64>>>,
}

/// Two channels that are one signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Twins {
    /// Their names.
    pub channels: [String; 2],
    /// The second is the first with its sign turned.
    pub opposite: bool,
    /// Every sample is the same to the last bit; otherwise they agree down to their noise.
    pub exact: bool,
    /// Correlation coefficient.
    pub correlation: Option<f64>,
    /// Standard deviation of the second over that of the first.
    pub ratio: Option<f64>,
}

/// What is known of the sensor's channels.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Sensor {
    /// The nine limbs, in order.
    pub limbs: Vec<String>,
    /// Standard accelerometer.
    pub accelerometer: Option<String>,
    /// Standard gyroscope.
    pub gyroscope: Option<String>,
    /// Limbs that read one value throughout.
    pub dead: Vec<String>,
    /// Limbs that show nothing but noise while most others move: dead, or out of this motion's reach.
    pub silent: Vec<String>,
}

/// What tells a channel's samples from another's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Prints {
    /// Of the samples.
    pub same: u64,
    /// Of the samples with their signs turned.
    pub turned: u64,
    /// Says whether anything can be told: constant channels are alike for other reasons.
    pub moves: bool,
}

/// A channel's unit.
#[derive(Debug, Clone, Serialize)]
pub struct UnitFacts {
    /// As the file has it.
    pub name: String,
    /// What it measures, if it is understood.
    pub measures: Option<&'static str>,
    /// Its size in V, m/s^2, rad/s or s.
    pub size_si: Option<f64>,
}

impl UnitFacts {
    /// Looks the unit up.
    pub fn new(name: &str) -> Self {
        let known = unit::named(name);
        Self {
            name: name.to_owned(),
            measures: known.map(Unit::quantity),
            size_si: known.map(Unit::size_si),
        }
    }
}

/// One end of a channel where it stands still.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlatTop {
    /// The value.
    pub value: f64,
    /// Samples that have it.
    pub samples: u64,
    /// Most of them in a row.
    pub longest_run: u64,
    /// The first.
    pub first_sample: u64,
    /// The value is one at which converters end: 1, 1.25, 2, 2.5 or 5 times a power of ten, or of whole numbers a power of two.
    pub at_round_limit: bool,
}

/// A line in the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Frequency in Hz, or in cycles per sample where no rate is known.
    pub frequency: f64,
    /// Amplitude of the sine.
    pub amplitude: f64,
}

/// A power spectral density.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Densities {
    /// Samples of a segment.
    pub segment: usize,
    /// Segments averaged.
    pub segments: usize,
    /// Segments left out because a value in them is not finite.
    pub segments_left_out: usize,
    /// From one line to the next, Hz, or cycles per sample where no rate is known. The first line stands at 0.
    pub line_distance: f64,
    /// One-sided densities, unit^2 per Hz or per cycle per sample. Left empty where they are not asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub densities: Vec<f64>,
}

/// Everything about one channel.
#[derive(Debug, Clone, Serialize)]
pub struct ChannelFacts {
    /// Its name.
    pub name: String,
    /// Its unit, if the file says one.
    pub unit: Option<UnitFacts>,
    /// Time of its first sample against the file's start, s.
    pub start_offset_s: f64,
    /// Samples.
    pub samples: u64,
    /// Samples that are not a number.
    pub not_a_number: u64,
    /// Samples that are infinite.
    pub infinite: u64,
    /// The first of either.
    pub first_not_finite: Option<u64>,
    /// Smallest finite sample.
    pub minimum: Option<f64>,
    /// Largest finite sample.
    pub maximum: Option<f64>,
    /// Mean of the finite samples.
    pub mean: Option<f64>,
    /// Standard deviation of the finite samples (over their number).
    pub standard_deviation: Option<f64>,
    /// Standard deviation of the white noise: median over pieces of 4,096 samples.
    pub noise_floor: Option<f64>,
    /// One-sided density of the same, unit per root(Hz); null where no rate is known.
    pub noise_density: Option<f64>,
    /// Smallest difference of two samples.
    pub smallest_step: Option<f64>,
    /// Bits that the range needs in such steps, where all samples stand on a grid of them.
    pub bits_used: Option<f64>,
    /// One value throughout.
    pub constant: bool,
    /// Its runs of equal samples.
    #[serde(skip)]
    pub runs: Runs,
    /// Standing still at the smallest value.
    pub flat_bottom: Option<FlatTop>,
    /// Standing still at the largest value.
    pub flat_top: Option<FlatTop>,
    /// Samples at the converter's limit that the session states, or beyond.
    pub at_full_scale: Option<u64>,
    /// Mean of the last tenth less mean of the first.
    pub drift: Option<f64>,
    /// Where it leaves its own course from one sample to the next.
    #[serde(skip)]
    pub jumps: Vec<Jump>,
    /// The drift is no part of the motion, as far as the scatter within the two tenths tells.
    pub drift_stands_out: bool,
    /// Highest line that stands out, lowest lines left aside.
    pub dominant: Option<Line>,
    /// Lines of the mains.
    pub mains: Vec<Line>,
    /// Welch's spectrum.
    pub spectrum: Option<Densities>,
    /// At rest: how it keeps its value over averaging times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// What tells its samples from another channel's.
    #[serde(skip)]
    pub prints: Prints,
    /// Why a number is null.
    pub absent: BTreeMap<&'static str, &'static str>,
    /// History for drawing.
    #[serde(skip)]
    pub history: Envelope,
}

impl ChannelFacts {
    /// The unit's name; empty for none.
    pub fn unit_name(&self) -> &str {
        self.unit.as_ref().map_or("", |unit| unit.name.as_str())
    }

    /// Whether the unit is one of this quantity.
    pub fn measures(&self, quantity: &str) -> bool {
        self.unit
            .as_ref()
            .is_some_and(|unit| unit.measures == Some(quantity))
    }

    /// Samples that are numbers.
    pub const fn finite(&self) -> u64 {
        self.samples - self.not_a_number - self.infinite
    }
}

/// A number of a channel, as every table has it: heading, significant digits, value.
pub type Number = (&'static str, usize, fn(&ChannelFacts) -> Option<f64>);

/// The numbers of a channel in the order of a table.
pub const NUMBERS: [Number; 9] = [
    ("min", 4, |c| c.minimum),
    ("max", 4, |c| c.maximum),
    ("mean", 4, |c| c.mean),
    ("std dev", 4, |c| c.standard_deviation),
    ("noise", 4, |c| c.noise_floor),
    ("density", 4, |c| c.noise_density),
    ("step", 4, |c| c.smallest_step),
    ("bits", 3, |c| c.bits_used),
    ("drift", 4, |c| c.drift),
];
