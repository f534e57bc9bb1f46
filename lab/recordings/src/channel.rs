//! One channel of a recording, and which names are those of time stamps and of sample rates.

use crate::unit::{Unit, in_name, named};

/// Most channels of a table, a matrix or a file; what has more is no recording.
pub(crate) const MOST_CHANNELS: usize = 4096;

/// One channel of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channel {
    /// Name, unique in its file; a TDMS channel is `group/channel`.
    pub name: String,
    /// Unit as the file has it, not interpreted: `V`, `mV`, `m/s^2`, `g`.
    pub unit: Option<String>,
    /// Samples, where the file says so before it is read.
    pub samples: Option<u64>,
    /// Samples per second, where the file says so for this channel.
    pub sample_rate_hz: Option<f64>,
    /// Time of the first sample against the file's start, s.
    pub start_offset_s: f64,
}

impl Channel {
    /// A channel of which only name and unit are known.
    pub fn new(name: impl Into<String>, unit: Option<&str>) -> Self {
        Self {
            name: name.into(),
            unit: unit.map(str::to_owned),
            ..Self::default()
        }
    }

    /// Seconds per unit of its numbers, should they be time stamps; 1 where it states no unit. None: its unit is not one of time.
    pub fn seconds(&self) -> Option<f64> {
        match self.unit.as_deref().map(named) {
            None => Some(1.0),
            Some(Some(Unit::Time(seconds))) => Some(seconds),
            Some(_) => None,
        }
    }

    /// From a heading such as `u1 [mV]`, `u1 (mV)` or `u1`.
    pub fn from_heading(heading: &str) -> Self {
        let heading = heading.trim();
        for (open, close) in [('[', ']'), ('(', ')')] {
            if let Some(inside) = heading.strip_suffix(close)
                && let Some((name, unit)) = inside.rsplit_once(open)
                && !name.trim().is_empty()
            {
                let unit = unit.trim();
                return Self::new(name.trim(), (!unit.is_empty()).then_some(unit));
            }
        }
        Self::new(heading, None)
    }

    /// The heading that [`Self::from_heading`] reads. `f (x)` without a unit would be read as `f` in x: empty brackets say that
    /// there is no unit.
    pub fn heading(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} [{unit}]", self.name),
            None if Self::from_heading(&self.name).name != self.name => format!("{} []", self.name),
            None => self.name.clone(),
        }
    }
}

/// Names by which a time column is known; of two such columns the one that comes first here.
pub(crate) const TIME_NAMES: [&str; 7] = [
    "time",
    "time_s",
    "timestamp",
    "zeit",
    "seconds",
    "elapsed",
    "t",
];

/// Index of the channel that holds time stamps, by its name.
pub fn time_channel(channels: &[Channel]) -> Option<usize> {
    let is_called = |c: &Channel, name: &str| {
        let last = c.name.rsplit('/').next().unwrap_or(&c.name);
        // A temperature is a T, too.
        let stamps = name != "t" || c.unit.is_none() || c.seconds().is_some();
        let alone = in_name(last).map_or(last, |(alone, _)| alone);
        stamps && (last.eq_ignore_ascii_case(name) || alone.eq_ignore_ascii_case(name))
    };
    TIME_NAMES
        .iter()
        .find_map(|name| channels.iter().position(|c| is_called(c, name)))
}

/// Whether a property of this name is the sample rate of the whole file, Hz.
pub fn is_sample_rate(name: &str) -> bool {
    ["sample_rate_hz", "fs_hz", "fs"]
        .iter()
        .any(|known| name.eq_ignore_ascii_case(known))
}

/// Whether a number can be a sample rate.
pub(crate) fn is_rate(hz: f64) -> bool {
    hz.is_finite() && hz > 0.0
}

/// The sample rate that a file has as a text; the error says what it has instead.
pub(crate) fn sample_rate(key: &str, text: &str) -> std::result::Result<f64, String> {
    let rate = text.trim().parse().ok().filter(|rate| is_rate(*rate));
    rate.ok_or_else(|| format!("{key} is {text:?}, not a positive number of samples per second"))
}
