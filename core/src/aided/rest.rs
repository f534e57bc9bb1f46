//! Whether the sensor is at rest: for some time, nine channels show nothing but their noise.
//!
//! Rest and a steady turn about the plumb line look the same to nine limbs. The filter tells them apart as long as it knows the rate; a
//! rest that contradicts it counts little at first, and where the next ones do so, too, all that they contradict is doubted.

use super::aid::Aid;
use super::block::Block;
use super::model::ErrorModel;
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// Blocks that must be alike.
const BLOCKS: usize = 24;
/// The last of them, where a motion that begins shows first.
const LAST: usize = 4;
/// Mean square of the blocks' means about their mean, over that of noise, up to which they are alike. By the chi-square distribution noise exceeds that
/// in 1e-7 of looks at nine channels of 24 blocks, and in 1e-5 at six, where three are excluded; noise whose deviation is a fifth larger than it
/// is said to be in one look of eight, or of six.
const ALIKE: f64 = 1.6;
/// Squared difference of the last blocks' mean from that of the others, over its variance, summed up over channels: chance exceeds
/// that once in two thousand times, which costs a rest.
const LAST_ALIKE: f64 = 30.0;
/// Deviations of rate, rad/s, and velocity, m/s, of the floor on which a sensor is at rest.
const FLOOR: [f64; 2] = [1e-4, 1e-3];

/// Looks at blocks as they come.
#[derive(Debug, Clone, PartialEq)]
pub struct RestFinder {
    /// Variance of a sample's noise, V^2, and the interval between samples, s.
    variance_v2: [f64; LIMBS],
    step_s: f64,
    walks_in_1_s: [f64; 2],
    /// Limbs whose channels are not read.
    excluded: LimbSet,
    recent: [[f64; LIMBS]; BLOCKS],
    seen: usize,
    /// Whether a rest ended just before those.
    follows: bool,
}

impl RestFinder {
    /// For channels with white noise of these standard deviations, V, and what it makes of rate and velocity. Those that the model excludes are
    /// not looked at.
    #[must_use]
    pub fn new(model: &ErrorModel, noise_v: &[f64; LIMBS], sample_rate_hz: f64) -> Self {
        Self {
            variance_v2: noise_v.map(|noise| noise * noise),
            step_s: 1.0 / sample_rate_hz,
            walks_in_1_s: model.walks(1.0),
            excluded: model.excluded(),
            recent: [[0.0; LIMBS]; BLOCKS],
            seen: 0,
            follows: false,
        }
    }

    /// Looks at the channels of other limbs from now on, at rests that begin here.
    pub fn set_excluded(&mut self, limbs: LimbSet) {
        self.excluded = limbs;
        self.seen = 0;
        self.follows = false;
    }

    /// Takes the next block; what is known of the sensor if this ends [`BLOCKS`] blocks of rest, none of which has been counted before.
    ///
    /// A motion that has just begun is not seen as long as noise hides it, so that rate and velocity are known as well as noise lets
    /// them walk in the time of these blocks, and not better.
    pub fn push(&mut self, block: &Block) -> Option<Aid> {
        self.recent[self.seen % BLOCKS] = block.voltage_v;
        self.seen += 1;
        if self.seen < BLOCKS {
            return None;
        }
        let of_mean = self.step_s / block.duration_s;
        let newest = self.seen - 1;
        let (mut squares, mut changes) = (0.0, 0.0);
        let variances = self.variance_v2.iter().enumerate();
        for (limb, variance) in variances.filter(|(limb, _)| !self.excluded.contains(*limb)) {
            let volts = |age: usize| self.recent[(newest - age) % BLOCKS][limb];
            let mean_of = |ages: core::ops::Range<usize>| {
                let count = ages.len() as f64;
                ages.map(volts).sum::<f64>() / count
            };
            let mean = mean_of(0..BLOCKS);
            let about: f64 = (0..BLOCKS)
                .map(|age| (volts(age) - mean) * (volts(age) - mean))
                .sum();
            squares += about / (variance * of_mean);
            let change = mean_of(0..LAST) - mean_of(LAST..BLOCKS);
            let share = 1.0 / LAST as f64 + 1.0 / (BLOCKS - LAST) as f64;
            changes += change * change / (variance * of_mean * share);
        }
        let read = LIMBS - self.excluded.len();
        let alike = squares < ALIKE * ((BLOCKS - 1) * read) as f64 && changes < LAST_ALIKE;
        if !alike {
            self.follows = false;
            return None;
        }
        let continues = core::mem::replace(&mut self.follows, true);
        self.seen = 0;
        let time_s = BLOCKS as f64 * block.duration_s;
        let [rate, velocity] = self.walks_in_1_s.map(|walk| walk * sqrt(time_s));
        Some(Aid::Rest {
            deviation_rad_s: rate.max(FLOOR[0]),
            deviation_m_s: velocity.max(FLOOR[1]),
            continues,
        })
    }
}
