//! What may have been done to plugs or to names, how it is put right, and what is said of it.

use core::ops::Range;

use sixaxis_core::{Gains, LIMBS};

use crate::diagnosis::trial_case::TrialCase;
use crate::finding::Cause;
use crate::response::ChannelResponse;
use crate::trial::Trial;

/// What was done to plugs, or to names. Each is put right by doing it again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Plugs {
    Exchanged(usize, usize),
    /// In writing only: what stands in one channel came through the other's amplifier.
    Misnamed(usize, usize),
    Inverted(usize),
    /// A standard's, which is the same as a direction that is stated the other way round.
    OfTheStandard,
}

/// Two limbs.
pub(super) fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..LIMBS).flat_map(|a| (a + 1..LIMBS).map(move |b| (a, b)))
}

impl Plugs {
    /// All that can be done to one, two or a standard. Of equal ranges names and plugs are the same.
    pub(super) fn all(cases: &[TrialCase<'_>]) -> impl Iterator<Item = Self> {
        let of_equal_ranges = |(a, b): (usize, usize)| {
            let mut gains = cases.iter().map(|case| &case.trial.gains.gain_n_per_v);
            gains.all(|gain| gain[a] == gain[b])
        };
        let exchanged = pairs().map(|(a, b)| Self::Exchanged(a, b));
        let misnamed = pairs().filter(move |pair| !of_equal_ranges(*pair));
        exchanged
            .chain(misnamed.map(|(a, b)| Self::Misnamed(a, b)))
            .chain((0..LIMBS).map(Self::Inverted))
            .chain([Self::OfTheStandard])
    }

    /// Voltages.
    pub(super) fn put_right(self, channels_v: &mut [f64; LIMBS]) {
        match self {
            Self::Exchanged(a, b) | Self::Misnamed(a, b) => channels_v.swap(a, b),
            Self::Inverted(a) => channels_v[a] = -channels_v[a],
            Self::OfTheStandard => {}
        }
    }

    /// Responses, which are forces by the gains that are written.
    pub(super) fn responses_put_right(
        self,
        channels: &mut [ChannelResponse; LIMBS],
        gains: &Gains,
    ) {
        match self {
            Self::Exchanged(a, b) => channels.swap(a, b),
            Self::Misnamed(a, b) => {
                let over = gains.gain_n_per_v[a] / gains.gain_n_per_v[b];
                (channels[a], channels[b]) = (channels[b] * over, channels[a] * (1.0 / over));
            }
            Self::Inverted(a) => channels[a] = channels[a] * -1.0,
            // What the channels show of a standard the other way round.
            Self::OfTheStandard => channels.iter_mut().for_each(|c| *c = *c * -1.0),
        }
    }

    /// The trial with each limb's signal in its own channel, and with the gain of the amplifier that it went through.
    pub(super) fn trial_put_right(self, trial: &Trial) -> Trial {
        let mut right = trial.clone();
        right
            .voltage_v
            .iter_mut()
            .for_each(|row| self.put_right(row));
        if let Self::Exchanged(a, b) = self {
            right.gains.gain_n_per_v.swap(a, b);
        }
        if self == Self::OfTheStandard {
            let series = [&mut right.accelerometer_m_s2, &mut right.gyroscope_rad_s];
            for x in series.into_iter().flatten() {
                *x = -*x;
            }
        }
        right
    }

    /// Cause, channels from 1, what makes the trials agree, what to do.
    pub(super) fn in_words(self) -> (Cause, Vec<usize>, String, String) {
        match self {
            Self::Exchanged(a, b) => {
                let (a, b) = (a + 1, b + 1);
                (
                    Cause::SwappedChannels,
                    vec![a, b],
                    format!("channels {a} and {b} exchanged"),
                    format!(
                        "exchange channels {a} and {b} in the [channels] of the session or of these recordings, and with them entries {a} and {b} of \
                         each gain_n_per_v, since a range stays with its amplifier; or exchange the plugs and record again"
                    ),
                )
            }
            Self::Misnamed(a, b) => {
                let (a, b) = (a + 1, b + 1);
                (
                    Cause::SwappedChannels,
                    vec![a, b],
                    format!(
                        "the names of channels {a} and {b} exchanged and the gains left as they are"
                    ),
                    format!(
                        "exchange names {a} and {b} in the [channels] of the session or of these recordings, and leave gain_n_per_v as it is: its \
                         entries are the limbs' already"
                    ),
                )
            }
            Self::Inverted(a) => (
                Cause::InvertedChannel,
                vec![a + 1],
                format!("channel {} inverted", a + 1),
                format!("turn channel {} in these recordings, or its plug", a + 1),
            ),
            Self::OfTheStandard => (
                Cause::WrongScaling,
                Vec::new(),
                "the standard of this trial reversed".to_owned(),
                "turn the sign of this recording's direction in the session, or see to the polarity of the standard"
                    .to_owned(),
            ),
        }
    }
}

/// That, one after the other, in the trials from one on or up to one. Several are exchanges of one kind, all day.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Replugged {
    pub(super) plugs: Vec<Plugs>,
    pub(super) trials: Range<usize>,
}

impl Replugged {
    pub(super) fn trial_put_right(&self, trial: &Trial) -> Trial {
        let put_right = |trial: Trial, plugs: &Plugs| plugs.trial_put_right(&trial);
        self.plugs.iter().fold(trial.clone(), put_right)
    }

    /// Cause, channels from 1, what makes the trials agree, what to do.
    pub(super) fn in_words(&self) -> (Cause, Vec<usize>, String, String) {
        if let [one] = self.plugs[..] {
            return one.in_words();
        }
        // Channels, from 1, in which the limbs' signals stand.
        let mut order: [usize; LIMBS] = core::array::from_fn(|limb| limb + 1);
        for plugs in &self.plugs {
            if let Plugs::Exchanged(a, b) | Plugs::Misnamed(a, b) = *plugs {
                order.swap(a, b);
            }
        }
        let moved = (1..=LIMBS).filter(|channel| order[channel - 1] != *channel);
        let list = order.map(|channel| channel.to_string()).join(", ");
        let (with, advice) = if matches!(self.plugs.first(), Some(Plugs::Exchanged(..))) {
            (
                "each with its gain",
                "and those of each gain_n_per_v with them, since a range stays with its amplifier; or put the plugs right and record again",
            )
        } else {
            (
                "and gains left as they are",
                "and leave gain_n_per_v as it is: its entries are the limbs' already",
            )
        };
        (
            Cause::SwappedChannels,
            moved.collect(),
            format!("channels {list} taken for limbs 1 to 9, {with},"),
            format!("put the present entries of [channels] limbs into the order {list}, {advice}"),
        )
    }
}
