//! Where a channel leaves its own course from one sample to the next: a spike, a step, samples that are missing.
//!
//! Third differences take off what a motion is in four samples, and leave white noise with twenty times its variance. What stands far out of
//! both noise and converter steps is no motion of a mass on springs, but may be a blow, which reaches several channels: which of the two it is
//! the others tell.

use serde::Serialize;

/// Times its deviation by noise, and converter steps, beyond which a third difference is none of noise and rounding.
const TIMES: f64 = 25.0;
const STEPS: f64 = 20.0;
/// Variance of third differences of white noise.
const VARIANCE: f64 = 20.0;
/// Samples of a third difference, and those before a piece that the first ones need.
const SPAN: usize = 4;
const BEFORE: usize = SPAN - 1;
/// Share of the largest difference of neighbours from which one is where the jump begins.
const BEGINS: f64 = 0.5;
/// Jumps kept.
pub const KEPT: usize = 4096;

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Jump {
    /// Sample before which it is, from 0.
    pub sample: u64,
    /// Difference of neighbours there, signed, in the channel's unit.
    pub by: f64,
}

/// Those of one channel.
#[derive(Debug, Clone, Default)]
pub struct Jumps {
    /// The first ones, at most [`KEPT`].
    pub first: Vec<Jump>,
    /// The end of the piece before, if no gap follows it.
    tail: Vec<f64>,
}

impl Jumps {
    /// Looks at a piece without a gap, from this sample on, with such noise.
    pub fn look(&mut self, piece: &[f64], from: u64, noise: f64) {
        let from = from - self.tail.len() as u64;
        let mut joined = std::mem::take(&mut self.tail);
        joined.extend_from_slice(piece);
        self.search(&joined, from, noise);
        self.tail = joined.split_off(joined.len().saturating_sub(BEFORE));
    }

    /// What comes next is no neighbour of what was last.
    pub fn gap(&mut self) {
        self.tail.clear();
    }

    fn search(&mut self, samples: &[f64], from: u64, noise: f64) {
        let changes = samples.windows(2).map(|w| (w[1] - w[0]).abs());
        let step = changes
            .filter(|change| *change > 0.0)
            .fold(f64::INFINITY, f64::min);
        let most = TIMES * VARIANCE.sqrt() * noise + STEPS * step;
        let mut jump: Option<(usize, usize)> = None;
        for (k, w) in samples.windows(SPAN).enumerate() {
            if ((w[3] - w[0]) - 3.0 * (w[2] - w[1])).abs() > most {
                match &mut jump {
                    Some((_, last)) if k - *last < SPAN => *last = k,
                    _ => {
                        self.keep(samples, from, jump);
                        jump = Some((k, k));
                    }
                }
            }
        }
        self.keep(samples, from, jump);
    }

    /// Keeps a jump from one third difference to another.
    fn keep(&mut self, samples: &[f64], from: u64, jump: Option<(usize, usize)>) {
        let Some((first, last)) = jump.filter(|_| self.first.len() < KEPT) else {
            return;
        };
        let change = |at: usize| samples[at] - samples[at - 1];
        let places = || first + 1..last + SPAN;
        let largest = places().map(|at| change(at).abs()).fold(0.0, f64::max);
        let begins = places().find(|at| change(*at).abs() >= BEGINS * largest);
        let jump = begins.map(|at| Jump {
            sample: from + at as u64,
            by: change(at),
        });
        // One that goes on into the next piece is found in both.
        let before = self.first.last().map(|last| last.sample + SPAN as u64);
        self.first
            .extend(jump.filter(|jump| before.is_none_or(|before| jump.sample >= before)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: f64 = 4e-3;
    const PIECE: usize = 4096;

    /// Jumps of a 3 Hz motion at 1 kHz with noise, in pieces, after something was done to it.
    fn found(spoil: impl Fn(&mut Vec<f64>)) -> Vec<Jump> {
        let mut state = 11_u64;
        let mut noise = || {
            let mut unit = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            NOISE * ((0..12).map(|_| unit()).sum::<f64>() - 6.0)
        };
        let course = |k: usize| 5.0 * (core::f64::consts::TAU * 3e-3 * k as f64).sin();
        let mut series: Vec<f64> = (0..2 * PIECE).map(|k| course(k) + noise()).collect();
        spoil(&mut series);
        let mut jumps = Jumps::default();
        for (k, piece) in series.chunks(PIECE).enumerate() {
            jumps.look(piece, (k * PIECE) as u64, NOISE);
        }
        jumps.first
    }

    #[test]
    fn spikes_steps_and_missing_samples_are_found_where_they_are() {
        assert_eq!(found(|_| ()), []);
        // Where one piece ends and the next begins as well.
        for place in [2000, PIECE - 2, PIECE - 1, PIECE, PIECE + 1] {
            let one = |jumps: Vec<Jump>| match jumps[..] {
                [jump] => jump,
                _ => panic!("{place}: {jumps:?}"),
            };
            let spike = one(found(|u| u[place] += 3.0));
            assert_eq!(spike.sample, place as u64);
            assert!((spike.by - 3.0).abs() < 0.2, "{spike:?}");
            let step = one(found(|u| u[place..].iter_mut().for_each(|u| *u -= 1.0)));
            assert_eq!(step.sample, place as u64);
            assert!((step.by + 1.0).abs() < 0.2, "{step:?}");
        }
        let gap = found(|u| {
            u.drain(PIECE..PIECE + 8);
        });
        assert!(gap.len() == 1 && gap[0].sample == PIECE as u64, "{gap:?}");
    }

    #[test]
    fn spikes_that_recur_are_all_found_and_none_across_a_gap() {
        let recur = found(|u| u.iter_mut().skip(7).step_by(500).for_each(|u| *u += 3.0));
        assert_eq!(recur.len(), (2 * PIECE - 7).div_ceil(500));
        let mut jumps = Jumps::default();
        jumps.look(&[1e-3, 2e-3, 1e-3, 2e-3], 0, NOISE);
        jumps.gap();
        jumps.look(&[5.001, 5.002, 5.001, 5.002], 5, NOISE);
        assert_eq!(jumps.first, []);
    }
}
