//! Channels that stand still to the last bit: dead or stuck, whatever the sums of forces say.
//!
//! A channel with a converter's noise repeats a value now and then, and the more often the coarser the converter is. A run of equal
//! values is therefore held to the longest run that any channel has ended so far, and to [`HELD`].

use super::history::FOURTH;
use super::step::Ring;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// Repetitions from which a channel is held, at least, and times the longest run that has ended.
pub const HELD: u32 = 32;
const TIMES: u32 = 8;
/// Longest run that counts as one of a sound channel: what stood still for longer had failed.
const LONGEST: u32 = 4 * HELD;
/// Repetitions from which a channel may become held, and below which it moves.
const PAUSE: u32 = 8;
/// Channels that must move and have their noise for others that stand still to have failed.
const WITNESSES: usize = 5;
/// Samples from one look at them to the next.
const ASKED: u32 = 8;
/// Share of its noise that such a channel has at least.
const NOISY: f64 = 0.05;

/// Lengths of the runs of equal values.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Held {
    run: [u32; LIMBS],
    longest: u32,
    running: bool,
}

impl Held {
    /// Takes a row and the one before.
    #[inline]
    pub fn push(&mut self, row: &[f64; LIMBS], before: &[f64; LIMBS]) {
        let mut same = 0;
        for (a, b) in row.iter().zip(before) {
            same += u32::from(a.to_bits() == b.to_bits());
        }
        if same > 0 || self.running {
            self.count(row, before);
        }
    }

    fn count(&mut self, row: &[f64; LIMBS], before: &[f64; LIMBS]) {
        self.running = false;
        for ((run, a), b) in self.run.iter_mut().zip(row).zip(before) {
            if a.to_bits() == b.to_bits() {
                *run = run.saturating_add(1);
                self.running = true;
            } else {
                self.longest = self.longest.max((*run).min(LONGEST));
                *run = 0;
            }
        }
    }

    fn limit(&self) -> u32 {
        HELD.max(TIMES * self.longest)
    }

    fn from(&self, run: u32) -> LimbSet {
        (0..LIMBS)
            .filter(|&limb| self.run[limb] >= run)
            .fold(LimbSet::EMPTY, LimbSet::with)
    }

    /// Whether any channel repeats itself.
    #[inline]
    pub const fn is_running(&self) -> bool {
        self.running
    }

    /// Repetitions of a channel's present value.
    pub const fn run(&self, limb: usize) -> u32 {
        if limb < LIMBS { self.run[limb] } else { 0 }
    }

    /// Channels that are held.
    pub fn held(&self) -> LimbSet {
        self.from(self.limit())
    }

    /// Channels that pause and may become held.
    pub fn pausing(&self) -> LimbSet {
        self.from(PAUSE).minus(self.held())
    }

    /// Whether most of the channels have their noise and all that have not failed move while some stand still to the last bit;
    /// `signal` is a channel's voltage in its noise.
    #[cold]
    pub fn witnessed(
        &self,
        still: LimbSet,
        failed: LimbSet,
        ring: &Ring,
        signal: impl Fn(usize, f64) -> f64,
    ) -> bool {
        // The limit is a multiple of this; what is not witnessed need not be asked with each sample.
        let due = |limb| self.run(limb).is_multiple_of(ASKED);
        if !still.indices().any(due) || !self.pausing().minus(failed).is_empty() {
            return false;
        }
        let noisy = |limb: usize| {
            let to = ring.received();
            let mut last = [0.0; 4];
            let (mut n, mut rough) = (0.0, 0.0);
            for y in ring.stretch(limb, to.saturating_sub(u64::from(HELD)), to) {
                let y = signal(limb, y);
                let [a, b, c, d] = last;
                if n >= 4.0 {
                    let fourth = y - 4.0 * a + 6.0 * b - 4.0 * c + d;
                    rough += fourth * fourth / FOURTH;
                }
                last = [y, a, b, c];
                n += 1.0;
            }
            rough > NOISY * n
        };
        let others = LimbSet::ALL.minus(self.held());
        others.indices().filter(|&limb| noisy(limb)).count() >= WITNESSES
    }

    /// First and last sample at which channels that stand still at a sample may have begun to.
    pub fn since(&self, limbs: LimbSet, sample: u64) -> (u64, u64) {
        let runs = || limbs.indices().map(|limb| u64::from(self.run(limb)));
        let (longest, shortest) = (runs().max().unwrap_or(0), runs().min().unwrap_or(0));
        // The first of equal values may be the last sound one.
        (
            sample.saturating_sub(longest),
            sample.saturating_sub(shortest) + 1,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_held_after_eight_times_the_longest_run() {
        let mut held = Held::default();
        let mut last = [0.0; LIMBS];
        for k in 1..=200_u32 {
            // Channel 1 changes at each sixth sample, 5 stands still from sample 101 on, the others change always.
            let row = core::array::from_fn(|i| match i {
                0 => f64::from(k / 6),
                4 => f64::from(k.min(100)),
                _ => f64::from(k),
            });
            held.push(&row, &last);
            last = row;
            let expected = if k < 100 + 8 * 5 {
                LimbSet::EMPTY
            } else {
                LimbSet::EMPTY.with(4)
            };
            assert_eq!(held.held(), expected, "{k}");
        }
        assert!(held.is_running());
        assert_eq!(held.run(4), 100);
        assert_eq!(held.run(LIMBS), 0);
    }
}
