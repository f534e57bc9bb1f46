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
    /// Samples of rest, before the first that is decoupled, whose mean is the level about which it is undone.
    pub samples_of_level: usize,
    /// Whether who decouples is told that zeros wander.
    pub told: bool,
}

impl Amplifier {
    /// How zeros wander of channels with this noise, V, where that is told.
    ///
    /// # Panics
    /// For a corner that is none.
    pub fn wander(&self, white_v: &[f64; LIMBS], rate_hz: f64) -> Option<ZeroWander> {
        let samples = [self.samples_of_level; LIMBS];
        let wander = ZeroWander::new(self.corner_hz, rate_hz, white_v, &samples).expect("a corner");
        self.told.then_some(wander)
    }
}

/// Noise of nine channels behind that.
#[derive(Debug, Clone)]
pub struct UndoneNoise {
    undo: [UndoHighPass; LIMBS],
    level_v: [f64; LIMBS],
    white_v: [f64; LIMBS],
}

impl UndoneNoise {
    /// Draws how far the levels are off.
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
        let of_mean = (amplifier.samples_of_level as f64).sqrt().recip();
        Self {
            undo: [undo; LIMBS],
            level_v: white_v.map(|sd| sd * of_mean * unit(rng)),
            white_v: *white_v,
        }
    }

    /// The next sample of a channel, V.
    pub fn next(&mut self, limb: usize, rng: &mut Pcg64) -> f64 {
        let shown_v = self.white_v[limb] * unit(rng);
        self.undo[limb].step(shown_v - self.level_v[limb]) + self.level_v[limb]
    }
}

fn unit(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}
