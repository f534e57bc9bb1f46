//! Voltages to rows of the answer.

use sixaxis_core::decouple::uncertainty::SampleUncertainty;
use sixaxis_core::six_axis::SixAxisColumns;
use sixaxis_core::{Decoupler, LIMBS};
use sixaxis_recordings::envelope::Envelope;
use sixaxis_recordings::motion::MOTION_CHANNELS;
use sixaxis_recordings::{Block, Channel, Layout};

use super::Row;
use super::coordination::Coordination;
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
    /// Looks at the voltages before they are decoded.
    coordination: Option<Coordination>,
    /// Stamps of the samples that have not been answered.
    times_s: Vec<f64>,
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
            coordination: None,
            times_s: Vec::new(),
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

    /// Checks the coordination equations on the way.
    #[must_use]
    pub fn with_coordination(mut self, coordination: Coordination) -> Self {
        self.coordination = Some(coordination);
        self
    }

    /// What the coordination equations say, if they are checked.
    pub fn coordination(&mut self) -> Option<&mut Coordination> {
        self.coordination.as_mut()
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

    /// Decodes the next samples, nine columns of voltages, and replaces the contents of `block` with the rows they complete.
    ///
    /// # Errors
    /// Those of [`Decoupler::push_columns`]; the rows before the refused sample are in the block.
    pub fn decode(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let deviations = self.uncertainty.as_ref().map_or(0, |_| DEVIATIONS.len());
        let flags = self.watching.as_ref().map_or(0, |_| FLAGS.len());
        block.clear(1 + self.columns.count() + deviations + flags);
        if let Some(coordination) = &mut self.coordination {
            coordination.look(voltage_v);
        }
        let done = if self.watching.is_some() {
            self.watched(voltage_v, block)
        } else {
            self.answers(voltage_v, block)
        };
        let answered = block.columns[1].len();
        if answered > 0 && self.rows == 0 {
            // The first sample is never answered.
            let unanswered = self.times_s.len().min(1);
            self.times_s.drain(..unanswered);
            self.first_s = self.times_s.first().copied();
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

    fn answers(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let first = self.decoupler.received();
        let (answers, deviations) = block.columns[1..].split_at_mut(self.columns.count());
        let mut beside = self.uncertainty.as_deref_mut();
        let mut refused = Ok(());
        let done = self.decoupler.push_columns(voltage_v, &mut |done| {
            if let Some((stream, before)) = &mut beside
                && refused.is_ok()
            {
                refused = spread(stream, done, deviations, |sample| {
                    match sample.checked_sub(first) {
                        Some(here) => voltage_v.map(|column| column[here as usize]),
                        None => *before,
                    }
                });
            }
            if refused.is_ok() {
                for (column, numbers) in answers.iter_mut().zip(done.columns()) {
                    column.extend_from_slice(numbers);
                }
            }
        });
        if let (Some((_, before)), Some(last)) = (beside, voltage_v[0].len().checked_sub(1)) {
            *before = voltage_v.map(|column| column[last]);
        }
        refused.and(done)
    }

    fn watched(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let Some(watching) = &mut self.watching else {
            return Ok(());
        };
        for sample in 0..voltage_v[0].len() {
            let row = voltage_v.map(|column| column[sample]);
            if let Some((motion, flags)) = watching.push(&row)? {
                let answer = motion.numbers().into_iter().take(self.columns.count());
                for (column, value) in block.columns[1..].iter_mut().zip(answer.chain(flags)) {
                    column.push(value);
                }
            }
        }
        Ok(())
    }
}

/// Appends standard deviations of answers to their columns; `row` gives the voltages of a sample.
fn spread(
    stream: &mut SampleUncertainty,
    answers: SixAxisColumns,
    deviations: &mut [Vec<f64>],
    row: impl Fn(u64) -> Row,
) -> sixaxis_core::Result<()> {
    for motion in answers.iter() {
        let spread = stream.push(&row(motion.sample), &motion)?;
        for (column, value) in deviations.iter_mut().zip(spread.accelerations()) {
            column.push(value);
        }
    }
    Ok(())
}
