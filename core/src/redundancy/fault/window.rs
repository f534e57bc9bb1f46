//! A stretch of whitened rows, and what calibration's errors make of the strains in it.

use super::calibration_errors::CalibrationErrors;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::redundancy::parity::ROWS;

/// What slope and rest have of a walk over n samples, over the variance of one step and n squared: of a Brownian motion 1/10, and of the 1/6 that it
/// departs from its mean by what the slope leaves.
const OF_WALK: [f64; 2] = [1.0 / 10.0, 1.0 / 15.0];

/// What a quantity of three rows is made of in a stretch: its mean, its slope, and the energy of the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parts<T> {
    pub mean: T,
    pub slope: T,
    pub rest: T,
}

/// Sums over one stretch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Window {
    pub rows: Moments,
    strain: [f64; LIMBS],
    strain_ramp: [f64; LIMBS],
    strain_square: [f64; LIMBS],
}

impl Window {
    /// Of some samples: whitened rows and strains. By itself, its loops would be laid out for any number of them.
    #[inline(always)]
    pub fn of(samples: &[([f64; ROWS], [f64; LIMBS])]) -> Self {
        let mut window = Self::default();
        for (z, _) in samples {
            window.rows.push(z);
        }
        // Limb by limb, which keeps the sums in registers.
        for limb in 0..LIMBS {
            let (mut place, mut sum, mut ramp, mut square) = (0.0, 0.0, 0.0, 0.0);
            for (_, strain) in samples {
                let x = strain[limb];
                sum += x;
                ramp += place * x;
                square += x * x;
                place += 1.0;
            }
            window.strain[limb] = sum;
            window.strain_ramp[limb] = ramp;
            window.strain_square[limb] = square;
        }
        window
    }

    /// Takes a sample: whitened rows and strains.
    #[inline]
    pub fn push(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) {
        let place = self.rows.samples() as f64;
        self.rows.push(z);
        for (i, &x) in strain.iter().enumerate() {
            self.strain[i] += x;
            self.strain_ramp[i] += place * x;
            self.strain_square[i] += x * x;
        }
    }

    /// Takes a later stretch, which follows upon this one.
    pub fn append(&mut self, later: &Self) {
        let place = self.rows.samples() as f64;
        self.rows.append(&later.rows);
        for i in 0..LIMBS {
            self.strain_ramp[i] += later.strain_ramp[i] + place * later.strain[i];
            self.strain[i] += later.strain[i];
            self.strain_square[i] += later.strain_square[i];
        }
    }

    /// Covariances that calibration's errors add, in whitened units: to the coefficients of mean and slope, and to the sum of squares
    /// of the rest.
    pub fn errors(
        &self,
        noise: &RowNoise,
        errors: &CalibrationErrors,
    ) -> Parts<[[f64; ROWS]; ROWS]> {
        let n = self.rows.samples() as f64;
        let spread = sqrt(n * (n * n - 1.0) / 12.0);
        let over = |x: f64, by: f64| if by > 0.0 { x / by } else { 0.0 };
        let mean = self.strain.map(|sum| over(sum, sqrt(n)));
        let slope = core::array::from_fn(|limb| {
            let ramp = self.strain_ramp[limb] - 0.5 * (n - 1.0) * self.strain[limb];
            over(ramp, spread)
        });
        let rest: [f64; LIMBS] = core::array::from_fn(|i| {
            (self.strain_square[i] - mean[i] * mean[i] - slope[i] * slope[i]).max(0.0)
        });
        let drift = errors.drift.map(|sd| n * sd * sd);
        let [walk, ramp] = errors.drift_steps;
        let shown = |square: [f64; LIMBS]| {
            let all: f64 = square.iter().sum();
            square.map(|own| errors.cross_talk * errors.cross_talk * (all - own))
        };
        let along = |x: &[f64; LIMBS], further: [f64; LIMBS]| {
            let shown = shown(x.map(|x| x * x));
            noise.whitened_errors(
                |i, j| x[i] * errors.strain[i][j] * x[j],
                &core::array::from_fn(|i| shown[i] + further[i]),
            )
        };
        let crossed = shown(rest);
        let rest = core::array::from_fn(|i| {
            rest[i] * errors.alone[i] * errors.alone[i] + crossed[i] + n * n * OF_WALK[1] * walk[i]
        });
        Parts {
            mean: along(&mean, drift),
            slope: along(
                &slope,
                core::array::from_fn(|i| spread * spread * ramp[i] + n * n * OF_WALK[0] * walk[i]),
            ),
            rest: noise.whitened_sum(&rest),
        }
    }

    /// Sums of squares along a unit vector.
    pub fn along(&self, direction: &[f64; ROWS]) -> Parts<f64> {
        let [mean, slope] = self.rows.mean_and_slope();
        let square = |v: &[f64; ROWS]| {
            let along = dot(v, direction);
            along * along
        };
        let (mean, slope) = (square(&mean), square(&slope));
        Parts {
            mean,
            slope,
            rest: self.rows.energy_along(direction) - mean - slope,
        }
    }

    /// What of the rows is across a unit vector while the same is along it: squares of mean and slope, and of the sum of products of the rest.
    pub fn turned_from(&self, direction: &[f64; ROWS]) -> Parts<f64> {
        let [mean, slope] = self.rows.mean_and_slope();
        let [along_mean, along_slope] = [dot(&mean, direction), dot(&slope, direction)];
        let products = self.rows.products(direction);
        let rest: [f64; ROWS] =
            core::array::from_fn(|i| products[i] - along_mean * mean[i] - along_slope * slope[i]);
        let across = |v: &[f64; ROWS]| {
            let along = dot(v, direction);
            (dot(v, v) - along * along).max(0.0)
        };
        Parts {
            mean: across(&mean),
            slope: across(&slope),
            rest: across(&rest),
        }
    }

    /// Sums of squares in all rows.
    pub fn all(&self) -> Parts<f64> {
        let [mean, slope] = self.rows.mean_and_slope();
        let (mean, slope) = (dot(&mean, &mean), dot(&slope, &slope));
        Parts {
            mean,
            slope,
            rest: self.rows.energy() - mean - slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_appended_is_a_stretch_continued() {
        let at = |k: u32| {
            let t = f64::from(k);
            (
                [t, 1.0 - t * t, (0.7 * t).sin()],
                core::array::from_fn(|i| 1e-6 * (t + i as f64).cos()),
            )
        };
        let (mut whole, mut first, mut second) =
            (Window::default(), Window::default(), Window::default());
        for k in 0..24 {
            let (z, strain) = at(k);
            whole.push(&z, &strain);
            let half = if k < 8 { &mut first } else { &mut second };
            half.push(&z, &strain);
        }
        let samples: [_; 8] = core::array::from_fn(|k| at(k as u32));
        assert_eq!(Window::of(&samples), first);
        first.append(&second);
        let noise = RowNoise::from_channels(&[1e-8; LIMBS]).expect("noise");
        let errors = CalibrationErrors::independent([1e-3; LIMBS], [1e-9; LIMBS]);
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-11, "{a} {b}");
        for (a, b) in [
            (first.all(), whole.all()),
            (first.along(&[0.0, 1.0, 0.0]), whole.along(&[0.0, 1.0, 0.0])),
        ] {
            close(a.mean, b.mean);
            close(a.slope, b.slope);
            close(a.rest, b.rest);
        }
        let (a, b) = (first.errors(&noise, &errors), whole.errors(&noise, &errors));
        for (a, b) in [(a.mean, b.mean), (a.slope, b.slope), (a.rest, b.rest)] {
            close(a[0][0], b[0][0]);
        }
    }
}
