//! Whether a recording's channels are noisier than those that were calibrated with: deviations are made of that noise, and know no other.
//!
//! Sixth differences leave white noise and take off motion: of one at a twenty-fifth of the sample rate a 4000th part is left, of one at a
//! hundredth nothing.

use sixaxis_core::{LIMBS, LimbSet};

use super::Row;
use super::setup::Setup;
use crate::calibration::Calibration;

/// Differences of this order have so many times the variance of white noise: the sum of the squares of its binomials.
const ORDER: usize = 6;
const VARIANCE: f64 = 924.0;
/// Samples of a block, of which one in so many is looked at.
const BLOCK: usize = 64;
const EVERY: usize = 8;
/// Blocks from which something is said.
const FEWEST: u64 = 4;
/// Times the calibration's noise that most blocks of a channel must have. A block tells its noise to a fifth.
const TIMES: f64 = 2.0;
/// Share of the converter's range that counts as noise at least: a step of sixteen bits, as noise-free recordings have it.
const OF_RANGE: f64 = 2e-5;

/// The noise of nine channels.
#[derive(Debug, Clone)]
pub struct NoiseLevel {
    /// The calibration's, V.
    expected_v: Row,
    blocks: u64,
    /// Blocks of each channel with more than [`TIMES`] as much, and sums of the logarithms of how many times.
    loud: [u64; LIMBS],
    times: Row,
    unread: LimbSet,
}

impl NoiseLevel {
    /// Nothing seen yet; none where the calibration states no noise, or a low-pass takes it off. Channels of `unread` limbs are not looked at.
    pub fn new(setup: &Setup, calibration: &Calibration, unread: LimbSet) -> Option<Self> {
        let propagated = calibration.covariance.propagated.as_ref()?;
        let least_v = OF_RANGE * setup.full_scale_v;
        setup.conditioning.low_pass_hz.is_none().then(|| Self {
            expected_v: propagated
                .channel_noise_v
                .map(|noise_v| noise_v.max(least_v)),
            blocks: 0,
            loud: [0; LIMBS],
            times: [0.0; LIMBS],
            unread,
        })
    }

    /// Looks at the next samples, nine columns of voltages.
    pub fn look(&mut self, voltage_v: [&[f64]; LIMBS]) {
        let samples = voltage_v[0].len();
        for from in (0..samples.saturating_sub(BLOCK - 1)).step_by(EVERY * BLOCK) {
            self.blocks += 1;
            for (limb, column) in voltage_v.into_iter().enumerate() {
                let times = noise_v(&column[from..from + BLOCK]) / self.expected_v[limb];
                // What is no number is not louder.
                self.loud[limb] += u64::from(times > TIMES);
                self.times[limb] += if times > 0.0 { times.ln() } else { 0.0 };
            }
        }
    }

    /// The channels that are noisier for most of the recording, if there are any.
    pub fn verdict(&self) -> Option<String> {
        let louder =
            |limb: &usize| !self.unread.contains(*limb) && 2 * self.loud[*limb] > self.blocks;
        let louder: Vec<usize> = (0..LIMBS).filter(louder).collect();
        let times = louder
            .iter()
            .map(|limb| (self.times[*limb] / self.blocks as f64).exp());
        let most = times.fold(0.0, f64::max);
        let channels: Vec<String> = louder.iter().map(|limb| (limb + 1).to_string()).collect();
        (self.blocks >= FEWEST && !louder.is_empty()).then(|| {
            format!(
                "channels {} have up to {most:.1} times the white noise that the calibration knows: deviations, and how long the attitude is \
                 known, are of the calibration's",
                channels.join(", ")
            )
        })
    }
}

/// Standard deviation of the white noise of a block.
fn noise_v(block: &[f64]) -> f64 {
    let mut differences: [f64; BLOCK] = core::array::from_fn(|k| block[k]);
    for order in 1..=ORDER {
        for k in 0..BLOCK - order {
            differences[k] = differences[k + 1] - differences[k];
        }
    }
    let left = &differences[..BLOCK - ORDER];
    let squares: f64 = left.iter().map(|d| d * d).sum();
    (squares / (left.len() as f64 * VARIANCE)).sqrt()
}
