//! What is left in channels whose amplifiers' high-pass is undone. That is linear, and gives back what the amplifiers took: what it makes of noise is all.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::LIMBS;
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::dsp::lag::UndoHighPass;

/// Amplifiers whose high-pass is undone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplifier {
    /// Its corner, Hz.
    pub corner_hz: f64,
    /// First samples of a recording whose mean is the level about which it is undone. The sensor need not rest: what it shows besides noise comes out
    /// as if the level were known.
    pub samples_of_level: usize,
    /// Whether who decouples is told that zeros wander.
    pub told: bool,
}

impl Amplifier {
    /// How zeros wander, where that is told.
    ///
    /// # Panics
    /// For a corner that is none.
    pub fn wander(&self, rate_hz: f64) -> Option<ZeroWander> {
        let samples = [self.samples_of_level; LIMBS];
        let wander = ZeroWander::new(self.corner_hz, rate_hz, &samples).expect("a corner");
        self.told.then_some(wander)
    }
}

/// Noise of nine channels behind that.
#[derive(Debug, Clone)]
pub struct UndoneNoise {
    undo: [UndoHighPass; LIMBS],
    level_v: [f64; LIMBS],
    /// The samples that the levels are of, to come.
    first_v: [std::vec::IntoIter<f64>; LIMBS],
    white_v: [f64; LIMBS],
}

impl UndoneNoise {
    /// Draws the samples that the levels are means of.
    ///
    /// # Panics
    /// For a corner that is none.
    pub fn new(
        amplifier: &Amplifier,
        white_v: &[f64; LIMBS],
        rate_hz: f64,
        rng: &mut Pcg64,
    ) -> Self {
        let undo = UndoHighPass::new(amplifier.corner_hz, rate_hz).expect("a corner");
        let n = amplifier.samples_of_level;
        let first_v = white_v.map(|sd| (0..n).map(|_| sd * unit(rng)).collect::<Vec<_>>());
        Self {
            undo: [undo; LIMBS],
            level_v: core::array::from_fn(|limb| first_v[limb].iter().sum::<f64>() / n as f64),
            first_v: first_v.map(Vec::into_iter),
            white_v: *white_v,
        }
    }

    /// The next sample of a channel, V.
    pub fn next(&mut self, limb: usize, rng: &mut Pcg64) -> f64 {
        let first_v = self.first_v[limb].next();
        let shown_v = first_v.unwrap_or_else(|| self.white_v[limb] * unit(rng));
        self.undo[limb].step(shown_v - self.level_v[limb]) + self.level_v[limb]
    }
}

fn unit(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}
