//! Whether a file's attitudes are those that the channels show.
//!
//! An attitude that contradicts the filter is given little weight, and after four in a row the filter gives way: right where one of many is
//! wrong, or the channels are worse than stated. Attitudes in another convention end there, too, with deviations that look as if all were
//! well. Therefore they are held against what was decoded, where that is known: two accounts of the attitude that contradict each other leave
//! none that is known.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::DQuat;
use sixaxis_core::aided::{Aid, AidedDecoupler};
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::{LimbSet, SixAxis};
use sixaxis_recordings::inspect::listing::brief;
use thiserror::Error;

use super::Row;
use super::aided::turned_back;
use super::aids::Fix;

/// Chi square with three degrees of freedom that one of a thousand attitudes exceeds: those that count little for the filter, too.
const ONE_OF_A_THOUSAND: f64 = 16.27;
/// That one of a million exceeds, where a single one is enough.
const ONE_OF_A_MILLION: f64 = 30.66;
/// Deviation up to which the channels alone know the attitude, degrees: first order holds.
const KNOWN_DEG: f64 = 5.0;
/// The largest share of attitudes that may be wrong, as a camera now and then takes one marker for another, is one in so many.
const WRONG_ONE_IN: u64 = 4;
/// Attitudes from which on one that is wrong is an exception.
const MANY: u64 = 4;

/// Another convention in which attitudes may be given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reading {
    Conjugate,
    LastW,
    ConjugateLastW,
}

impl Reading {
    const ALL: [Self; 3] = [Self::Conjugate, Self::LastW, Self::ConjugateLastW];

    /// The attitude that a file means by what `--aid` takes for this one.
    fn meant(self, read: DQuat) -> DQuat {
        let last = DQuat::from_xyzw(read.w, read.x, read.y, read.z);
        match self {
            Self::Conjugate => read.conjugate(),
            Self::LastW => last,
            Self::ConjugateLastW => last.conjugate(),
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Conjugate => {
                "from the ground's axes to the sensor's; change the signs of qx, qy and qz"
            }
            Self::LastW => "with qw in the last place; exchange the columns",
            Self::ConjugateLastW => {
                "with qw in the last place and from the ground's axes to the sensor's; exchange the columns and change the signs of qx, qy and qz"
            }
        }
    }
}

/// A file's attitudes contradict what the channels show.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct Contradiction {
    file: PathBuf,
    first: Departure,
    /// Attitudes that contradict, of how many that were held against a known one; none where the first contradicts.
    counts: Option<[u64; 2]>,
    reading: Option<Reading>,
}

/// An attitude that contradicts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Departure {
    /// Its place in the file, from 1.
    number: usize,
    time_s: f64,
    off_deg: f64,
    stated_deg: f64,
    known_deg: f64,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Departure {
            number,
            time_s,
            off_deg,
            stated_deg,
            known_deg,
        } = self.first;
        write!(f, "{}: ", self.file.display())?;
        if let Some([wrong, held]) = self.counts {
            write!(
                f,
                "{wrong} of {held} attitudes contradict the channels, so that nobody knows the ground's axes; the first is "
            )?;
        }
        write!(
            f,
            "attitude {number}, at {time_s} s: {off_deg:.1}° off what the channels make of the first sample's, which they know to {known_deg:.2}°; it is stated to {}° about each axis. --aid takes attitudes from the sensor's axes to the ground's, qw first, 1, 0, 0, 0 at the first sample, on the recording's clock. ",
            brief(stated_deg, 3)
        )?;
        match self.reading {
            Some(reading) => write!(f, "These would fit {}", reading.words()),
            None => f.write_str(
                "If these are, then DEGREES is too small, the recording begins in motion, or the calibration is not that of this sensor as it is now",
            ),
        }
    }
}

/// How many attitudes contradict something.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    held: u64,
    wrong: u64,
    first: Option<Departure>,
    /// How many of those that contradict would not in each reading.
    would_fit: [u64; Reading::ALL.len()],
}

impl Count {
    /// Holds an attitude against what was decoded at its time: how far it is off, in units of [`AidedDecoupler::departure`]. Where nothing is
    /// known nothing contradicts.
    fn look(&mut self, decoder: &AidedDecoupler, fix: &Fix, then: &SixAxis) -> Option<f64> {
        let Aid::Attitude {
            attitude,
            deviation_rad,
        } = fix.aid
        else {
            return None;
        };
        let departure = |attitude: DQuat| {
            let aid = Aid::Attitude {
                attitude,
                deviation_rad,
            };
            decoder.departure(&aid, then)
        };
        let off = departure(attitude)?;
        self.held += 1;
        if off <= ONE_OF_A_THOUSAND {
            return Some(off);
        }
        self.wrong += 1;
        for (count, reading) in self.would_fit.iter_mut().zip(Reading::ALL) {
            let would = departure(reading.meant(attitude));
            *count += u64::from(would.is_some_and(|off| off <= ONE_OF_A_THOUSAND));
        }
        self.first.get_or_insert(Departure {
            number: fix.number,
            time_s: fix.time_s,
            off_deg: attitude.angle_between(then.attitude).to_degrees(),
            stated_deg: deviation_rad.to_degrees(),
            known_deg: known_deg(decoder),
        });
        Some(off)
    }

    /// The first of too many to be exceptions.
    fn too_many(&self) -> Option<Departure> {
        let is_exception = self.wrong == 1 && self.held >= MANY;
        let too_many = WRONG_ONE_IN * self.wrong > self.held && !is_exception;
        self.first.filter(|_| too_many)
    }

    /// The convention in which most of those that contradict would fit.
    fn reading(&self) -> Option<Reading> {
        let fitting = self.would_fit.iter().zip(Reading::ALL);
        let most = fitting
            .filter(|(count, _)| 2 * **count > self.wrong)
            .max_by_key(|(count, _)| **count);
        most.map(|(_, reading)| reading)
    }
}

fn known_deg(decoder: &AidedDecoupler) -> f64 {
    decoder.deviations().attitude_rad().to_degrees()
}

/// Holds a file's attitudes against what was decoded.
pub(super) struct Agreement {
    file: PathBuf,
    /// Decodes by the channels alone, for as long as they know the attitude, and has the last sample: what wrong attitudes have done to the
    /// decoder that uses them is not in it.
    alone: Option<Box<(AidedDecoupler, Option<SixAxis>)>>,
    by_the_channels: Count,
    /// Of all times, against the decoder that uses them.
    by_all: Count,
    /// Whether the first that was used contradicts the channels.
    at_once: bool,
}

impl Agreement {
    /// Beside a decoder that is new.
    pub(super) fn new(file: &Path, decoder: AidedDecoupler) -> Self {
        Self {
            file: file.to_owned(),
            alone: Some(Box::new((decoder, None))),
            by_the_channels: Count::default(),
            by_all: Count::default(),
            at_once: false,
        }
    }

    /// Takes what the decoder takes, too.
    pub(super) fn push(&mut self, voltage_v: &Row) {
        let Some((decoder, last)) = self.alone.as_deref_mut() else {
            return;
        };
        match decoder.push(voltage_v) {
            Ok(answer) if known_deg(decoder) <= KNOWN_DEG => *last = answer,
            // What it cannot decode the other decoder says.
            _ => self.alone = None,
        }
    }

    pub(super) fn set_zero_wander(&mut self, wander: ZeroWander) {
        if let Some((decoder, _)) = self.alone.as_deref_mut() {
            decoder.set_zero_wander(wander);
        }
    }

    pub(super) fn set_excluded(&mut self, limbs: LimbSet) -> sixaxis_core::Result<()> {
        match self.alone.as_deref_mut() {
            Some((decoder, _)) => decoder.set_excluded(limbs),
            None => Ok(()),
        }
    }

    /// Looks at an attitude of so much before the last sample, s, beside what the channels say.
    pub(super) fn look_alone(&mut self, fix: &Fix, earlier_s: f64) {
        if let Some((decoder, Some(last))) = self.alone.as_deref() {
            let then = turned_back(last, earlier_s);
            let is_first = self.by_the_channels.held == 0 && self.by_all.held == 0;
            let off = self.by_the_channels.look(decoder, fix, &then);
            self.at_once |= is_first && off.is_some_and(|off| off > ONE_OF_A_MILLION);
        }
    }

    /// Looks at an attitude before the decoder uses it, beside what was decoded at its time.
    pub(super) fn look_aided(&mut self, decoder: &AidedDecoupler, fix: &Fix, then: &SixAxis) {
        self.by_all.look(decoder, fix, then);
    }

    /// What is wrong with the attitudes so far, or when the recording has ended: the first may contradict from the start, and of all more
    /// than one in four.
    pub(super) fn contradiction(&self, ended: bool) -> Option<Contradiction> {
        let because_of = |count: &Count, first: Departure| Contradiction {
            file: self.file.clone(),
            first,
            counts: (!self.at_once).then_some([count.wrong, count.held]),
            reading: count.reading(),
        };
        let alone = &self.by_the_channels;
        if let Some(first) = alone.first.filter(|_| self.at_once) {
            return Some(because_of(alone, first));
        }
        let counts = [alone, &self.by_all].into_iter().filter(|_| ended);
        counts
            .filter_map(|count| Some(because_of(count, count.too_many()?)))
            .next()
    }
}
