//! Decoupling that watches its nine channels and goes on without the one that fails.
//!
//! [`Monitor`] says which limb has failed, some samples after it did. By then rate and attitude, which are integrated, carry what
//! the limb made of them. So the last rows are kept, with the decoupler as it was before them: on a verdict it is taken from there
//! and decodes the rows since anew, without the limb. What was answered in between stays as it was; what comes after carries no
//! trace.
//!
//! How a decoupler does without limbs is [`Decoupler::set_excluded`].
//!
//! Of two twins neither can be done without as long as it is open which has failed, and both together never
//! ([`crate::redundancy::reconstruction`]): such answers go on from all nine and are marked.

use crate::decouple::Decoupler;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};
use crate::redundancy::fault::{Event, Kind, Monitor, Verdict, Watch};
use crate::six_axis::SixAxis;

/// Rows kept unless said otherwise: the longest window, and as much again.
pub const ROWS_KEPT: usize = 8192;

/// What has become of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watched {
    /// The sample before, decoupled.
    pub answer: Option<SixAxis>,
    /// What the monitor said.
    pub event: Option<Event>,
    /// The limbs that this answer does without.
    pub excluded: LimbSet,
    /// Limbs of which one is failed or both are, and which are not done without: this answer is not to be trusted.
    pub suspected: LimbSet,
    /// Set where the limbs that are done without have changed with this row.
    pub switched: Option<Switch>,
}

/// A change of the limbs that are done without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switch {
    /// The first row that was decoded anew.
    pub from_sample: u64,
    /// Whether that is before the failure, so that nothing of it is left in rate and attitude.
    pub reaches_onset: bool,
}

/// A decoupler that survives its limbs. It holds `N` rows in itself (72 bytes each) and no allocation; a row costs as much as the
/// decoupler and the monitor, and up to `N` times that once, when a limb is given up.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultTolerant<const N: usize = ROWS_KEPT> {
    decoupler: Decoupler,
    monitor: Monitor,
    /// As it was, the older first; half of the rows apart.
    before: [Decoupler; 2],
    rows: [[f64; LIMBS]; N],
    suspected: LimbSet,
}

impl<const N: usize> FaultTolerant<N> {
    /// Prepares decoupler and monitor.
    ///
    /// # Errors
    /// Those of [`Decoupler::new`] and [`Monitor::new`].
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        watch: &Watch,
    ) -> Result<Self> {
        const {
            assert!(
                N >= 2,
                "half of the rows lie between two states that are kept"
            )
        };
        let decoupler = Decoupler::new(sensor, parameters, settings)?;
        Ok(Self {
            monitor: Monitor::new(sensor, parameters, settings, watch)?,
            before: [decoupler.clone(), decoupler.clone()],
            decoupler,
            rows: [[0.0; LIMBS]; N],
            suspected: LimbSet::EMPTY,
        })
    }

    /// The monitor.
    #[must_use]
    pub const fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// The limbs that are done without.
    #[must_use]
    pub fn excluded(&self) -> LimbSet {
        self.decoupler.excluded()
    }

    /// Takes the next nine voltages.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`] for what cannot be decoded without the failed limbs either: values that are no numbers in
    /// more limbs than can be done without. The row is then not received.
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

    /// Takes limbs back, or gives them up, by the caller's own knowledge, from the next row on.
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
        if sample.is_multiple_of(N as u64 / 2) && sample > self.before[1].received() {
            self.before.swap(0, 1);
            self.before[1].clone_from(&self.decoupler);
        }
        if let Some(row) = self.rows.get_mut((sample % N as u64) as usize) {
            *row = *voltage_v;
        }
    }

    /// Limbs to do without from now on, and since when; none if nothing is to change.
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

    /// With those that are done without already; none takes all back.
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
        for at in from_sample..=sample {
            if let Some(row) = self.rows.get((at % N as u64) as usize) {
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
