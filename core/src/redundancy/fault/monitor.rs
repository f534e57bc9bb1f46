//! The fault monitor as a stream: nine voltages in, events out.
//!
//! Channels that stand still to the last bit while the others have their noise have failed, several at once if need be, whatever the
//! rows say ([`super::held`]); so have those that are not readable. An alarm of the [`Detector`] begins an isolation
//! ([`super::isolation`]), in which the limbs are named and then the kind of failure, or the answer is that it cannot be told.
//! Afterwards the relations that are left without the failed limbs are watched in the same way: two, one, or none. None is left
//! without three limbs of independent signatures; then only channels that stand still or are unreadable are noticed.

use super::detector::{Alarm, Detector};
use super::held::Held;
use super::isolation::{Isolation, Origin, Sample};
use super::recovery::Recovery;
use super::silent::Before;
use super::step::Ring;
use super::strains::Strains;
use super::untold::Untold;
use super::verdict::{Kind, Verdict};
use crate::decouple::uncertainty::ZeroWander;
use crate::error::Result;
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::kernel::constants::Constants;
use crate::kernel::placement::OVERSTRAIN;
use crate::limb_set::LimbSet;
use crate::model::{Model, Parameters, Sensor, Settings};
use crate::redundancy::parity::ROWS;
use crate::redundancy::residual;

pub use super::recovery::QUIET;
pub use super::settings::Watch;
pub use super::verdict::Event;

/// Standard deviations, of noise and of the error of the zero, within which a channel that stands still is at its zero.
const AT_ZERO: f64 = 8.0;

#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "without allocation there is no other place for it"
)]
enum State {
    Watching,
    Isolating(Isolation),
}

/// Monitors nine channels without allocation, at constant work per sample except for some samples after an alarm, and while limbs
/// are excluded.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    strains: Strains,
    zero_drift_v: [f64; LIMBS],
    /// One over a channel's noise, 1/V, and the error of its zero in its noise.
    per_noise: [f64; LIMBS],
    zero_sd: [f64; LIMBS],
    /// Standard deviation of each zero at the first sample, V.
    zero_drift_sd_v: [f64; LIMBS],
    nu: f64,
    /// Tests of all three relations, and of those that are left without failed limbs.
    whole: Detector,
    left: Option<Detector>,
    ring: Ring,
    held: Held,
    state: State,
    /// Limbs that have failed, and limbs of which one has.
    failed: LimbSet,
    open: LimbSet,
    /// A failure of which it cannot be told which limbs it is.
    untold: Option<Untold>,
    recovery: Recovery,
    received: u64,
}

impl Monitor {
    /// For a sensor whose channels' noise is known.
    ///
    /// # Errors
    /// Those of [`crate::Decoupler::new`], [`super::RowNoise::from_channels`] and [`Detector::new`].
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        watch: &Watch,
    ) -> Result<Self> {
        let constants = Constants::new(&Model::new(sensor, parameters, settings)?)?;
        let strains = Strains::new(
            &constants,
            &parameters.zero_drift_v,
            &settings.stiffness_ratio,
        );
        let errors = watch.errors(&strains.per_v)?;
        let noise = watch.row_noise(&strains.per_v)?;
        let per_sample = watch.false_alarms_per_hour / 3600.0 / settings.sample_rate_hz;
        Ok(Self {
            strains,
            zero_drift_v: parameters.zero_drift_v,
            per_noise: watch.noise_v.map(|sd| 1.0 / sd),
            zero_sd: core::array::from_fn(|i| watch.zero_drift_sd_v[i] / watch.noise_v[i]),
            zero_drift_sd_v: watch.zero_drift_sd_v,
            nu: constants.nu,
            whole: Detector::new(noise, per_sample, errors)?,
            left: None,
            ring: Ring::default(),
            held: Held::default(),
            state: State::Watching,
            failed: LimbSet::EMPTY,
            open: LimbSet::EMPTY,
            untold: None,
            recovery: Recovery::default(),
            received: 0,
        })
    }

    /// Allows for what zeros have wandered by at a sample of the recording; to be called from time to time.
    pub fn allow_for(&mut self, wander: &ZeroWander, sample: u64) {
        let now = wander.variances(sample);
        let sd_v: [f64; LIMBS] = core::array::from_fn(|limb| {
            let noise_v = 1.0 / self.per_noise[limb];
            sqrt(
                self.zero_drift_sd_v[limb] * self.zero_drift_sd_v[limb]
                    + noise_v * noise_v * now[limb],
            )
        });
        self.zero_sd = core::array::from_fn(|limb| sd_v[limb] * self.per_noise[limb]);
        let per_v = &self.strains.per_v;
        let drift = core::array::from_fn(|limb| (sd_v[limb] * per_v[limb]).abs());
        let strain2 = |of: [f64; LIMBS]| {
            core::array::from_fn(|i| {
                let noise = per_v[i] / self.per_noise[i];
                of[i] * noise * noise
            })
        };
        let steps = wander.steps().map(strain2);
        for detector in [&mut self.whole].into_iter().chain(&mut self.left) {
            detector.set_zero_errors(drift, steps);
        }
    }

    /// The tests of all three relations.
    #[must_use]
    pub const fn detector(&self) -> &Detector {
        &self.whole
    }

    /// Samples taken, unreadable ones among them.
    #[must_use]
    pub const fn received(&self) -> u64 {
        self.received
    }

    /// Limbs that are known to have failed.
    #[must_use]
    pub fn failed(&self) -> LimbSet {
        match &self.state {
            State::Isolating(isolation) => match isolation.found() {
                Some(limbs) if limbs.len() == 1 => self.failed.union(limbs),
                _ => self.failed,
            },
            State::Watching => self.failed,
        }
    }

    /// Limbs that may have failed, without being known to: from an alarm until it is explained or dismissed all that have not failed,
    /// and limbs that share a signature of which one has failed.
    #[inline]
    #[must_use]
    pub fn suspected(&self) -> LimbSet {
        match &self.state {
            State::Watching if self.untold.is_none() => self.open,
            State::Isolating(isolation) => match isolation.found() {
                Some(limbs) => self.open.union(limbs).minus(self.failed()),
                None => LimbSet::ALL.minus(self.failed),
            },
            State::Watching => LimbSet::ALL.minus(self.failed),
        }
    }

    /// Strains of nine voltages.
    #[must_use]
    pub fn strains(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        self.strains.of(voltage_v)
    }

    /// The parity rows of nine voltages, whitened.
    #[must_use]
    pub fn whitened(&self, voltage_v: &[f64; LIMBS]) -> [f64; 3] {
        let rows = residual(&self.strains(voltage_v), self.nu);
        self.whole.noise().whiten(&rows)
    }

    /// A channel's signal, counted from no force, in its noise.
    fn signal(&self, limb: usize, voltage_v: f64) -> f64 {
        (voltage_v - self.zero_drift_v[limb]) * self.per_noise[limb]
    }

    /// Takes the next nine voltages. A limb whose voltage is NaN, infinite or beyond any strain has failed at once; the rows of such
    /// a sample are not used.
    #[inline]
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Option<Event> {
        self.received += 1;
        self.held.push(voltage_v, self.ring.last());
        self.ring.push(voltage_v);
        let strain = self.strains(voltage_v);
        let borne = strain.iter().all(|x| x.abs() < OVERSTRAIN);
        let calm = matches!(self.state, State::Watching) && self.untold.is_none();
        if !borne || !calm || !self.gone().is_empty() || self.held.is_running() {
            return self.attend(voltage_v, strain, true);
        }
        let z = self.whole.noise().whiten(&residual(&strain, self.nu));
        let from_rest = self.strains.counted_from_rest(&strain);
        let alarm = self.whole.first_alarm(&z, &from_rest)?;
        self.begin(alarm, (&z, &from_rest))
    }

    /// Takes nine voltages of which the rows say nothing, as of a sensor driven beyond its range: channels that are not readable have failed
    /// as with [`Self::push`], and nothing else is tested, since at the end of its range any channel stands still.
    #[cold]
    pub fn pass_over(&mut self, voltage_v: &[f64; LIMBS]) -> Option<Event> {
        self.received += 1;
        self.ring.push(voltage_v);
        self.attend(voltage_v, self.strains(voltage_v), false)
    }

    /// Limbs that the relations that are watched do not contain.
    const fn gone(&self) -> LimbSet {
        self.failed.union(self.open)
    }

    /// What [`Self::push`] does where there is more to do than to test the rows.
    #[inline(never)]
    fn attend(
        &mut self,
        voltage_v: &[f64; LIMBS],
        mut strain: [f64; LIMBS],
        tested: bool,
    ) -> Option<Event> {
        let sample = self.received.saturating_sub(1);
        let unreadable = (0..LIMBS)
            .filter(|&limb| strain[limb].is_nan() || strain[limb].abs() >= OVERSTRAIN)
            .fold(LimbSet::EMPTY, LimbSet::with);
        let silent = unreadable.minus(self.failed);
        if !silent.is_empty() {
            return Some(self.fail(silent, Kind::Unreadable, (sample, sample)));
        }
        let held = self.held.held();
        let silent = held.minus(self.failed);
        let signal = |limb: usize, v: f64| self.signal(limb, v);
        if self.held.witnessed(silent, self.failed, &self.ring, signal) {
            return Some(self.fail_held(silent, voltage_v));
        }
        for limb in self.failed.indices() {
            // To second order only, which is far below the noise, do the relations that are left contain it.
            strain[limb] = self.strains.at_rest[limb];
        }
        if !self.gone().is_empty() && self.is_over(voltage_v, unreadable.union(held)) {
            self.failed = LimbSet::EMPTY;
            self.open = LimbSet::EMPTY;
            self.untold = None;
            self.watch();
            return Some(Event::Quiet);
        }
        tested.then(|| self.test(&strain, voltage_v))?
    }

    #[cold]
    fn fail_held(&mut self, limbs: LimbSet, voltage_v: &[f64; LIMBS]) -> Event {
        let since = self.held.since(limbs, self.received.saturating_sub(1));
        let stuck = |limb: &usize| {
            let signal = self.signal(*limb, voltage_v[*limb]).abs();
            voltage_v[*limb] != 0.0 && signal >= AT_ZERO * (1.0 + self.zero_sd[*limb])
        };
        let kind = limbs.indices().find(stuck).map(|_| Kind::Stuck);
        self.fail(limbs, kind.unwrap_or(Kind::Dead), since)
    }

    /// Limbs have failed by what their channels show, whatever the rows say.
    #[cold]
    fn fail(&mut self, limbs: LimbSet, kind: Kind, since: (u64, u64)) -> Event {
        self.add_failed(limbs);
        self.untold = None;
        self.watch();
        Event::Identified(Verdict {
            limbs,
            kind,
            since,
            said_at: self.received.saturating_sub(1),
            class_ln_odds: f64::INFINITY,
            kind_ln_odds: f64::INFINITY,
            partner_ln_odds: f64::INFINITY,
        })
    }

    fn add_failed(&mut self, limbs: LimbSet) {
        self.failed = self.failed.union(limbs);
        // A limb of which it was not known whether it or another had failed explains that.
        if limbs.minus(self.open) != limbs {
            self.open = LimbSet::EMPTY;
        }
    }

    /// Watches the relations that are left from here on.
    fn watch(&mut self) {
        self.state = State::Watching;
        self.recovery = Recovery::default();
        self.whole.restart();
        let gone = self.gone();
        self.left = if gone.is_empty() {
            None
        } else {
            self.whole.without(gone).ok()
        };
    }

    /// Whether all nine have been quiet for long, and those that had failed move again.
    fn is_over(&mut self, voltage_v: &[f64; LIMBS], silent: LimbSet) -> bool {
        let strain = self.strains(voltage_v);
        let sound = silent.is_empty() && {
            let z = self.whole.noise().whiten(&residual(&strain, self.nu));
            let from_rest = self.strains.counted_from_rest(&strain);
            self.whole.first_alarm(&z, &from_rest).is_none()
        };
        let moved = |limb: usize, from_v: f64| (voltage_v[limb] - from_v) * self.per_noise[limb];
        self.recovery.push(sound, voltage_v, self.failed, moved)
    }

    /// Begins an isolation. A failure of which it could not be told which limbs it is goes on: that is no new alarm.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, mut alarm: Alarm, sample: (&[f64; ROWS], &[f64; LIMBS])) -> Option<Event> {
        alarm.sample = self.received.saturating_sub(1);
        let since = (alarm.sample + 1).saturating_sub(alarm.test.samples());
        self.untold.iter_mut().for_each(Untold::alarmed);
        let goes_on = self.untold.and_then(Untold::goes_on);
        let origin = goes_on.unwrap_or_else(|| Origin {
            since: (since, alarm.sample),
            before: Before::new(&self.ring, since, |limb, v| self.signal(limb, v)),
        });
        let gone = self.gone();
        let detector = if gone.is_empty() {
            &self.whole
        } else {
            self.left.as_ref()?
        };
        let common = self.strains.of_a_common_voltage(gone);
        let common = detector.noise().whiten(&common);
        self.state = State::Isolating(Isolation::new(
            alarm,
            origin,
            detector,
            sample,
            self.zero_sd,
            &common,
        ));
        goes_on.is_none().then_some(Event::Alarm(alarm))
    }

    /// The relations that are watched, tested or looked into.
    fn test(&mut self, strain: &[f64; LIMBS], voltage_v: &[f64; LIMBS]) -> Option<Event> {
        let gone = self.gone();
        let from_rest = self.strains.counted_from_rest(strain);
        let detector = if gone.is_empty() {
            &mut self.whole
        } else {
            self.left.as_mut()?
        };
        let z = detector.noise().whiten(&residual(strain, self.nu));
        let State::Isolating(isolation) = &mut self.state else {
            return match detector.first_alarm(&z, &from_rest) {
                Some(alarm) => self.begin(alarm, (&z, &from_rest)),
                None => self.is_untold_over(),
            };
        };
        let signal =
            core::array::from_fn(|i| (voltage_v[i] - self.zero_drift_v[i]) * self.per_noise[i]);
        let sample = Sample {
            z: &z,
            signal: &signal,
            strain,
            from_rest: &from_rest,
        };
        let strains = &self.strains;
        isolation.push(detector.noise(), &sample, |limb, channel| {
            strains.of_limb(limb, voltage_v[channel])
        });
        isolation.look_for_steps(&self.ring, &self.per_noise);
        // What may be a channel that stands still is waited for.
        if !self.held.pausing().minus(gone).is_empty() {
            return None;
        }
        let said_at = self.received.saturating_sub(1);
        let event = isolation.event(detector.noise(), detector.errors(), said_at, gone)?;
        let origin = isolation.origin();
        self.settle(event, origin)
    }

    /// Draws the consequences of an event.
    #[cold]
    fn settle(&mut self, event: Event, origin: Origin) -> Option<Event> {
        let is_new = self.untold.and_then(Untold::goes_on).is_none();
        let told = match &event {
            Event::Dismissed => is_new,
            Event::Identified(verdict) if verdict.limbs.is_empty() => {
                self.untold = Some(Untold::new(self.untold, verdict.kind, origin));
                is_new
            }
            Event::Identified(verdict) => {
                self.untold = None;
                if verdict.kind == Kind::Passed {
                } else if verdict.is_open() {
                    self.open = self.open.union(verdict.limbs);
                } else {
                    self.add_failed(verdict.limbs);
                }
                true
            }
            _ => return Some(event),
        };
        self.watch();
        told.then_some(event)
    }

    /// A failure of which it could not be told which limbs it is may pass.
    fn is_untold_over(&mut self) -> Option<Event> {
        let is_over = self.untold.as_mut().is_some_and(Untold::is_over);
        self.untold = self.untold.filter(|_| !is_over);
        is_over.then_some(Event::Quiet)
    }
}
