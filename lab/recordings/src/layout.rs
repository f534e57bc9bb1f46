//! What a file says before its samples are read: its channels, which of them is its clock, and how they go together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::began::{BEGAN, Began};
use crate::channel::{Channel, TIME_NAMES, is_rate, time_channel};
use crate::error::{Error, Place, Result};
use crate::session::LIMBS;
use crate::unit::in_name;

/// Names that an error lists.
const NAMED: usize = 40;
/// Share of a sample by which channels that are taken for simultaneous may be apart: start times are rounded, and multiplexed
/// converters take their channels one after the other.
const BETWEEN_SAMPLES: f64 = 0.1;

/// Property that names what of a file is no channel, each with its kind.
pub const LEFT_OUT: &str = "channels_left_out";

/// Everything a file says before its samples are read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    /// Format, as a person would name it: `TDMS`, `CSV (semicolon, decimal comma)`.
    pub format: String,
    /// The channels, in the file's order.
    pub channels: Vec<Channel>,
    /// Which of them holds time stamps, by its name (`time`, `t`, `Zeit` ...).
    pub time: Option<usize>,
    /// Properties of the file itself: title, author, comments, start time.
    pub properties: BTreeMap<String, String>,
    /// How the file was cut short, if it was and could be read up to there: a sentence without the file's name.
    pub cut: Option<String>,
}

impl Layout {
    /// Of a sensor's own recording: `u1` to `u9` in V and, with `standards`, both reference instruments after them, all at one rate.
    pub fn of_a_sensor(sample_rate_hz: Option<f64>, standards: bool) -> Self {
        let limbs = (1..=LIMBS).map(|limb| Channel::new(format!("u{limb}"), Some("V")));
        let mut channels: Vec<Channel> = limbs.collect();
        if standards {
            channels.push(Channel::new("accelerometer", Some("m/s^2")));
            channels.push(Channel::new("gyroscope", Some("rad/s")));
        }
        for channel in &mut channels {
            channel.sample_rate_hz = sample_rate_hz;
        }
        Self {
            channels,
            ..Self::default()
        }
    }

    /// Of channels whose names become unique, of which one may hold time stamps.
    pub(crate) fn new(
        format: impl Into<String>,
        mut channels: Vec<Channel>,
        properties: BTreeMap<String, String>,
    ) -> Self {
        let time = time_channel(&channels);
        make_unique(&mut channels, time);
        Self {
            format: format.into(),
            time,
            channels,
            properties,
            cut: None,
        }
    }

    /// Date and time of the first time stamp, or of the start that a file states for some channels, where either has a date.
    pub(crate) fn began(&self, time: Option<usize>, selected: &[usize]) -> Option<Began> {
        let (said, later_s) = match time {
            Some(time) => {
                let name = &self.channels.get(time)?.name;
                let said = self.properties.get(&format!("{name}/first_timestamp"))?;
                (said, 0.0)
            }
            None => (self.properties.get(BEGAN)?, self.start_s(selected)),
        };
        let ns = crate::text::date_and_time_ns(said.as_bytes())?;
        let universal = crate::text::is_universal(said.as_bytes());
        Some(Began { ns, universal }.later(later_s))
    }

    /// What of the file has the name of time stamps and could not be read, to be said where a clock is missing: ` (time is not read: dates)`.
    pub fn unread_clock(&self) -> String {
        let unread = self.properties.iter().find_map(|(name, value)| {
            let is_clock = TIME_NAMES
                .iter()
                .any(|clock| name.eq_ignore_ascii_case(clock));
            let why = value.strip_prefix("not read: ")?;
            is_clock.then(|| format!(" ({name} is not read: {why})"))
        });
        unread.unwrap_or_default()
    }

    /// The rate of all channels, time stamps aside, if it is the same.
    pub(crate) fn common_rate_hz(&self) -> Option<f64> {
        let channels = self.channels.iter().enumerate();
        let mut rates = channels
            .filter(|(at, _)| Some(*at) != self.time)
            .map(|(_, channel)| channel.sample_rate_hz);
        let first = rates.next()??;
        (is_rate(first) && rates.all(|rate| rate == Some(first))).then_some(first)
    }

    /// Index of a channel by name: as written; or else regardless of case, without the group of a TDMS name, or without the unit
    /// at its end, if only one fits.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.channels
            .iter()
            .position(|c| c.name == name)
            .or_else(|| self.only(|own| own.eq_ignore_ascii_case(name)))
            .or_else(|| {
                let in_a_group = |own: &str| own.strip_suffix(name)?.strip_suffix('/').map(drop);
                self.only(|own| in_a_group(own).is_some())
            })
            .or_else(|| self.only(|own| in_name(own).is_some_and(|(own, _)| own == name)))
    }

    /// Index of the only channel whose name fits.
    fn only(&self, fits: impl Fn(&str) -> bool) -> Option<usize> {
        let mut fitting = (0..self.channels.len()).filter(|k| fits(&self.channels[*k].name));
        fitting.next().filter(|_| fitting.next().is_none())
    }

    /// The error for a channel of this file that is not there. It names those that are.
    pub fn no_such_channel(&self, path: &Path, name: impl Into<String>) -> Error {
        let mut names: Vec<_> = self.channels.iter().map(|c| c.name.as_str()).collect();
        let more = names.len().saturating_sub(NAMED);
        names.truncate(NAMED);
        let mut available = names.join(", ");
        if more > 0 {
            available += &format!(" and {more} more");
        }
        let name = name.into();
        let numbered = format!("{name}_1");
        if self.channels.iter().any(|c| c.name == numbered) {
            available += "; a name that the file has more than once has a number behind it here";
        }
        if let Some(left_out) = self.properties.get(LEFT_OUT) {
            available += &format!("; not read as numbers: {left_out}");
        }
        Error::NoSuchChannel {
            path: path.to_owned(),
            name,
            available,
        }
    }

    /// The number of samples that the channels of a selection share, each without its first `skipped`; 0 where the file does not
    /// say it. Channels of which some begin later than others need not end together.
    ///
    /// # Errors
    /// [`Error::NoSuchChannel`] for an index that is not there, [`Error::LengthMismatch`].
    pub(crate) fn common_length(
        &self,
        path: &Path,
        selected: &[usize],
        skipped: &[u64],
    ) -> Result<u64> {
        let together = skipped.iter().all(|skipped| *skipped == 0);
        let mut common = None;
        for (&index, skipped) in selected.iter().zip(skipped) {
            let channel = self
                .channels
                .get(index)
                .ok_or_else(|| self.no_such_channel(path, format!("#{index}")))?;
            let samples = channel.samples.unwrap_or(0).saturating_sub(*skipped);
            let expected = common.get_or_insert(samples);
            if !together {
                *expected = samples.min(*expected);
                continue;
            }
            let expected = *expected;
            if samples != expected {
                return Err(Error::LengthMismatch {
                    path: path.to_owned(),
                    name: channel.name.clone(),
                    samples,
                    expected,
                });
            }
        }
        Ok(common.unwrap_or(0))
    }

    /// When the last of some channels begins, s against the file's start.
    pub fn start_s(&self, selected: &[usize]) -> f64 {
        let starts = selected.iter().map(|at| self.channels[*at].start_offset_s);
        starts.reduce(f64::max).unwrap_or(0.0)
    }

    /// Samples of each channel of a selection before the last of them begins. Channels without a rate of their own, such as
    /// time stamps, go with the others where these begin together.
    ///
    /// # Errors
    /// [`Error::Malformed`] for channels whose starts are apart by no whole number of samples, or which have no common rate.
    pub(crate) fn alignment(&self, path: &Path, selected: &[usize]) -> Result<Vec<u64>> {
        let clocked = selected
            .iter()
            .filter_map(|at| self.channels.get(*at))
            .filter(|channel| channel.sample_rate_hz.is_some());
        let latest = clocked
            .clone()
            .max_by(|a, b| a.start_offset_s.total_cmp(&b.start_offset_s));
        let together = |c: &Channel| latest.is_some_and(|l| c.start_offset_s == l.start_offset_s);
        let Some(latest) = latest.filter(|_| !clocked.clone().all(together)) else {
            return Ok(vec![0; selected.len()]);
        };
        let skipped = selected.iter().map(|at| {
            let channel = &self.channels[*at];
            let late_s = latest.start_offset_s - channel.start_offset_s;
            let refuse = |cause: &str| {
                let cause = format!(
                    "channel {:?} begins {late_s} s before {:?}, and {cause}",
                    channel.name, latest.name
                );
                Err(Error::malformed(path, Place::Whole, cause))
            };
            if channel.sample_rate_hz != latest.sample_rate_hz {
                return refuse("they have no common sample rate: they cannot be read side by side");
            }
            let samples = late_s * latest.sample_rate_hz.unwrap_or(0.0);
            if (samples - samples.round()).abs() > BETWEEN_SAMPLES {
                return refuse(
                    "that is no whole number of samples: record both with one clock, or save them resampled to one",
                );
            }
            if channel.samples.is_some_and(|all| samples > all as f64) {
                return refuse("ends before that begins");
            }
            Ok(samples.round() as u64)
        });
        skipped.collect()
    }
}

/// Two channels `u` become `u_1` and `u_2`, or the next numbers that are free, so that nobody who asks for `u` is given either. Time
/// stamps keep their name.
fn make_unique(channels: &mut [Channel], time: Option<usize>) {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut repeated: BTreeMap<String, usize> = BTreeMap::new();
    for channel in channels.iter() {
        if !taken.insert(channel.name.clone()) {
            repeated.insert(channel.name.clone(), 0);
        }
    }
    for (at, channel) in channels.iter_mut().enumerate() {
        let Some(count) = repeated.get_mut(&channel.name) else {
            continue;
        };
        if time == Some(at) {
            continue;
        }
        loop {
            *count += 1;
            let name = format!("{}_{count}", channel.name);
            if taken.insert(name.clone()) {
                channel.name = name;
                break;
            }
        }
    }
}
