//! Decoupling that monitors its nine channels and excludes a limb that fails ([`Decoupler::set_excluded`]).
//!
//! [`Monitor`] isolates the failed limb some samples after the failure. By then rate and attitude, which are integrated, carry the
//! error of that limb. So the last rows are kept, with the decoupler as it was before them: on a verdict this older decoupler
//! excludes the limb and decodes the rows since anew. Answers given in between are not corrected; later ones carry no trace of the
//! failure.
//!
//! Neither limb of an ambiguous pair can be excluded as long as it is unknown which has failed, and both together never
//! ([`crate::redundancy::reconstruction`]): the decoupler then goes on with all nine and marks its answers as suspected.

use crate::decouple::Decoupler;
use crate::error::{Error, Result};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};
use crate::redundancy::fault::{Event, Kind, Monitor, Verdict, Watch};
use crate::six_axis::SixAxis;

/// Rows to keep where nothing else is known: the longest window of the monitor, and as much again.
pub const ROWS_KEPT: usize = 8192;

/// What has become of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watched {
    /// The sample before, decoupled.
    pub answer: Option<SixAxis>,
    /// What the monitor said.
    pub event: Option<Event>,
    /// The limbs that are excluded from this answer.
    pub excluded: LimbSet,
    /// Ambiguous pair: at least one has failed, which is unknown, so neither is excluded. Treat `answer` as invalid.
    pub suspected: LimbSet,
    /// Set where the excluded limbs have changed with this row.
    pub switched: Option<Switch>,
}

/// A change of the excluded limbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switch {
    /// The first row that was decoded anew.
    pub from_sample: u64,
    /// Whether that is before the failure, so that nothing of it is left in rate and attitude.
    pub reaches_onset: bool,
}

/// Decoupler that excludes a limb when it fails. `B` is the room in which it keeps the last rows (72 bytes each): an array, a slice
/// that is borrowed or a vector. It allocates nothing itself. A row costs as much as the decoupler and the monitor, and up to as many
/// times that as there are rows once, when a limb is excluded.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultTolerant<B> {
    decoupler: Decoupler,
    monitor: Monitor,
    /// As it was, the older first; half of the rows apart.
    before: [Decoupler; 2],
    rows: B,
    suspected: LimbSet,
}

impl<B: AsRef<[[f64; LIMBS]]> + AsMut<[[f64; LIMBS]]>> FaultTolerant<B> {
    /// Prepares decoupler and monitor. The last rows received are kept in `rows`, whatever is in it: [`ROWS_KEPT`] are good.
    ///
    /// # Errors
    /// Those of [`Decoupler::new`] and [`Monitor::new`]; [`Error::TooFewSamples`] for room for less than two rows.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        watch: &Watch,
        rows: B,
    ) -> Result<Self> {
        // Half of the rows lie between two states that are kept.
        let got = rows.as_ref().len();
        if got < 2 {
            return Err(Error::TooFewSamples {
                what: "room for rows",
                needed: 2,
                got,
            });
        }
        let decoupler = Decoupler::new(sensor, parameters, settings)?;
        Ok(Self {
            monitor: Monitor::new(sensor, parameters, settings, watch)?,
            before: [decoupler.clone(), decoupler.clone()],
            decoupler,
            rows,
            suspected: LimbSet::EMPTY,
        })
    }

    /// The monitor.
    #[must_use]
    pub const fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// The limbs that are excluded.
    #[must_use]
    pub fn excluded(&self) -> LimbSet {
        self.decoupler.excluded()
    }

    /// Takes the next nine voltages.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`] for what cannot be decoded with the failed limbs excluded either: NaN in more limbs than
    /// can be excluded. The row is then not received.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Watched> {
        let sample = self.decoupler.received();
        self.keep(sample, voltage_v);
        let event = self.monitor.push(voltage_v);
        // Rows that were refused have a number with the monitor and none with the decoupler.
        let refused = self.monitor.received().saturating_sub(sample + 1);
        let mut switched = None;
        let answer = match event.and_then(|event| self.wanted(event)) {
            Some((limbs, since)) => match self.switch(
                self.joined(limbs),
                since.map(|since| since.saturating_sub(refused)),
                sample,
            ) {
                Ok((answer, switch)) => {
                    self.suspected = LimbSet::EMPTY;
                    switched = Some(switch);
                    answer
                }
                Err(_) => {
                    self.suspected = limbs;
                    self.decoupler.push(voltage_v)?
                }
            },
            None => self.decoupler.push(voltage_v)?,
        };
        Ok(Watched {
            answer,
            event,
            excluded: self.excluded(),
            suspected: self.suspected,
            switched,
        })
    }

    /// Excludes or readmits limbs by the caller's own knowledge, from the next row on.
    ///
    /// # Errors
    /// Those of [`Decoupler::set_excluded`].
    pub fn set_excluded(&mut self, limbs: LimbSet) -> Result<()> {
        self.decoupler.set_excluded(limbs)?;
        self.suspected = LimbSet::EMPTY;
        self.before = [self.decoupler.clone(), self.decoupler.clone()];
        Ok(())
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

    /// Limbs to exclude from now on, and since when; none if nothing is to change.
    fn wanted(&mut self, event: Event) -> Option<(LimbSet, Option<u64>)> {
        let of = |verdict: &Verdict| (verdict.limbs, Some(verdict.since.0));
        match event {
            Event::Isolated(verdict) if verdict.limb().is_some() => Some(of(&verdict)),
            Event::Isolated(verdict) => {
                self.suspected = verdict.limbs;
                None
            }
            Event::Identified(verdict) => match verdict.kind {
                Kind::Passed => {
                    self.suspected = LimbSet::EMPTY;
                    (!self.excluded().is_empty()).then_some((LimbSet::EMPTY, None))
                }
                _ if verdict.limbs == self.excluded() => None,
                _ if verdict.is_open() || verdict.limbs.is_empty() => {
                    self.suspected = verdict.limbs;
                    None
                }
                _ => Some(of(&verdict)),
            },
            Event::Quiet => {
                self.suspected = LimbSet::EMPTY;
                (!self.excluded().is_empty()).then_some((LimbSet::EMPTY, None))
            }
            Event::Alarm(_) | Event::Dismissed => None,
        }
    }

    /// With those that are excluded already; the empty set readmits all.
    fn joined(&self, limbs: LimbSet) -> LimbSet {
        if limbs.is_empty() {
            limbs
        } else {
            self.excluded().indices().fold(limbs, LimbSet::with)
        }
    }

    /// Decodes anew from before `since`, or from here on, with the row of `sample` as the last.
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
                answer = decoupler.push(row)?;
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
