//! Where samples come from. A source runs on a thread of its own and hands batches to the acquisition, which takes all of them:
//! a full queue makes the source wait, never lose.
//!
//! | file | holds |
//! |---|---|
//! | [`settings`] | what the simulated laboratory is |
//! | [`laboratory`] | it in real time, its runs and defects |
//! | [`wire`] | rows of text or little-endian numbers behind a line that describes them |
//! | [`stream`] | that from a loopback TCP port or standard input |
//! | [`play`] | a recording at its own speed or faster |
//! | [`follow`] | a CSV or TDMS file that grows |

pub mod follow;
pub mod laboratory;
pub mod play;
pub mod settings;
pub mod stream;
pub mod wire;

use std::path::Path;
use std::sync::mpsc::SyncSender;

use glam::DVec3;
use serde::Serialize;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::{Entry, Session};

use crate::columns::Batch;
use crate::control::Message;

/// Batches that may wait for the acquisition.
pub const WAITING: usize = 256;
/// Refused rows that are told one by one; of the others it is said how many there are.
const TOLD: u64 = 5;
/// Samples of a batch at most.
pub const LONGEST_BATCH: usize = 4096;

/// What a source is, told when it starts: histories begin anew.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Start {
    /// In words: `simulated laboratory, seed 7`.
    pub title: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whether samples have readings of the reference instruments.
    pub standards: bool,
    /// Whether the truth stands beside them.
    pub truth: bool,
}

impl Start {
    /// A file's, `what` being what kind of file it is, in words.
    fn of_a_file(what: &str, path: &Path, sample_rate_hz: f64, standards: bool) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self {
            title: format!("{what} {name}"),
            sample_rate_hz,
            standards,
            truth: false,
        }
    }
}

/// A run of the rig begins with the next sample, from rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Begin {
    /// What the session file is to say of it.
    pub entry: Entry,
    /// c_i of the amplifier ranges, N/V.
    pub gain_n_per_v: [f64; LIMBS],
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Which trial of the calibration day it is, if it is one.
    pub trial: Option<usize>,
}

impl Begin {
    /// What a session says of one of its recordings, made by hand or played.
    pub fn of(session: &Session, entry: Entry, trial: Option<usize>) -> Self {
        let gains = entry.gain_n_per_v.unwrap_or(session.sensor.gain_n_per_v);
        let down = entry.down.or(entry.direction.map(|d| d.map(|x| -x)));
        let gravity_ground_m_s2 = down.map_or(DVec3::ZERO, |down| {
            DVec3::from_array(down).normalize_or_zero() * session.gravity_m_s2()
        });
        Self {
            gain_n_per_v: gains.each(),
            gravity_ground_m_s2,
            trial,
            entry,
        }
    }
}

/// What reaches the acquisition.
#[derive(Debug)]
pub enum Event {
    /// A source starts.
    Start(Start),
    /// Samples.
    Samples(Box<Batch>),
    /// A run begins.
    Begin(Box<Begin>),
    /// The run is over, or was stopped before.
    End {
        /// Whether it ran to its end.
        complete: bool,
    },
    /// Something to be shown: a connection, a refused row, the end of a file.
    Note(String),
    /// From the browser that holds the controls.
    Control(Message),
    /// A calibration that was computed beside, or why there is none.
    Calibrated(Box<crate::day::Outcome>),
}

/// The way to the acquisition. A send waits while the queue is full; it fails when the instrument is shut down.
pub type Sender = SyncSender<Event>;

/// Tells that a file starts, and what a session says of it; false when the instrument is shut down.
fn starts(start: &Start, begin: Option<Begin>, sender: &Sender) -> bool {
    let begin = begin.map(|begin| Event::Begin(Box::new(begin)));
    let events = std::iter::once(Event::Start(start.clone())).chain(begin);
    events
        .map(|event| sender.send(event))
        .all(|sent| sent.is_ok())
}
