//! The fault monitor as a stream: nine voltages in, events out.
//!
//! An alarm of the [`Detector`] begins an isolation. With each sample, every class of limbs and every pair of channels that may
//! be exchanged is scored by the rows since the alarm, together with those of the window that raised it, until one leads by
//! [`super::isolation::CLASS`]. Then, each time the number of samples has doubled, the kind of failure is estimated, until it is
//! certain or no more samples are waited for. If no class leads, the alarm is dismissed when the rows have become quiet again, and
//! reported as beyond a single limb when they have not.

use super::detector::{Alarm, CalibrationErrors, Detector};
use super::isolation::Isolation;
use super::noise::RowNoise;
use super::step::Ring;
use super::verdict::{Kind, Verdict};
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::constants::Constants;
use crate::kernel::order::from_kernel_order;
use crate::kernel::placement::OVERSTRAIN;
use crate::limb_set::LimbSet;
use crate::model::{Model, Parameters, Sensor, Settings};
use crate::redundancy::residual;

/// Samples without any alarm after which a failure is over: two of the longest windows.
pub const QUIET: u64 = 8192;

/// An event of the monitored sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A test failed; its isolation follows.
    Alarm(Alarm),
    /// The class of limbs is known, how it failed is not.
    Isolated(Verdict),
    /// The isolation is complete.
    Identified(Verdict),
    /// The rows became quiet again before any class led: to all appearances a false alarm.
    Dismissed,
    /// All nine have been quiet for [`QUIET`] samples after a failure.
    Quiet,
}

/// Settings of a monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// Expected number of alarms of a healthy sensor.
    pub false_alarms_per_hour: f64,
    /// Standard deviation of the noise of each channel, V.
    pub noise_v: [f64; LIMBS],
    /// Standard deviation of each scale factor after calibration, relative; zeros to take it for exact.
    pub scale_sd: [f64; LIMBS],
    /// The same of each zero drift, V.
    pub zero_drift_sd_v: [f64; LIMBS],
}

#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "without allocation there is no other place for it"
)]
enum State {
    Watching,
    Isolating(Isolation),
    Known { limbs: LimbSet, quiet: u64 },
}

/// Monitors nine channels without allocation, at constant work per sample except for a few samples after an alarm.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    strain_per_v: [f64; LIMBS],
    strain_at_zero: [f64; LIMBS],
    zero_drift_v: [f64; LIMBS],
    nu: f64,
    detector: Detector,
    ring: Ring,
    state: State,
    received: u64,
}

impl Monitor {
    /// For a sensor whose channels' noise is known.
    ///
    /// # Errors
    /// Those of [`crate::Decoupler::new`], [`RowNoise::from_channels`] and [`Detector::new`].
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        watch: &Watch,
    ) -> Result<Self> {
        let constants = Constants::new(&Model::new(sensor, parameters, settings)?)?;
        let strain_per_v = from_kernel_order(constants.strain_per_v);
        let noise = RowNoise::from_channels(&core::array::from_fn(|limb| {
            (strain_per_v[limb] * watch.noise_v[limb]).abs()
        }))?;
        let errors = CalibrationErrors {
            scale: watch.scale_sd,
            drift: core::array::from_fn(|limb| {
                (strain_per_v[limb] * watch.zero_drift_sd_v[limb]).abs()
            }),
        };
        let exact = errors
            .scale
            .iter()
            .chain(&errors.drift)
            .all(|&sd| sd == 0.0);
        let per_sample = watch.false_alarms_per_hour / 3600.0 / settings.sample_rate_hz;
        Ok(Self {
            strain_per_v,
            strain_at_zero: from_kernel_order(constants.strain_at_zero),
            zero_drift_v: parameters.zero_drift_v,
            nu: constants.nu,
            detector: Detector::new(noise, per_sample, (!exact).then_some(errors))?,
            ring: Ring::default(),
            state: State::Watching,
            received: 0,
        })
    }

    /// The tests.
    #[must_use]
    pub const fn detector(&self) -> &Detector {
        &self.detector
    }

    /// Samples taken, unreadable ones among them.
    #[must_use]
    pub const fn received(&self) -> u64 {
        self.received
    }

    /// Strains of nine voltages.
    #[must_use]
    pub fn strains(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| self.strain(i, voltage_v[i]))
    }

    /// The parity rows of nine voltages, whitened.
    #[must_use]
    pub fn whitened(&self, voltage_v: &[f64; LIMBS]) -> [f64; 3] {
        let rows = residual(&self.strains(voltage_v), self.nu);
        self.detector.noise().whiten(&rows)
    }

    fn strain(&self, limb: usize, voltage_v: f64) -> f64 {
        self.strain_per_v[limb] * voltage_v + self.strain_at_zero[limb]
    }

    /// Takes the next nine voltages. A limb whose voltage is NaN, infinite or beyond any strain has failed at once; the rows of such
    /// a sample are not used.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Option<Event> {
        let sample = self.received;
        self.received += 1;
        let strain = self.strains(voltage_v);
        let unreadable = (0..LIMBS)
            .filter(|&limb| {
                let borne = strain[limb].abs() < OVERSTRAIN;
                !borne
            })
            .fold(LimbSet::EMPTY, LimbSet::with);
        if !unreadable.is_empty() {
            return self.unreadable(unreadable, sample);
        }
        let noise = *self.detector.noise();
        let z = noise.whiten(&residual(&strain, self.nu));
        let signal = core::array::from_fn(|i| {
            self.strain_per_v[i] * (voltage_v[i] - self.zero_drift_v[i]) / noise.channel_sd()[i]
        });
        self.ring.push(&signal);
        match &mut self.state {
            State::Watching => {
                let mut alarm = self.detector.push(&z, &strain).first()?;
                alarm.sample = sample;
                let window = self.detector.rows_of(alarm.test);
                self.state = State::Isolating(Isolation::new(alarm, &noise, &window, &z));
                Some(Event::Alarm(alarm))
            }
            State::Isolating(isolation) => {
                let (slope, zero) = (&self.strain_per_v, &self.strain_at_zero);
                isolation.push(&noise, &z, &signal, &strain, |limb, channel| {
                    slope[limb] * voltage_v[channel] + zero[limb]
                });
                isolation.look_for_steps(&self.ring);
                let event = isolation.event(&noise, sample);
                match &event {
                    Some(Event::Dismissed) => {
                        self.detector.restart();
                        self.state = State::Watching;
                    }
                    Some(Event::Identified(verdict)) => {
                        self.detector.restart();
                        self.state = match verdict.kind {
                            Kind::Passed => State::Watching,
                            _ => State::Known {
                                limbs: verdict.limbs,
                                quiet: 0,
                            },
                        };
                    }
                    _ => {}
                }
                event
            }
            State::Known { quiet, .. } => {
                *quiet += 1;
                if self.detector.push(&z, &strain).first().is_some() {
                    *quiet = 0;
                }
                if *quiet < QUIET {
                    return None;
                }
                self.detector.restart();
                self.state = State::Watching;
                Some(Event::Quiet)
            }
        }
    }

    #[cold]
    fn unreadable(&mut self, limbs: LimbSet, sample: u64) -> Option<Event> {
        self.detector.restart();
        if let State::Known {
            limbs: known,
            quiet,
        } = &mut self.state
            && *known == limbs
        {
            *quiet = 0;
            return None;
        }
        self.state = State::Known { limbs, quiet: 0 };
        Some(Event::Identified(Verdict {
            limbs,
            kind: Kind::Unreadable,
            since: (sample, sample),
            said_at: sample,
            class_ln_odds: f64::INFINITY,
            kind_ln_odds: f64::INFINITY,
            partner_ln_odds: f64::INFINITY,
        }))
    }
}
