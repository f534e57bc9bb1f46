//! Voltages to rows of the answer.

use std::collections::VecDeque;

use sixaxis_core::decouple::uncertainty::SampleUncertainty;
use sixaxis_core::{Decoupler, LIMBS, SixAxis};
use sixaxis_recordings::envelope::Envelope;
use sixaxis_recordings::motion::MOTION_CHANNELS;
use sixaxis_recordings::{Block, Channel, Layout};

use super::Row;
use super::fault_watch::{FLAGS, FaultWatch};

/// Which columns are wanted beside the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Columns {
    /// Accelerations, rates, attitude.
    All,
    /// The six accelerations.
    Accelerations,
}

impl Columns {
    /// Their number, without the time.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::All => MOTION_CHANNELS.len(),
            Self::Accelerations => 6,
        }
    }

    /// The layout of the answer: time, then accelerations in ground axes, rates in shell axes, attitude.
    #[must_use]
    pub fn layout(self, sample_rate_hz: f64) -> Layout {
        let channels = [("time", "s")]
            .into_iter()
            .chain(MOTION_CHANNELS.into_iter().take(self.count()))
            .map(|(name, unit)| Channel {
                sample_rate_hz: Some(sample_rate_hz),
                ..Channel::new(name, Some(unit))
            })
            .collect();
        Layout {
            channels,
            time: Some(0),
            ..Layout::default()
        }
    }
}

/// Columns that say how well the accelerations are known, with their units: one standard deviation each.
pub const DEVIATIONS: [(&str, &str); 6] = [
    ("sd_ax", "m/s^2"),
    ("sd_ay", "m/s^2"),
    ("sd_az", "m/s^2"),
    ("sd_alpha_x", "rad/s^2"),
    ("sd_alpha_y", "rad/s^2"),
    ("sd_alpha_z", "rad/s^2"),
];

/// A decoupler with the clock of its recording.
pub struct Decoding {
    decoupler: Decoupler,
    columns: Columns,
    /// Runs beside the decoupler where it is asked how well each sample is known; the voltages of the last sample.
    uncertainty: Option<Box<(SampleUncertainty, Row)>>,
    /// Decodes in the decoupler's place where failures are to be seen.
    watching: Option<FaultWatch>,
    /// Stamps of the samples that have not been answered.
    times_s: VecDeque<f64>,
    /// Rows answered.
    pub rows: u64,
    /// Time of the first row, s.
    pub first_s: Option<f64>,
    /// What a picture of the six accelerations needs, if one is wanted.
    pub picture: Option<Box<[Envelope; 6]>>,
}

impl Decoding {
    /// Nothing answered yet.
    #[must_use]
    pub fn new(decoupler: Decoupler, columns: Columns, picture: bool) -> Self {
        Self {
            decoupler,
            columns,
            uncertainty: None,
            watching: None,
            times_s: VecDeque::new(),
            rows: 0,
            first_s: None,
            picture: picture.then(Box::default),
        }
    }

    /// Writes each sample's standard deviations, too, into [`DEVIATIONS`].
    #[must_use]
    pub fn with_uncertainty(mut self, uncertainty: SampleUncertainty) -> Self {
        self.uncertainty = Some(Box::new((uncertainty, [0.0; LIMBS])));
        self
    }

    /// Runs the fault monitor, too, and writes excluded and suspected limbs into [`FLAGS`].
    #[must_use]
    pub fn with_watching(mut self, watching: FaultWatch) -> Self {
        self.watching = Some(watching);
        self
    }

    /// Messages of the fault monitor since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        self.watching
            .as_mut()
            .map(|watching| std::mem::take(&mut watching.messages))
            .unwrap_or_default()
    }

    /// Queues the stamps of the next samples, which may be known before these are ready to be decoded.
    pub fn stamps(&mut self, times_s: &[f64]) {
        self.times_s.extend(times_s);
    }

    /// Decodes the next samples and replaces the contents of `block` with the rows they complete.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`]; the rows before the refused sample are in the block.
    pub fn decode(&mut self, rows: &[Row], block: &mut Block) -> sixaxis_core::Result<()> {
        let deviations = self.uncertainty.as_ref().map_or(0, |_| DEVIATIONS.len());
        let flags = self.watching.as_ref().map_or(0, |_| FLAGS.len());
        block.clear(1 + self.columns.count() + deviations + flags);
        let done = match (self.columns, &self.uncertainty, &self.watching) {
            (_, _, Some(_)) => self.watched(rows, block),
            (Columns::Accelerations, None, None) => self.accelerations(rows, block),
            _ => self.all(rows, block),
        };
        let answered = block.columns[1].len();
        if answered > 0 && self.rows == 0 {
            // The first sample is never answered.
            self.times_s.pop_front();
            self.first_s = self.times_s.front().copied();
        }
        let waiting = answered.min(self.times_s.len());
        block.columns[0].extend(self.times_s.drain(..waiting));
        self.rows += answered as u64;
        if let Some(picture) = &mut self.picture {
            let [times_s, columns @ ..] = block.columns.as_slice() else {
                return done;
            };
            for (envelope, column) in picture.iter_mut().zip(columns) {
                for (time_s, value) in times_s.iter().zip(column) {
                    envelope.push(*time_s, *value);
                }
            }
        }
        done
    }

    fn accelerations(&mut self, rows: &[Row], block: &mut Block) -> sixaxis_core::Result<()> {
        self.decoupler.push_record(rows, &mut |answers| {
            for (axis, column) in block.columns.iter_mut().skip(1).enumerate() {
                column.extend(answers.iter().map(|answer| answer[axis]));
            }
        })
    }

    fn watched(&mut self, rows: &[Row], block: &mut Block) -> sixaxis_core::Result<()> {
        let Some(watching) = &mut self.watching else {
            return Ok(());
        };
        for row in rows {
            if let Some((motion, flags)) = watching.push(row)? {
                let answer = numbers(&motion).into_iter().take(self.columns.count());
                for (column, value) in block.columns[1..].iter_mut().zip(answer.chain(flags)) {
                    column.push(value);
                }
            }
        }
        Ok(())
    }

    fn all(&mut self, rows: &[Row], block: &mut Block) -> sixaxis_core::Result<()> {
        for row in rows {
            if let Some(motion) = self.decoupler.push(row)? {
                let answer = numbers(&motion);
                let (answers, deviations) = block.columns[1..].split_at_mut(self.columns.count());
                if let Some(beside) = &mut self.uncertainty {
                    let (stream, before) = beside.as_mut();
                    let spread = stream.push(before, &motion)?;
                    for (column, value) in deviations.iter_mut().zip(spread.accelerations()) {
                        column.push(value);
                    }
                }
                for (column, value) in answers.iter_mut().zip(answer) {
                    column.push(value);
                }
            }
            if let Some(beside) = &mut self.uncertainty {
                beside.1 = *row;
            }
        }
        Ok(())
    }
}

/// The columns of [`Columns::All`].
fn numbers(motion: &SixAxis) -> [f64; MOTION_CHANNELS.len()] {
    let [ax, ay, az, bx, by, bz] = motion.accelerations();
    let (w, q) = (motion.rate_shell_rad_s, motion.attitude);
    [ax, ay, az, bx, by, bz, w.x, w.y, w.z, q.w, q.x, q.y, q.z]
}
