//! Which limb of an ambiguous pair jumped: a step in the middle of a stretch of an otherwise smooth signal.
//!
//! A cubic is fitted along with the step. Of 64 samples of 10 kHz a cubic follows motion up to some 40 Hz; beyond that both
//! channels seem to step and neither is accepted.

use crate::float::sqrt;
use crate::geometry::LIMBS;

/// Samples kept.
pub const KEPT: usize = 256;
/// Samples on either side of a step.
const SIDE: usize = 32;
/// The whole stretch.
const STRETCH: usize = 2 * SIDE;

/// The last voltages of the nine channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    rows: [[f64; LIMBS]; KEPT],
    received: u64,
}

impl Default for Ring {
    fn default() -> Self {
        Self {
            rows: [[0.0; LIMBS]; KEPT],
            received: 0,
        }
    }
}

impl Ring {
    /// Takes a row and forgets the oldest.
    #[inline]
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) {
        let place = (self.received % KEPT as u64) as usize;
        if let Some(row) = self.rows.get_mut(place) {
            *row = *voltage_v;
        }
        self.received += 1;
    }

    /// Rows taken.
    #[must_use]
    pub const fn received(&self) -> u64 {
        self.received
    }

    /// The row taken last.
    #[inline]
    #[must_use]
    pub fn last(&self) -> &[f64; LIMBS] {
        let place = (self.received.wrapping_sub(1) % KEPT as u64) as usize;
        self.rows.get(place).unwrap_or(&self.rows[0])
    }

    /// Voltages of a channel from sample `from` to before `to`, as far as they are kept.
    pub fn stretch(&self, limb: usize, from: u64, to: u64) -> impl Iterator<Item = f64> {
        let oldest = self.received.saturating_sub(KEPT as u64);
        (from.max(oldest)..to.min(self.received)).map(move |sample| self.at(sample, limb))
    }

    fn at(&self, sample: u64, limb: usize) -> f64 {
        let place = (sample % KEPT as u64) as usize;
        self.rows
            .get(place)
            .and_then(|row| row.get(limb).copied())
            .unwrap_or(0.0)
    }

    /// The largest step of a channel, V, that begins with one of the samples `from` to `to`.
    #[must_use]
    pub fn largest_step(&self, limb: usize, from: u64, to: u64) -> f64 {
        let oldest = self.received.saturating_sub(KEPT as u64);
        let first = from.max(oldest + SIDE as u64);
        let last = to.min(self.received.saturating_sub(SIDE as u64));
        let shape = Shape::new();
        (first..=last)
            .map(|onset| {
                let begin = onset - SIDE as u64;
                let sum: f64 = (0..STRETCH)
                    .map(|k| shape.0[k] * self.at(begin + k as u64, limb))
                    .sum();
                sum.abs()
            })
            .fold(0.0, f64::max)
    }
}

/// A step without its part in cubics, of unit norm.
struct Shape([f64; STRETCH]);

impl Shape {
    fn new() -> Self {
        let at = |k: usize| (k as f64 - 0.5 * (STRETCH as f64 - 1.0)) / SIDE as f64;
        let mut step: [f64; STRETCH] = core::array::from_fn(|k| if k < SIDE { -0.5 } else { 0.5 });
        // A step is odd about its middle: of a cubic only the odd powers matter. Gram and Schmidt.
        let mut linear: [f64; STRETCH] = core::array::from_fn(at);
        unit(&mut linear);
        let mut cubic: [f64; STRETCH] = core::array::from_fn(|k| at(k) * at(k) * at(k));
        take_off(&mut cubic, &linear);
        unit(&mut cubic);
        take_off(&mut step, &linear);
        take_off(&mut step, &cubic);
        unit(&mut step);
        Self(step)
    }
}

fn product(a: &[f64; STRETCH], b: &[f64; STRETCH]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn take_off(from: &mut [f64; STRETCH], of: &[f64; STRETCH]) {
    let share = product(from, of);
    for (a, b) in from.iter_mut().zip(of) {
        *a -= share * b;
    }
}

fn unit(of: &mut [f64; STRETCH]) {
    let length = sqrt(product(of, of));
    for x in of {
        *x /= length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_have_no_step_and_a_step_is_one() {
        let step_of = |jump: f64| {
            let mut ring = Ring::default();
            for k in 0..200 {
                let t = f64::from(k) / 64.0;
                let smooth = 100.0 * (1.0 + t - 3.0 * t * t + t * t * t);
                ring.push(&[smooth + if k < 150 { 0.0 } else { jump }; LIMBS]);
            }
            ring.largest_step(3, 0, 200)
        };
        assert!(step_of(0.0) < 1e-9, "{}", step_of(0.0));
        // |h|^2 = 64 (1/4 - 3/16 - 7/256): what Legendre's first and third polynomial leave of a step.
        let expected = 5.0 * sqrt(64.0 * (0.25 - 3.0 / 16.0 - 7.0 / 256.0));
        assert!(
            (step_of(5.0) / expected - 1.0).abs() < 0.01,
            "{} {expected}",
            step_of(5.0)
        );
    }
}
