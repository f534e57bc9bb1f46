//! An amplifier's first-order high-pass, undone about the level at which the record begins.

use std::sync::{Arc, OnceLock};

use sixaxis_core::Result;
use sixaxis_core::dsp::lag::UndoHighPass;
use sixaxis_core::dsp::stage::Stage;

/// Samples that the level is the mean of at least: at rest in any run that begins at rest. What it is off by grows with time, because
/// undoing a high-pass integrates.
pub(crate) const BASELINE: usize = 16;

/// Standard deviations of its mean by which the next [`BASELINE`] samples are off the level where the rest has ended.
const DEPARTS: f64 = 5.0;

/// Share of a rest that has ended which is taken: a motion that has just begun may hide in the noise.
const TAKEN: f64 = 0.75;

/// Longest rest whose mean is the level that a high-pass is undone about, s: a stream hands nothing on before it is over.
pub const LONGEST_REST_S: f64 = 2.0;
/// The same in samples, at whatever rate: they are kept.
const LONGEST_REST: f64 = 262_144.0;

/// That rest at a rate, samples.
pub fn longest_rest(sample_rate_hz: f64) -> usize {
    (LONGEST_REST_S * sample_rate_hz).min(LONGEST_REST) as usize
}

/// Samples of the rest that a channel's record begins with, of `longest` at most.
pub(super) fn at_rest(series: impl Iterator<Item = f64>, longest: usize) -> usize {
    let mut beginning = Beginning::new(longest);
    for sample in series {
        if let Some(at_rest) = beginning.take(sample) {
            return at_rest;
        }
    }
    beginning.of_whole_record()
}

/// One channel's amplifier, undone; the samples that the level is taken of are handed on together.
#[derive(Debug, Clone, PartialEq)]
pub struct UndoneHighPass {
    undo: UndoHighPass,
    level: Option<f64>,
    samples_of_level: Arc<OnceLock<usize>>,
    beginning: Beginning,
}

/// The samples at which a record rests before it moves.
#[derive(Debug, Clone, PartialEq)]
struct Beginning {
    longest: usize,
    samples: Vec<f64>,
    sum: f64,
    /// Squares of the steps from sample to sample within [`BASELINE`] samples: each has twice the variance of white noise.
    steps: f64,
}

impl UndoneHighPass {
    /// Of an amplifier with its corner at `corner_hz`. The level is the mean of the rest that the record begins with, of `longest` samples at
    /// most and of [`BASELINE`] at least.
    ///
    /// # Errors
    /// [`sixaxis_core::Error::OutOfRange`] unless both frequencies are positive and finite.
    pub fn new(corner_hz: f64, sample_rate_hz: f64, longest: usize) -> Result<Self> {
        Ok(Self {
            undo: UndoHighPass::new(corner_hz, sample_rate_hz)?,
            level: None,
            samples_of_level: Arc::default(),
            beginning: Beginning::new(longest),
        })
    }

    /// The number of samples that the level is the mean of, once the rest is over, for whoever no longer has the stage at hand.
    #[must_use]
    pub fn samples_of_level(&self) -> Arc<OnceLock<usize>> {
        Arc::clone(&self.samples_of_level)
    }

    fn begin(&mut self, at_rest: usize, out: &mut Vec<f64>) {
        let beginning = core::mem::take(&mut self.beginning.samples);
        let rest = &beginning[..at_rest];
        self.level = Some(rest.iter().sum::<f64>() / rest.len().max(1) as f64);
        self.samples_of_level.get_or_init(|| rest.len().max(1));
        self.push(&beginning, out);
    }
}

impl Beginning {
    fn new(longest: usize) -> Self {
        Self {
            longest,
            samples: Vec::with_capacity(BASELINE),
            sum: 0.0,
            steps: 0.0,
        }
    }

    /// How many samples the level is to be taken of where the record ends before the rest.
    fn of_whole_record(&self) -> usize {
        let whole_blocks = self.samples.len() / BASELINE * BASELINE;
        let taken = (TAKEN * whole_blocks as f64) as usize;
        taken.max(BASELINE).min(self.samples.len())
    }

    /// Takes a sample; once the rest has ended, how many samples the level is to be taken of.
    fn take(&mut self, sample: f64) -> Option<usize> {
        self.samples.push(sample);
        let taken = self.samples.len();
        if !taken.is_multiple_of(BASELINE) {
            return None;
        }
        let before = taken - BASELINE;
        let block = &self.samples[before..];
        let sum: f64 = block.iter().sum();
        let steps = block.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        self.steps += steps.sum::<f64>();
        if before > 0 {
            let noise = self.steps / (2 * (taken - taken / BASELINE)) as f64;
            let spread = noise * ((BASELINE as f64).recip() + (before as f64).recip());
            let apart = sum / BASELINE as f64 - self.sum / before as f64;
            // What is no number is no rest.
            let rests = apart * apart <= DEPARTS * DEPARTS * spread;
            if !rests {
                return Some(((TAKEN * before as f64) as usize).max(BASELINE));
            }
        }
        self.sum += sum;
        (taken + BASELINE > self.longest).then_some(taken)
    }
}

impl Stage for UndoneHighPass {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for (index, sample) in samples.iter().enumerate() {
            if let Some(level) = self.level {
                let more = samples[index..].iter();
                out.extend(more.map(|x| self.undo.step(x - level) + level));
                return;
            }
            if let Some(at_rest) = self.beginning.take(*sample) {
                self.begin(at_rest, out);
            }
        }
    }

    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()> {
        if self.level.is_none() {
            self.begin(self.beginning.of_whole_record(), out);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the rest of a record: noise of 1, evenly distributed, the same on every machine, and from `begins` on a motion.
    fn record(begins: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..4000_usize)
            .map(|k| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let noise = 12.0_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
                let moved = k.saturating_sub(begins) as f64 / 1000.0;
                0.3 + noise + 400.0 * moved * moved
            })
            .collect()
    }

    fn level(series: &[f64], longest: usize) -> f64 {
        let mut stage = UndoneHighPass::new(0.1, 1000.0, longest).expect("frequencies");
        let mut out = Vec::new();
        for part in series.chunks(7) {
            stage.push(part, &mut out);
        }
        stage.finish(&mut out).expect("an end");
        assert_eq!(out.len(), series.len());
        stage.level.expect("known at the end")
    }

    #[test]
    fn ref_the_level_is_the_mean_of_the_rest() {
        let off = |begins: usize, longest: usize| {
            let squares =
                (1..=200).map(|seed| (level(&record(begins, seed), longest) - 0.3).powi(2));
            (squares.sum::<f64>() / 200.0).sqrt()
        };
        // Sixteen samples of white noise are off by a quarter of it; a motion from the first sample on hides in the noise for 30.
        for (begins, longest, at_most) in [
            (0, 2000, 0.4),
            (20, 2000, 0.3),
            (300, 2000, 0.1),
            (3000, 2000, 0.03),
            (3000, BASELINE, 0.3),
        ] {
            let off = off(begins, longest);
            assert!(off < at_most, "{begins}, {longest}: {off}");
        }
        assert!(off(3000, BASELINE) > 0.2);
    }
}
