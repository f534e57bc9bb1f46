//! Statistics of a failure and of each channel since the alarm, as running sums.

use super::class::{CLASS_OF, CLASSES};
use super::misfit::{Misfit, limit};
use super::noise::{RowNoise, add_outer, apply, dot};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
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
    /// Sum of the products of the rows, and of the rows and those of the sample before.
    square: [[f64; ROWS]; ROWS],
    lagged: [[f64; ROWS]; ROWS],
    last: [[f64; LIMBS]; 4],
    last_rows: [f64; ROWS],
    /// Standard deviation of the error of each channel's zero.
    zero_sd: [f64; LIMBS],
}

/// Variance of a fourth difference of unit white noise: 1 + 16 + 36 + 16 + 1.
pub(super) const FOURTH: f64 = 70.0;

/// Variance of a mean of n squared fourth differences of white noise, times n: 2 sum of squared correlations,
/// C(16, 8)/C(8, 4)^2 of them.
pub(super) const ROUGH_SPREAD: f64 = 2.0 * 12870.0 / 4900.0;

/// Standard deviations of a sum of products of neighbours up to which they are noise.
const WHITE: f64 = 3.5;

impl History {
    /// For zeros known to so many standard deviations of the channels' noise.
    pub fn new(zero_sd: [f64; LIMBS]) -> Self {
        Self {
            zero_sd,
            ..Self::default()
        }
    }

    /// None of the samples so far.
    #[must_use]
    pub fn anew(&self) -> Self {
        Self::new(self.zero_sd)
    }

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
        add_outer(&mut self.square, z, 1.0);
        for (row, &now) in self.lagged.iter_mut().zip(z) {
            for (entry, &before) in row.iter_mut().zip(&self.last_rows) {
                *entry += now * before;
            }
        }
        self.last = [*signal, a, b, c];
        self.last_rows = *z;
        self.samples += 1;
    }

    /// Sum of squares of the rows along a unit vector.
    #[must_use]
    pub fn energy_along(&self, direction: &[f64; ROWS]) -> f64 {
        dot(direction, &apply(&self.square, direction))
    }

    /// Sum of the products of neighbouring sizes along a unit vector: near the sum of squares where the course is smooth.
    #[must_use]
    pub fn lagged_along(&self, direction: &[f64; ROWS]) -> f64 {
        dot(direction, &apply(&self.lagged, direction))
    }

    /// Whether the rows beside a failure along a unit vector are as rough as noise and what calibration's errors add.
    pub(super) fn is_white_beside(&self, direction: &[f64; ROWS], misfit: &Misfit<'_>) -> bool {
        let all: f64 = (0..ROWS).map(|i| self.lagged[i][i]).sum();
        let beside = all - self.lagged_along(direction);
        let rows = misfit.rows_beside();
        let n = self.samples as f64 * rows as f64;
        rows == 0 || beside < WHITE * sqrt(n) + misfit.allowed_beside(direction)
    }

    /// Sum of squares of a channel's departures from its mean.
    #[must_use]
    pub fn own(&self, limb: usize) -> f64 {
        let n = self.samples as f64;
        self.channels.get(limb).map_or(0.0, |channel| {
            channel.square - channel.sum * channel.sum / n.max(1.0)
        })
    }

    /// Whether a channel shows no more than its noise about some value.
    #[must_use]
    pub fn is_flat(&self, limb: usize) -> bool {
        let n = self.samples as f64;
        self.own(limb) < limit(n, 0.0)
    }

    /// Channels that are.
    #[must_use]
    pub fn flat(&self) -> LimbSet {
        (0..LIMBS)
            .filter(|&limb| self.is_flat(limb))
            .fold(LimbSet::EMPTY, LimbSet::with)
    }

    /// Mean of a channel's signal.
    #[must_use]
    pub fn mean(&self, limb: usize) -> f64 {
        let n = self.samples as f64;
        self.channels
            .get(limb)
            .map_or(0.0, |channel| channel.sum / n.max(1.0))
    }

    /// Whether a channel shows no more than its noise about its zero.
    #[must_use]
    pub fn is_at_zero(&self, limb: usize) -> bool {
        let n = self.samples as f64;
        let zero = self.zero_sd.get(limb).copied().unwrap_or(0.0);
        self.channels
            .get(limb)
            .is_some_and(|channel| channel.square < limit(n, n * zero * zero))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundancy::fault::class::CLASS_OF;
    use crate::redundancy::fault::window::Window;

    #[test]
    fn relations_that_are_left_say_how_much_is_white_beside() {
        const SAMPLES: usize = 100;
        let whole = RowNoise::from_channels(&[1.0; LIMBS]).expect("noise");
        for (gone, left) in [(&[5][..], 1.0), (&[], 2.0)] {
            let gone = LimbSet::from_numbers(gone.iter().copied()).expect("limbs");
            let noise = whole.without(gone);
            let direction = noise.direction(CLASS_OF[8]);
            let beside = [-direction[1], direction[0], 0.0];
            let length = sqrt(dot(&beside, &beside));
            for (times, white) in [(0.95, true), (1.05, false)] {
                let products = times * WHITE * sqrt(left * SAMPLES as f64);
                let size = sqrt(products / (SAMPLES - 1) as f64) / length;
                let mut history = History::default();
                for _ in 0..SAMPLES {
                    history.push(&noise, &beside.map(|x| size * x), &[0.0; LIMBS]);
                }
                let window = Window::default();
                let misfit = Misfit::new(&noise, &window, None);
                assert_eq!(
                    history.is_white_beside(direction, &misfit),
                    white,
                    "{left} relations, {times}"
                );
            }
        }
        // Where one relation is left there is nothing beside, and no rounding of it either.
        let noise = whole.without(LimbSet::from_numbers([5, 9]).expect("limbs"));
        let mut history = History::default();
        history.push(&noise, &[1.0, 1.0, 0.0], &[0.0; LIMBS]);
        history.push(&noise, &[1.0, 1e9, 0.0], &[0.0; LIMBS]);
        let window = Window::default();
        let misfit = Misfit::new(&noise, &window, None);
        assert!(history.is_white_beside(&[1.0, 0.0, 0.0], &misfit));
    }
}
