//! The parity rows of a healthy sensor: noise of covariance Q = W^T diag(sigma^2) W, and the relations that excluded limbs leave.
//!
//! A limb of unknown course spoils one direction of the whitened rows, that of its signature. What is orthogonal to it is free of the
//! limb and still white: eight limbs leave two relations, seven one, six none. [`RowNoise::without`] turns the rows so that the
//! relations that are left come first and the others are zero; whatever works on three rows then works on those.

use super::class::{CLASSES, signature};
use crate::error::{Error, Result, require};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::{ROWS, SIGNATURES};

/// Noise of nine channels as the three rows show it.
///
/// With L L^T = Q the whitened rows z = L^-1 rho of a healthy sensor are three independent standard normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowNoise {
    channel: [f64; LIMBS],
    relations: usize,
    whitener: [[f64; ROWS]; ROWS],
    direction: [[f64; ROWS]; CLASSES],
    length: [f64; CLASSES],
}

impl RowNoise {
    /// From the standard deviation of one sample of each channel, in strain.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for one that is not positive, or whose square no f64 holds.
    pub fn from_channels(strain_sd: &[f64; LIMBS]) -> Result<Self> {
        for &value in strain_sd {
            require(
                value > 0.0 && (value * value).is_normal(),
                "noise of a channel in strain",
                value,
                "positive and finite, and its square, too",
            )?;
        }
        let covariance = outer_sum(&strain_sd.map(|s| s * s));
        Self::new(*strain_sd, &covariance)
    }

    fn new(channel: [f64; LIMBS], covariance: &[[f64; ROWS]; ROWS]) -> Result<Self> {
        let whitener = inverse_root(covariance).ok_or(Error::out_of_range(
            "covariance of the parity rows",
            covariance[0][0],
            "positive definite",
        ))?;
        Ok(Self::of(channel, ROWS, whitener))
    }

    fn of(channel: [f64; LIMBS], relations: usize, whitener: [[f64; ROWS]; ROWS]) -> Self {
        let mut direction = [[0.0; ROWS]; CLASSES];
        let mut length = [0.0; CLASSES];
        for (class, (direction, length)) in direction.iter_mut().zip(&mut length).enumerate() {
            let along = apply(&whitener, &signature(class).map(f64::from));
            let size = sqrt(dot(&along, &along));
            // A limb that no relation is left of shows by rounding at most.
            if size > ROUNDING * frobenius(&whitener) {
                (*direction, *length) = (along.map(|x| x / size), size);
            }
        }
        Self {
            channel,
            relations,
            whitener,
            direction,
            length,
        }
    }

    /// The relations that are left without some limbs.
    #[must_use]
    pub fn without(&self, limbs: LimbSet) -> Self {
        let (mut whitener, mut relations) = (self.whitener, self.relations);
        let rounding = ROUNDING * frobenius(&whitener);
        for limb in limbs.indices() {
            let along = apply(&whitener, &SIGNATURES[limb].map(f64::from));
            let length = sqrt(dot(&along, &along));
            if length <= rounding || relations == 0 {
                continue;
            }
            relations -= 1;
            // Householder's reflection takes the limb's direction into the last row that is left, which is dropped.
            let mut mirror = along.map(|x| x / length);
            if let Some(last) = mirror.get_mut(relations) {
                *last += if *last < 0.0 { -1.0 } else { 1.0 };
            }
            let square = dot(&mirror, &mirror);
            let across: [f64; ROWS] = core::array::from_fn(|column| {
                2.0 / square * dot(&mirror, &whitener.map(|row| row[column]))
            });
            for (row, &m) in whitener.iter_mut().zip(&mirror) {
                for (entry, &a) in row.iter_mut().zip(&across) {
                    *entry -= m * a;
                }
            }
            if let Some(row) = whitener.get_mut(relations) {
                *row = [0.0; ROWS];
            }
        }
        Self::of(self.channel, relations, whitener)
    }

    /// Number of relations that are left: of a limb and its ambiguous partner, both excluded, there are two.
    #[must_use]
    pub const fn relations(&self) -> usize {
        self.relations
    }

    /// z = L^-1 rho.
    #[inline]
    #[must_use]
    pub fn whiten(&self, rows: &[f64; ROWS]) -> [f64; ROWS] {
        apply(&self.whitener, rows)
    }

    /// Unit vector along which a failure of a class shows in z, zero where it does not show.
    #[must_use]
    pub fn direction(&self, class: usize) -> &[f64; ROWS] {
        // Cannot panic: an index beyond the classes gives the first.
        self.direction.get(class).unwrap_or(&self.direction[0])
    }

    /// Length in z of a failure of unit strain: one over the standard deviation to which one sample determines its size.
    #[must_use]
    pub fn length(&self, class: usize) -> f64 {
        *self.length.get(class).unwrap_or(&self.length[0])
    }

    /// W^T diag(variance) W in whitened units: what further errors of the channels add to the unit matrix.
    #[must_use]
    pub fn whitened_sum(&self, variance: &[f64; LIMBS]) -> [[f64; ROWS]; ROWS] {
        let mut sum = [[0.0; ROWS]; ROWS];
        for limb in 0..LIMBS {
            let along = apply(&self.whitener, &SIGNATURES[limb].map(f64::from));
            add_outer(&mut sum, &along, variance[limb]);
        }
        sum
    }
}

impl RowNoise {
    /// W^T (C + diag(variance)) W in whitened units, C the covariance of errors that the channels share in part.
    pub(super) fn whitened_errors(
        &self,
        covariance: impl Fn(usize, usize) -> f64,
        variance: &[f64; LIMBS],
    ) -> [[f64; ROWS]; ROWS] {
        let mut sum = self.whitened_sum(variance);
        let along = SIGNATURES.map(|signature| apply(&self.whitener, &signature.map(f64::from)));
        for (i, a) in along.iter().enumerate() {
            let mut across = [0.0; ROWS];
            for (j, b) in along.iter().enumerate() {
                let weight = covariance(i, j);
                for (across, b) in across.iter_mut().zip(b) {
                    *across += weight * b;
                }
            }
            for (row, a) in sum.iter_mut().zip(a) {
                for (entry, across) in row.iter_mut().zip(&across) {
                    *entry += a * across;
                }
            }
        }
        sum
    }
}

/// Share of a matrix below which there is but rounding.
const ROUNDING: f64 = 1e-9;

fn frobenius(m: &[[f64; ROWS]; ROWS]) -> f64 {
    sqrt(m.as_flattened().iter().map(|x| x * x).sum())
}

fn outer_sum(variance: &[f64; LIMBS]) -> [[f64; ROWS]; ROWS] {
    let mut sum = [[0.0; ROWS]; ROWS];
    for (signature, &variance) in SIGNATURES.iter().zip(variance) {
        add_outer(&mut sum, &signature.map(f64::from), variance);
    }
    sum
}

/// sum += weight v v^T.
#[inline]
pub(super) fn add_outer(sum: &mut [[f64; ROWS]; ROWS], v: &[f64; ROWS], weight: f64) {
    for (row, &a) in sum.iter_mut().zip(v) {
        for (entry, &b) in row.iter_mut().zip(v) {
            *entry += weight * a * b;
        }
    }
}

#[inline]
pub(super) fn dot(a: &[f64; ROWS], b: &[f64; ROWS]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(super) fn cross(a: &[f64; ROWS], b: &[f64; ROWS]) -> [f64; ROWS] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// v over its length; none for nothing.
pub(super) fn unit(v: &[f64; ROWS]) -> Option<[f64; ROWS]> {
    let length = sqrt(dot(v, v));
    (length > ROUNDING).then(|| v.map(|x| x / length))
}

#[inline]
pub(super) fn apply(m: &[[f64; ROWS]; ROWS], v: &[f64; ROWS]) -> [f64; ROWS] {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}

/// L^-1 of the Cholesky factor L; none for a matrix that is not positive definite.
pub(super) fn inverse_root(q: &[[f64; ROWS]; ROWS]) -> Option<[[f64; ROWS]; ROWS]> {
    let l00 = sqrt(q[0][0]);
    let (l10, l20) = (q[1][0] / l00, q[2][0] / l00);
    let l11 = sqrt(q[1][1] - l10 * l10);
    let l21 = (q[2][1] - l20 * l10) / l11;
    let l22 = sqrt(q[2][2] - l20 * l20 - l21 * l21);
    let [a, b, c] = [l00, l11, l22].map(|d| 1.0 / d);
    let inverse = [
        [a, 0.0, 0.0],
        [-l10 * a * b, b, 0.0],
        [(l10 * l21 * b - l20) * a * c, -l21 * b * c, c],
    ];
    let sound = inverse.as_flattened().iter().all(|x| x.is_finite()) && a > 0.0 && b > 0.0;
    (sound && c > 0.0).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundancy::fault::class::CLASS_OF;

    #[test]
    fn whitened_covariance_is_one() {
        let sd = core::array::from_fn(|i| 1e-8 * (1.0 + i as f64));
        let noise = RowNoise::from_channels(&sd).expect("noise");
        let sum = noise.whitened_sum(&sd.map(|s| s * s));
        for (i, row) in sum.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((entry - unit).abs() < 1e-12, "{sum:?}");
            }
        }
    }

    #[test]
    fn relations_without_limbs_are_white_and_free_of_them() {
        let sd = core::array::from_fn(|i| 1e-8 * (1.0 + i as f64));
        let noise = RowNoise::from_channels(&sd).expect("noise");
        for (numbers, left) in [
            (&[5][..], 2),
            (&[2, 4], 2),
            (&[2, 4, 9], 1),
            (&[1, 2, 3], 1),
            (&[1, 5, 9], 0),
        ] {
            let limbs = LimbSet::from_numbers(numbers.iter().copied()).expect("limbs");
            let without = noise.without(limbs);
            assert_eq!(without.relations(), left);
            // One limb after another is the same as all at once.
            let one_by_one = limbs.indices().fold(noise, |noise, limb| {
                noise.without(LimbSet::EMPTY.with(limb))
            });
            assert_eq!(one_by_one, without);
            for limb in limbs.indices() {
                assert_eq!(without.length(CLASS_OF[limb]), 0.0, "{limbs}");
            }
            let sum = without.whitened_sum(&sd.map(|s| s * s));
            for (i, row) in sum.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    let unit = if i == j && i < left { 1.0 } else { 0.0 };
                    assert!((entry - unit).abs() < 1e-12, "{limbs}: {sum:?}");
                }
            }
        }
    }

    #[test]
    fn equal_noise_shows_a_failure_by_half_to_two_thirds_of_its_size() {
        let noise = RowNoise::from_channels(&[1.0; LIMBS]).expect("noise");
        for class in 0..CLASSES {
            let expected = if class < 3 { 8.0 / 18.0 } else { 5.0 / 18.0 };
            assert!((noise.length(class) - sqrt(expected)).abs() < 1e-12);
        }
        assert!(RowNoise::from_channels(&[0.0; LIMBS]).is_err());
        assert!(RowNoise::from_channels(&[f64::NAN; LIMBS]).is_err());
    }
}
