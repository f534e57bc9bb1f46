//! Something that is wrong with a session, by its cause.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::trial::Trial;

/// What can be wrong.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A recording cannot be read or lacks what the session promises.
    Unreadable,
    /// A channel stands at the converter's limit.
    ClippedConverter,
    /// A limb's channel shows no signal.
    DeadLimb,
    /// Two channels are exchanged.
    SwappedChannels,
    /// A channel has the wrong sign.
    InvertedChannel,
    /// The trials leave a direction out.
    UnderExcitedAxis,
    /// Gravity turns in the sensor and the session does not say so, or the other way round.
    GravityNotHandled,
    /// Volts and millivolts mixed up.
    MillivoltMixUp,
    /// A gain, a sensitivity or a unit is not what the session says.
    WrongScaling,
    /// Sensor and standards, or the recording and the session, do not agree on time.
    ClockMismatch,
    /// The gyroscope lags and nothing undoes it, or another lag than its own is undone.
    GyroscopeLag,
    /// The amplifiers are high-passes and the session does not say so, or the other way round.
    HighPassMisstated,
    /// A channel's zero moved during a run or since the static record.
    DriftDuringRun,
    /// A channel's sensitivity changes from trial to trial.
    FadingSensitivity,
    /// The motion was not along the direction that the wedge sets.
    LooseWedge,
    /// A trial is another sensor's.
    ForeignTrial,
    /// What the channels' noise and the converter's steps do to a run is as much as what fails.
    Noisy,
    /// A trial does not agree with the others, and no cause explains it.
    Unexplained,
    /// The joint fit was asked for and cannot be done.
    JointFitRefused,
}

impl Cause {
    /// Whether it is a channel that shows another share of what is expected than the whole.
    pub(crate) const fn is_a_factor(self) -> bool {
        matches!(
            self,
            Self::DeadLimb | Self::InvertedChannel | Self::MillivoltMixUp | Self::WrongScaling
        )
    }

    /// The name in headings and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unreadable => "recording cannot be used",
            Self::ClippedConverter => "converter clips",
            Self::DeadLimb => "dead limb",
            Self::SwappedChannels => "channels exchanged",
            Self::InvertedChannel => "channel inverted",
            Self::UnderExcitedAxis => "axis not excited",
            Self::GravityNotHandled => "gravity not handled",
            Self::MillivoltMixUp => "volts and millivolts mixed up",
            Self::WrongScaling => "wrong unit or scaling",
            Self::ClockMismatch => "clocks disagree",
            Self::GyroscopeLag => "gyroscope's lag not as stated",
            Self::HighPassMisstated => "amplifiers' high-pass not as stated",
            Self::DriftDuringRun => "zero drifts",
            Self::FadingSensitivity => "sensitivity changes over the day",
            Self::LooseWedge => "wedge loose or wrong",
            Self::ForeignTrial => "trial of another sensor",
            Self::Noisy => "noise or rounding too large",
            Self::Unexplained => "does not fit, cause unknown",
            Self::JointFitRefused => "joint fit refused",
        }
    }
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// What.
    pub cause: Cause,
    /// Recordings concerned; all if empty.
    pub recordings: Vec<String>,
    /// Channels concerned, from 1; all or none in particular if empty.
    pub channels: Vec<usize>,
    /// What was seen, with its numbers.
    pub evidence: String,
    /// What to do.
    pub advice: String,
}

impl Finding {
    /// A cause, what was seen and what to do: of all recordings, and of no channel in particular.
    pub(crate) fn new(
        cause: Cause,
        evidence: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            cause,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: evidence.into(),
            advice: advice.into(),
        }
    }

    /// The same of these recordings alone; of all if there are none.
    pub(crate) fn in_recordings(
        mut self,
        recordings: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        self.recordings = recordings.into_iter().map(Into::into).collect();
        self
    }

    /// The same of one trial's recording alone.
    pub(crate) fn in_trial(self, trial: &Trial) -> Self {
        self.in_recordings([&trial.name])
    }

    /// The same of these limbs' channels, counted from 0; of none in particular if there are none.
    pub(crate) fn on_channels(mut self, limbs: impl IntoIterator<Item = usize>) -> Self {
        self.channels = limbs.into_iter().map(|limb| limb + 1).collect();
        self
    }

    /// The evidence with where it was found.
    pub fn placed(&self) -> String {
        let channels: Vec<String> = self.channels.iter().map(usize::to_string).collect();
        let channels = (!channels.is_empty()).then(|| format!("channel {}", channels.join(", ")));
        let places = [in_a_sentence(&self.recordings), channels];
        let places: Vec<String> = places.into_iter().flatten().collect();
        match places.is_empty() {
            true => self.evidence.clone(),
            false => format!("{}: {}", places.join(", "), self.evidence),
        }
    }

    /// Whether it concerns a channel, from 1, of a recording.
    pub fn concerns(&self, recording: &str, channel: usize) -> bool {
        (self.recordings.is_empty() || self.recordings.iter().any(|name| name == recording))
            && (self.channels.is_empty() || self.channels.contains(&channel))
    }
}

/// Adds a recording that cannot be used to the finding of its cause.
pub(crate) fn unreadable(findings: &mut Vec<Finding>, name: &str, evidence: &str, advice: &str) {
    let known = |other: &&mut Finding| other.evidence == evidence && other.advice == advice;
    if let Some(known) = findings.iter_mut().find(known) {
        known.recordings.push(name.to_owned());
        return;
    }
    findings.push(Finding::new(Cause::Unreadable, evidence, advice).in_recordings([name]));
}

/// Recordings in a sentence: of more than two, the first and how many more; none for none.
pub(crate) fn in_a_sentence(recordings: &[impl AsRef<str>]) -> Option<String> {
    Some(match recordings {
        [] => return None,
        [one] => one.as_ref().to_owned(),
        [first, second] => format!("{} and {}", first.as_ref(), second.as_ref()),
        [first, rest @ ..] => format!("{} and {} more recordings", first.as_ref(), rest.len()),
    })
}
