//! Running sums over a stretch of whitened rows: mean, slope and the energy of the rest, along any direction.

use super::noise::{add_outer, apply, dot};
use crate::float::sqrt;
use crate::redundancy::parity::ROWS;

/// Sums over a stretch of samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    samples: u64,
    sum: [f64; ROWS],
    /// Sum of z times its place in the stretch.
    ramp: [f64; ROWS],
    square: [[f64; ROWS]; ROWS],
}

impl Moments {
    /// Takes a sample.
    #[inline]
    pub fn push(&mut self, z: &[f64; ROWS]) {
        let place = self.samples as f64;
        self.samples += 1;
        for ((sum, ramp), &z) in self.sum.iter_mut().zip(&mut self.ramp).zip(z) {
            *sum += z;
            *ramp += place * z;
        }
        add_outer(&mut self.square, z, 1.0);
    }

    /// Takes a later stretch, which follows upon this one.
    #[inline]
    pub fn append(&mut self, later: &Self) {
        let place = self.samples as f64;
        self.samples += later.samples;
        for i in 0..ROWS {
            self.ramp[i] += later.ramp[i] + place * later.sum[i];
            self.sum[i] += later.sum[i];
            for j in 0..ROWS {
                self.square[i][j] += later.square[i][j];
            }
        }
    }

    /// Samples taken.
    #[must_use]
    pub const fn samples(&self) -> u64 {
        self.samples
    }

    /// Coefficients of the constant and of the ramp of unit norm: the mean times the root of the samples, and the slope
    /// likewise. For noise they are independent and distributed as a sample.
    #[must_use]
    pub fn mean_and_slope(&self) -> [[f64; ROWS]; 2] {
        let n = self.samples as f64;
        let (root, spread) = (sqrt(n), sqrt(n * (n * n - 1.0) / 12.0));
        let middle = 0.5 * (n - 1.0);
        let mean = self.sum.map(|s| if n > 0.0 { s / root } else { 0.0 });
        let slope = core::array::from_fn(|i| {
            if spread > 0.0 {
                (self.ramp[i] - middle * self.sum[i]) / spread
            } else {
                0.0
            }
        });
        [mean, slope]
    }

    /// Square of the coefficients of the constant.
    #[inline]
    #[must_use]
    pub fn energy_of_mean(&self) -> f64 {
        let n = self.samples as f64;
        if n > 0.0 {
            dot(&self.sum, &self.sum) / n
        } else {
            0.0
        }
    }

    /// Sum of squares.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.square[0][0] + self.square[1][1] + self.square[2][2]
    }

    /// Sum of squares along a unit vector.
    #[must_use]
    pub fn energy_along(&self, direction: &[f64; ROWS]) -> f64 {
        dot(direction, &self.products(direction))
    }

    /// Sums of the products of each row with the component along a unit vector.
    #[must_use]
    pub fn products(&self, direction: &[f64; ROWS]) -> [f64; ROWS] {
        apply(&self.square, direction)
    }
}
