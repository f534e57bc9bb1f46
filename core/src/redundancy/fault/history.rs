//! Statistics of a failure and of each channel since the alarm, as running sums.

use super::class::{CLASS_OF, CLASSES};
use super::noise::{RowNoise, dot};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::redundancy::parity::ROWS;

/// Sums of one channel, in its noise; the signal counts from no force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Channel {
    /// Sum of the signal.
    pub sum: f64,
    /// Sum of its squares.
    pub square: f64,
    /// Sum of its products with the size of a failure of its class, that in its own deviation.
    pub with_size: f64,
    /// Sum of the squares of fourth differences over their variance: noise alone makes it as large as their number.
    pub rough: f64,
}

/// Sums since the alarm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct History {
    /// Samples taken.
    pub samples: u64,
    /// Of each channel.
    pub channels: [Channel; LIMBS],
    /// Sum of the products of neighbouring sizes of a failure of each class: near the sum of squares where its course is smooth.
    pub lagged: [f64; CLASSES],
    last: [[f64; LIMBS]; 4],
    last_size: [f64; CLASSES],
}

/// Variance of a fourth difference of unit white noise: 1 + 16 + 36 + 16 + 1.
pub(super) const FOURTH: f64 = 70.0;

/// Variance of a mean of n squared fourth differences of white noise, times n: 2 sum of squared correlations,
/// C(16, 8)/C(8, 4)^2 of them.
pub(super) const ROUGH_SPREAD: f64 = 2.0 * 12870.0 / 4900.0;

impl History {
    /// Takes whitened rows and the nine signals in units of their noise.
    pub fn push(&mut self, noise: &RowNoise, z: &[f64; ROWS], signal: &[f64; LIMBS]) {
        let size: [f64; CLASSES] = core::array::from_fn(|class| dot(noise.direction(class), z));
        let [a, b, c, d] = self.last;
        for (limb, channel) in self.channels.iter_mut().enumerate() {
            let y = signal[limb];
            channel.sum += y;
            channel.square += y * y;
            channel.with_size += y * size.get(CLASS_OF[limb]).copied().unwrap_or(0.0);
            if self.samples >= 4 {
                let fourth = y - 4.0 * a[limb] + 6.0 * b[limb] - 4.0 * c[limb] + d[limb];
                channel.rough += fourth * fourth / FOURTH;
            }
        }
        for ((lagged, now), before) in self.lagged.iter_mut().zip(size).zip(self.last_size) {
            *lagged += now * before;
        }
        self.last = [*signal, a, b, c];
        self.last_size = size;
        self.samples += 1;
    }

    /// Standard deviations by which a channel is rougher than its noise.
    #[must_use]
    pub fn roughness(&self, limb: usize) -> f64 {
        let n = self.samples.saturating_sub(4) as f64;
        match self.channels.get(limb) {
            Some(channel) if n > 0.0 => (channel.rough - n) / sqrt(ROUGH_SPREAD * n),
            _ => 0.0,
        }
    }
}
