//! The stream: nine voltages in, what is wrong out.
//!
//! Watching, an alarm of the [`Detector`] begins a gathering: sample by sample each class of limbs and each swapped pair is
//! scored by the rows since, together with those of the window that alarmed, until one leads by [`CLASS`]; then each doubling of
//! the samples is asked how the limb failed, until that is firm or no samples are left. What nobody leads is dismissed if it
//! has faded, and said to be beyond one limb if not.

use super::class::{CLASSES, members};
use super::detector::{Alarm, CalibrationErrors, Detector};
use super::history::History;
use super::isolation::{evidence, lead};
use super::kind::judge;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use super::step::Ring;
use super::swap::{PAIRED, PAIRS, Swaps};
use super::verdict::{Kind, Verdict};
use crate::error::Result;
use crate::geometry::{LIMBS, LIMBS_PER_NODE};
use crate::kernel::constants::Constants;
use crate::kernel::placement::OVERSTRAIN;
use crate::parameters::Parameters;
use crate::parity::{LimbSet, Reconstruction, residual};
use crate::settings::{Sensor, Settings};

/// ln of the odds at which a class is named: ten thousand to one.
pub const CLASS: f64 = 9.2;
/// Samples after the alarm before a kind is asked for, and until it must be said: the latter at least, and as many windows.
const FIRST_LOOK: u64 = 32;
const LAST_LOOK: u64 = 2048;
const LAST_WINDOWS: u64 = 16;
/// Samples after the alarm at which the channels' steps about it are looked at: a step wants 32 after it.
const STEP_LOOK: u64 = FIRST_LOOK;
/// Samples without any alarm after which a failure is over: two of the longest windows.
pub const QUIET: u64 = 8192;

/// What happens to the watched sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A test failed; what it is will be said later.
    Alarm(Alarm),
    /// The class of limbs is known, how it failed is not.
    Isolated(Verdict),
    /// All that will be said of it.
    Identified(Verdict),
    /// The alarm led to nothing: a false one, as far as anyone can tell.
    Dismissed,
    /// All nine have been quiet for [`QUIET`] samples after a failure.
    Quiet,
}

/// What a monitor is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// Expected number of alarms of a healthy sensor.
    pub false_alarms_per_hour: f64,
    /// Standard deviation of the noise of each channel, V.
    pub noise_v: [f64; LIMBS],
    /// What calibration leaves of each scale factor, one standard deviation, relative; zeros to take it for exact.
    pub scale_sd: [f64; LIMBS],
    /// The same of each zero drift, V.
    pub zero_drift_sd_v: [f64; LIMBS],
}

#[derive(Debug, Clone, PartialEq)]
struct Gathering {
    alarm: Alarm,
    before: [f64; CLASSES],
    rows: Moments,
    history: History,
    swaps: Swaps,
    steps: [f64; LIMBS],
    found: Option<Found>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    class: usize,
    ln_odds: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    Watching,
    Gathering(Gathering),
    Known { limbs: LimbSet, quiet: u64 },
}

/// Watches nine channels. No allocation; constant work per sample but for a handful of samples after an alarm.
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
        let constants = Constants::new(sensor, parameters, settings)?;
        let of = |limb: usize, rows: &[crate::kernel::vector::Vec3<f64>; LIMBS_PER_NODE]| {
            rows[limb % LIMBS_PER_NODE].components()[limb / LIMBS_PER_NODE]
        };
        let strain_per_v: [f64; LIMBS] =
            core::array::from_fn(|limb| of(limb, &constants.strain_per_v));
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
            strain_at_zero: core::array::from_fn(|limb| of(limb, &constants.strain_at_zero)),
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

    /// Nine voltages with those of failed limbs as the others have them.
    pub(crate) fn mended(
        &self,
        voltage_v: &[f64; LIMBS],
        without: &Reconstruction,
        passes: usize,
    ) -> [f64; LIMBS] {
        let failed = without.failed();
        if failed.is_empty() {
            return *voltage_v;
        }
        let mut strain = self.strains(voltage_v);
        for (limb, strain) in strain.iter_mut().enumerate() {
            if failed.contains(limb) {
                *strain = 0.0;
            }
        }
        for _ in 0..passes {
            let left = residual(&strain, self.nu);
            for (strain, weights) in strain.iter_mut().zip(without.weights()) {
                *strain += dot(weights, &left);
            }
        }
        core::array::from_fn(|limb| {
            if failed.contains(limb) {
                (strain[limb] - self.strain_at_zero[limb]) / self.strain_per_v[limb]
            } else {
                voltage_v[limb]
            }
        })
    }

    fn strain(&self, limb: usize, voltage_v: f64) -> f64 {
        self.strain_per_v[limb] * voltage_v + self.strain_at_zero[limb]
    }

    /// Takes the next nine voltages. A value that is no number is a failed limb at once; the rows of such a sample say nothing.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Option<Event> {
        let sample = self.received;
        self.received += 1;
        let strain = self.strains(voltage_v);
        let unreadable = (0..LIMBS)
            .filter(|&limb| !(strain[limb].abs() < OVERSTRAIN))
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
                self.state = State::Gathering(Gathering {
                    alarm,
                    before: if window.samples() > 0 {
                        evidence(&noise, &window)
                    } else {
                        let mut one = Moments::default();
                        one.push(&z);
                        evidence(&noise, &one)
                    },
                    rows: Moments::default(),
                    history: History::default(),
                    swaps: Swaps::default(),
                    steps: [0.0; LIMBS],
                    found: None,
                });
                Some(Event::Alarm(alarm))
            }
            State::Gathering(gathering) => {
                let (slope, zero) = (&self.strain_per_v, &self.strain_at_zero);
                gathering.rows.push(&z);
                gathering.history.push(&noise, &z, &signal);
                if gathering.found.is_none() {
                    gathering.swaps.push(&noise, &z, &strain, |limb, channel| {
                        slope[limb] * voltage_v[channel] + zero[limb]
                    });
                }
                if gathering.rows.samples() == STEP_LOOK {
                    let (from, to) = gathering.since();
                    // A step within a window may show up to a sample beside it.
                    gathering.steps = core::array::from_fn(|limb| {
                        self.ring.largest_step(limb, from.saturating_sub(1), to + 1)
                    });
                }
                let event = gathering.next(&noise, sample);
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
            twin_ln_odds: f64::INFINITY,
        }))
    }
}

impl Gathering {
    /// First and last sample that the failure may have begun with, as the test that failed has it.
    fn since(&self) -> (u64, u64) {
        let alarm = &self.alarm;
        (alarm.sample + 1 - alarm.test.samples(), alarm.sample)
    }

    fn last_look(&self) -> u64 {
        (LAST_WINDOWS * self.alarm.test.samples()).max(LAST_LOOK)
    }

    fn verdict(&self, sample: u64, limbs: LimbSet, kind: Kind, class_ln_odds: f64) -> Verdict {
        Verdict {
            limbs,
            kind,
            since: self.since(),
            said_at: sample,
            class_ln_odds,
            kind_ln_odds: 0.0,
            twin_ln_odds: if limbs.len() == 1 { f64::INFINITY } else { 0.0 },
        }
    }

    fn next(&mut self, noise: &RowNoise, sample: u64) -> Option<Event> {
        match self.found {
            None => self.isolate(noise, sample),
            Some(found) => self.identify(noise, sample, found),
        }
    }

    fn isolate(&mut self, noise: &RowNoise, sample: u64) -> Option<Event> {
        let since = evidence(noise, &self.rows);
        let mut scores = [0.0; CLASSES + PAIRS];
        // Of the window that alarmed, what channels exchanged back would have left is not known: a pair is as good as the best.
        let best_before = self.before.iter().copied().fold(0.0, f64::max);
        let classes = self.before.iter().zip(since).map(|(a, b)| a + b);
        let pairs = self.swaps.evidence().iter().map(|pair| best_before + pair);
        for (score, value) in scores.iter_mut().zip(classes.chain(pairs)) {
            *score = value;
        }
        let (best, margin) = lead(&scores);
        let over = self.rows.samples() >= self.last_look();
        if margin > CLASS {
            let pair = best.checked_sub(CLASSES).and_then(|pair| PAIRED.get(pair));
            if let Some(&[i, j]) = pair {
                let limbs = LimbSet::EMPTY.with(i).with(j);
                let mut verdict = self.verdict(sample, limbs, Kind::Swapped, margin);
                verdict.kind_ln_odds = margin;
                return Some(Event::Identified(verdict));
            }
            if self.explains(noise, best) {
                self.found = Some(Found {
                    class: best,
                    ln_odds: margin,
                });
                let verdict = self.verdict(sample, members(best), Kind::Unknown, margin);
                return Some(Event::Isolated(verdict));
            }
        }
        if !over {
            return None;
        }
        Some(if since.iter().any(|&score| score > CLASS) {
            Event::Identified(self.verdict(sample, LimbSet::EMPTY, Kind::Unknown, 0.0))
        } else {
            Event::Dismissed
        })
    }

    /// Whether what a class leaves of the rows is noise: chi-square of two degrees a sample.
    fn explains(&self, noise: &RowNoise, class: usize) -> bool {
        let left = self.rows.energy() - self.rows.energy_along(noise.direction(class));
        let n = 2.0 * self.rows.samples() as f64;
        // Five standard deviations, and room for the skewness of few.
        left < n + 5.0 * crate::scalar::sqrt(2.0 * n) + 20.0
    }

    fn identify(&self, noise: &RowNoise, sample: u64, found: Found) -> Option<Event> {
        let n = self.rows.samples();
        let over = n >= self.last_look();
        if n < FIRST_LOOK || !(n.is_power_of_two() || over) {
            return None;
        }
        let judged = judge(noise, found.class, &self.rows, &self.history, &self.steps);
        if !(judged.is_firm() || over) {
            return None;
        }
        let mut verdict = self.verdict(sample, judged.limbs, judged.kind, found.ln_odds);
        verdict.kind_ln_odds = judged.kind_ln_odds;
        verdict.twin_ln_odds = judged.twin_ln_odds;
        Some(Event::Identified(verdict))
    }
}
