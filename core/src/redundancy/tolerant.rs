//! Decoupling with a fault monitor: a limb that fails is excluded, and the samples since its failure are decoded again.
//!
//! [`Monitor`] isolates a failed limb some samples after its failure. By then rate and attitude, which are integrated, carry the
//! limb's error. Therefore the last rows are kept, with the decoupler's states before them: once a limb is isolated, decoding is
//! repeated from a state before the failure, with the limb excluded ([`Decoupler::set_excluded`]). Answers given in between are not
//! revised; later ones are free of the failure.
//!
//! Several limbs may fail, at once or one after another; up to three can be excluded. Answers are marked from the alarm until the limbs
//! are known, and for as long as it cannot be told which limbs have failed: of an ambiguous pair neither limb is excluded until it is
//! known which of the two it is, nor are limbs excluded that cannot be done without together
//! ([`crate::redundancy::reconstruction`]). Such answers are decoded from the limbs that are not excluded, failed ones among them.

use crate::decouple::Decoupler;
use crate::decouple::uncertainty::ZeroWander;
use crate::error::{Result, require_samples};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::{CrossTalk, Parameters, Sensor, Settings};
use crate::redundancy::fault::{Event, Kind, Monitor, Watch};
use crate::six_axis::SixAxis;

/// Rows to keep where nothing else is known: the longest window of the monitor, and as much again.
pub const ROWS_KEPT: usize = 8192;

/// The answer to one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watched {
    /// The sample before, decoupled.
    pub answer: Option<SixAxis>,
    /// The monitor's event.
    pub event: Option<Event>,
    /// Limbs excluded from this answer.
    pub excluded: LimbSet,
    /// Limbs that may have failed and are not excluded. Treat `answer` as invalid unless it is empty.
    pub suspected: LimbSet,
    /// Set where the excluded limbs changed with this row.
    pub switched: Option<Switch>,
}

/// A change of the excluded limbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switch {
    /// The first row that was decoded again.
    pub from_sample: u64,
    /// Whether that is before the failure, so that rate and attitude are free of it.
    pub reaches_onset: bool,
}

/// Decoupler that excludes a limb when it fails. `B` is the room in which it keeps the last rows (72 bytes each): an array, a slice
/// that is borrowed or a vector. It allocates nothing itself. A row costs as much as the decoupler and the monitor, and up to as many
/// times that as there are rows once, when a limb is excluded.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultTolerant<B> {
    decoupler: Decoupler,
    monitor: Monitor,
    /// What a failed channel shows must not reach the others: cross-talk is undone here, beside the excluded limbs.
    cross_talk: Option<CrossTalk>,
    /// Earlier states, the older first, half of the rows apart.
    before: [Decoupler; 2],
    rows: B,
    /// Limbs that the caller excludes, and failed ones that cannot be excluded beside the others.
    given: LimbSet,
    refused: LimbSet,
}

impl<B: AsRef<[[f64; LIMBS]]> + AsMut<[[f64; LIMBS]]>> FaultTolerant<B> {
    /// Prepares decoupler and monitor. The last rows received are kept in `rows`, whatever is in it: [`ROWS_KEPT`] are good.
    ///
    /// # Errors
    /// Those of [`Decoupler::new`] and [`Monitor::new`]; [`crate::Error::TooFewSamples`] for room for less than two rows.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        watch: &Watch,
        rows: B,
    ) -> Result<Self> {
        // Half of the rows lie between two states that are kept.
        require_samples("room for rows", 2, rows.as_ref().len())?;
        let decoupler = Decoupler::new(sensor, parameters, settings)?;
        Ok(Self {
            monitor: Monitor::new(sensor, parameters, settings, watch)?,
            before: [decoupler.clone(), decoupler.clone()],
            decoupler,
            cross_talk: None,
            rows,
            given: LimbSet::EMPTY,
            refused: LimbSet::EMPTY,
        })
    }

    /// Undoes cross-talk before a row is decoded. The monitor sees the rows as they are, but for what limbs with mass show of the square of
    /// the rate.
    #[must_use]
    pub fn with_cross_talk(mut self, cross_talk: Option<CrossTalk>) -> Self {
        self.cross_talk = cross_talk;
        self
    }

    /// Allows for what zeros have wandered by at a sample of the recording; to be called from time to time.
    pub fn allow_for(&mut self, wander: &ZeroWander, sample: u64) {
        self.monitor.allow_for(wander, sample);
    }

    /// The monitor.
    #[must_use]
    pub const fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// The excluded limbs.
    #[must_use]
    pub fn excluded(&self) -> LimbSet {
        self.decoupler.excluded()
    }

    /// Takes the next nine voltages.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`] for a row that cannot be decoded with the failed limbs excluded either: NaN in more limbs than can
    /// be excluded. The row is then not received.
    #[inline]
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Watched> {
        self.push_filtered(voltage_v, voltage_v)
    }

    /// The same where a filter that runs forwards only has made another row for the decoupler: the monitor, which holds single rows to the
    /// channels' white noise, sees `voltage_v`, and `filtered_v` is decoded. A failure is in no filtered row before it, so that decoding is
    /// repeated from the same row.
    ///
    /// # Errors
    /// Those of [`Self::push`].
    pub fn push_filtered(
        &mut self,
        voltage_v: &[f64; LIMBS],
        filtered_v: &[f64; LIMBS],
    ) -> Result<Watched> {
        let without_limb_mass;
        let seen_v = if self.decoupler.has_limb_mass() {
            without_limb_mass = self.decoupler.as_without_limb_mass(voltage_v);
            &without_limb_mass
        } else {
            voltage_v
        };
        let event = self.monitor.push(seen_v);
        self.answer(event, filtered_v)
    }

    /// The same of a row that does not say whether limbs have failed, see [`Monitor::pass_over`].
    ///
    /// # Errors
    /// Those of [`Self::push`].
    pub fn pass_over(
        &mut self,
        voltage_v: &[f64; LIMBS],
        filtered_v: &[f64; LIMBS],
    ) -> Result<Watched> {
        let event = (self.monitor).pass_over(&self.decoupler.as_without_limb_mass(voltage_v));
        self.answer(event, filtered_v)
    }

    #[inline]
    fn answer(&mut self, event: Option<Event>, filtered_v: &[f64; LIMBS]) -> Result<Watched> {
        let sample = self.decoupler.received();
        self.keep(sample, filtered_v);
        let mut switched = None;
        let answer = match event.and_then(|event| self.wanted(&event, sample)) {
            Some((limbs, since)) => match self.switch(limbs, since, sample) {
                Ok((answer, switch)) => {
                    self.refused = LimbSet::EMPTY;
                    switched = Some(switch);
                    answer
                }
                Err(_) => {
                    self.refused = limbs.minus(self.excluded());
                    self.decode(filtered_v)?
                }
            },
            None => self.decode(filtered_v)?,
        };
        let excluded = self.excluded();
        Ok(Watched {
            answer,
            event,
            excluded,
            suspected: self.monitor.suspected().union(self.refused).minus(excluded),
            switched,
        })
    }

    /// Sets the excluded limbs by the caller's own knowledge, from the next row on.
    ///
    /// # Errors
    /// Those of [`Decoupler::set_excluded`].
    pub fn set_excluded(&mut self, limbs: LimbSet) -> Result<()> {
        self.decoupler.set_excluded(limbs)?;
        self.given = limbs;
        self.before = [self.decoupler.clone(), self.decoupler.clone()];
        Ok(())
    }

    fn decode(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<SixAxis>> {
        match &self.cross_talk {
            None => self.decoupler.push(voltage_v),
            Some(cross_talk) => {
                let excluded = self.decoupler.excluded();
                let row = cross_talk.undo_without(voltage_v, excluded);
                self.decoupler.push(&row)
            }
        }
    }

    fn keep(&mut self, sample: u64, voltage_v: &[f64; LIMBS]) {
        let rows = self.rows.as_mut();
        let kept = rows.len() as u64;
        if sample.is_multiple_of(kept / 2) && sample > self.before[1].received() {
            self.before.swap(0, 1);
            self.before[1].clone_from(&self.decoupler);
        }
        if let Some(row) = rows.get_mut((sample % kept) as usize) {
            *row = *voltage_v;
        }
    }

    /// Limbs to exclude from now on, and since when; none if nothing changes.
    #[cold]
    fn wanted(&self, event: &Event, sample: u64) -> Option<(LimbSet, Option<u64>)> {
        let limbs = self.given.union(self.monitor.failed());
        // Rows that were refused have a number with the monitor and none with the decoupler.
        let refused = self.monitor.received().saturating_sub(sample + 1);
        let since = match event {
            Event::Isolated(verdict) | Event::Identified(verdict)
                if verdict.kind != Kind::Passed =>
            {
                Some(verdict.since.0.saturating_sub(refused))
            }
            _ => None,
        };
        (limbs != self.excluded()).then_some((limbs, since))
    }

    /// Decodes again from before `since`, or from here on, with the row of `sample` as the last.
    #[cold]
    #[inline(never)]
    fn switch(
        &mut self,
        limbs: LimbSet,
        since: Option<u64>,
        sample: u64,
    ) -> Result<(Option<SixAxis>, Switch)> {
        let mut decoupler = match since {
            None => self.decoupler.clone(),
            Some(since) => {
                let [older, newer] = &self.before;
                let start = if newer.received() <= since {
                    newer
                } else {
                    older
                };
                start.clone()
            }
        };
        let from_sample = decoupler.received();
        decoupler.set_excluded(limbs)?;
        let start = decoupler.clone();
        let mut answer = None;
        let rows = self.rows.as_ref();
        for at in from_sample..=sample {
            if let Some(row) = rows.get((at % rows.len() as u64) as usize) {
                answer = match &self.cross_talk {
                    None => decoupler.push(row)?,
                    Some(cross_talk) => decoupler.push(&cross_talk.undo_without(row, limbs))?,
                };
            }
        }
        self.before = [start.clone(), start];
        self.decoupler = decoupler;
        Ok((
            answer,
            Switch {
                from_sample,
                reaches_onset: since.is_none_or(|since| from_sample <= since),
            },
        ))
    }
}
