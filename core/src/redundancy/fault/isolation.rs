//! Isolation of a failure: the sequence of decisions from an alarm until class, kind and limb are known.

use super::class::{CLASSES, members};
use super::detector::Alarm;
use super::history::History;
use super::kind::judge;
use super::likelihood::{lead, likelihood};
use super::moments::Moments;
use super::monitor::Event;
use super::noise::RowNoise;
use super::step::Ring;
use super::swap::{PAIRED, PAIRS, Swaps};
use super::verdict::{Kind, Verdict};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::ROWS;

/// ln of the odds from which a class is accepted: ten thousand to one.
pub const CLASS: f64 = 9.2;
/// Samples after the alarm from which the kind is estimated, and at which it is reported however uncertain: the latter at least,
/// and as many windows of the test that failed.
const FIRST_LOOK: u64 = 32;
const LAST_LOOK: u64 = 2048;
const LAST_WINDOWS: u64 = 16;
/// Samples after the alarm at which the channels are searched for a step about it: a step needs 32 samples after it.
const STEP_LOOK: u64 = FIRST_LOOK;

/// An alarm, and the statistics since.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Isolation {
    alarm: Alarm,
    before: [f64; CLASSES],
    rows: Moments,
    history: History,
    swaps: Swaps,
    steps: [f64; LIMBS],
    found: Option<Found>,
}

/// The class, once it leads.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    class: usize,
    ln_odds: f64,
}

impl Isolation {
    /// Begins with the window that raised the alarm, or with its sample.
    pub fn new(alarm: Alarm, noise: &RowNoise, window: &Moments, z: &[f64; ROWS]) -> Self {
        let before = if window.samples() > 0 {
            likelihood(noise, window)
        } else {
            let mut one = Moments::default();
            one.push(z);
            likelihood(noise, &one)
        };
        Self {
            alarm,
            before,
            rows: Moments::default(),
            history: History::default(),
            swaps: Swaps::default(),
            steps: [0.0; LIMBS],
            found: None,
        }
    }

    /// Takes whitened rows, signals in their noise, and strains; `strain_of` is what strain a limb's sensitivity makes of a
    /// channel's voltage.
    pub fn push(
        &mut self,
        noise: &RowNoise,
        z: &[f64; ROWS],
        signal: &[f64; LIMBS],
        strain: &[f64; LIMBS],
        strain_of: impl Fn(usize, usize) -> f64,
    ) {
        self.rows.push(z);
        self.history.push(noise, z, signal);
        if self.found.is_none() {
            self.swaps.push(noise, z, strain, strain_of);
        }
    }

    /// Searches the channels for steps about the alarm, once, when enough samples follow it.
    pub fn look_for_steps(&mut self, ring: &Ring) {
        if self.rows.samples() == STEP_LOOK {
            let (from, to) = self.since();
            // A step within a window may show up to a sample beside it.
            self.steps = core::array::from_fn(|limb| {
                ring.largest_step(limb, from.saturating_sub(1), to + 1)
            });
        }
    }

    /// First and last sample at which the failure may have begun: the window of the test that failed.
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
            partner_ln_odds: if limbs.len() == 1 { f64::INFINITY } else { 0.0 },
        }
    }

    /// The event of this sample, if one is decided.
    pub fn event(&mut self, noise: &RowNoise, sample: u64) -> Option<Event> {
        match self.found {
            None => self.isolate(noise, sample),
            Some(found) => self.identify(noise, sample, found),
        }
    }

    fn isolate(&mut self, noise: &RowNoise, sample: u64) -> Option<Event> {
        let since = likelihood(noise, &self.rows);
        let mut scores = [0.0; CLASSES + PAIRS];
        // The window that alarmed holds no strains, so that a pair cannot be scored by it: it is given the best class's score.
        let best_before = self.before.iter().copied().fold(0.0, f64::max);
        let classes = self.before.iter().zip(since).map(|(a, b)| a + b);
        let pairs = self
            .swaps
            .likelihood()
            .iter()
            .map(|pair| best_before + pair);
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

    /// Whether the rows less a failure of the class are noise: chi-square with two degrees of freedom a sample.
    fn explains(&self, noise: &RowNoise, class: usize) -> bool {
        let left = self.rows.energy() - self.rows.energy_along(noise.direction(class));
        let n = 2.0 * self.rows.samples() as f64;
        // Five standard deviations, and room for the skewness of few.
        left < n + 5.0 * crate::float::sqrt(2.0 * n) + 20.0
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
        verdict.partner_ln_odds = judged.partner_ln_odds;
        Some(Event::Identified(verdict))
    }
}
