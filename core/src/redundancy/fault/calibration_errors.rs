//! The errors that calibration leaves, as the tests allow for them.

use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::redundancy::parity::{GRAM_DENOMINATOR, GRAM_INVERSE, ROWS, SIGNATURES};

/// The errors that calibration leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationErrors {
    /// Covariance of the limbs' relative errors of strain per volt.
    pub strain: [[f64; LIMBS]; LIMBS],
    /// Standard deviations of independent errors that add as much to an energy.
    pub alone: [f64; LIMBS],
    /// Standard deviation of the share of another limb's strain that a channel shows.
    pub cross_talk: f64,
    /// Standard deviation of each zero drift, strain.
    pub drift: [f64; LIMBS],
    /// Variances of what each zero changes by from sample to sample, strain^2: as a walk, and as a ramp.
    pub drift_steps: [[f64; LIMBS]; 2],
}

impl CalibrationErrors {
    /// Independent relative errors of strain per volt, and of the zero drifts, strain; standard deviations.
    #[must_use]
    pub fn independent(strain: [f64; LIMBS], drift: [f64; LIMBS]) -> Self {
        Self {
            strain: core::array::from_fn(|i| {
                core::array::from_fn(|j| if i == j { strain[i] * strain[i] } else { 0.0 })
            }),
            alone: strain,
            cross_talk: 0.0,
            drift,
            drift_steps: [[0.0; LIMBS]; 2],
        }
    }
}

/// Standard deviations of independent errors that add as much to the energy of the rows as errors of this covariance, over strains
/// of all motions alike.
pub(super) fn alone(covariance: &[[f64; LIMBS]; LIMBS]) -> [f64; LIMBS] {
    // Strains of unit variance in the six directions that obey the relations have the covariance 1 - W (W^T W)^-1 W^T.
    let shown = |i: usize, j: usize| {
        let (a, b) = (SIGNATURES[i], SIGNATURES[j]);
        let mut across = 0;
        for row in 0..ROWS {
            for column in 0..ROWS {
                across += a[row] * GRAM_INVERSE[row][column] * b[column];
            }
        }
        let own = if i == j { 1.0 } else { 0.0 };
        let strains = own - f64::from(across) / f64::from(GRAM_DENOMINATOR);
        let rows: i32 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        f64::from(rows) * strains * covariance[i][j]
    };
    let diagonal: f64 = (0..LIMBS).map(|i| shown(i, i)).sum();
    let all: f64 = (0..LIMBS)
        .flat_map(|i| (0..LIMBS).map(move |j| (i, j)))
        .map(|(i, j)| shown(i, j))
        .sum();
    let share = if diagonal > 0.0 {
        (all / diagonal).max(0.0)
    } else {
        0.0
    };
    core::array::from_fn(|i| sqrt(share * covariance[i][i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_all_limbs_share_does_not_show() {
        let shared = [[1e-6; LIMBS]; LIMBS];
        assert!(alone(&shared).iter().all(|&sd| sd < 1e-10));
        let own =
            core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1e-6 } else { 0.0 }));
        assert!(alone(&own).iter().all(|&sd| (sd - 1e-3).abs() < 1e-12));
        let both: [[f64; LIMBS]; LIMBS] =
            core::array::from_fn(|i| core::array::from_fn(|j| own[i][j] + 100.0 * shared[i][j]));
        let energy = |sd: [f64; LIMBS]| sd.map(|sd| sd * sd).iter().sum::<f64>();
        assert!((energy(alone(&both)) / energy(alone(&own)) - 1.0).abs() < 1e-9);
    }
}
