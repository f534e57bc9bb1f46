//! What a poor motion leaves open, in words.

use nalgebra::{SMatrix, SVector};

use super::RATIOS;
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::unobservable::UnobservableDirections;

/// Share of a direction that must lie in what is open to be called so.
const LIES_IN: f64 = 0.9;
/// Weight over the largest of a direction below which a limb is not named.
const NAMED: f64 = 0.25;

impl UnobservableDirections {
    /// In the plainest words for the space that some orthonormal directions span: one limb against another where that is it.
    pub(super) fn of(directions: impl Iterator<Item = SVector<f64, LIMBS>>) -> Self {
        let mut space = [SVector::<f64, LIMBS>::zeros(); RATIOS];
        let mut size = 0;
        for (place, direction) in space.iter_mut().zip(directions) {
            *place = direction;
            size += 1;
        }
        let mut projector = space
            .iter()
            .fold(SMatrix::<f64, LIMBS, LIMBS>::zeros(), |sum, v| {
                sum + v * v.transpose()
            });
        let mut open = Self::default();
        for i in 0..LIMBS {
            for j in i + 1..LIMBS {
                let mut pair = SVector::<f64, LIMBS>::zeros();
                pair[i] = core::f64::consts::FRAC_1_SQRT_2;
                pair[j] = -pair[i];
                let within = projector * pair;
                if open.len() < size && within.norm_squared() > LIES_IN {
                    open.add(LimbSet::EMPTY.with(i), LimbSet::EMPTY.with(j));
                    deflate(&mut projector, &within);
                }
            }
        }
        // What is left has more limbs to it: the direction on which the heaviest limb weighs most, then the next.
        while open.len() < size {
            let heaviest = (0..LIMBS).fold(0, |best, i| {
                if projector[(i, i)] > projector[(best, best)] {
                    i
                } else {
                    best
                }
            });
            let direction: SVector<f64, LIMBS> = projector.column(heaviest).into();
            let largest = direction.amax();
            if largest.is_nan() || largest <= 0.0 {
                break;
            }
            let side = |sign: f64| {
                (0..LIMBS)
                    .filter(|&i| sign * direction[i] > NAMED * largest)
                    .fold(LimbSet::EMPTY, LimbSet::with)
            };
            open.add(side(1.0), side(-1.0));
            deflate(&mut projector, &direction);
        }
        open
    }
}

fn deflate(projector: &mut SMatrix<f64, LIMBS, LIMBS>, direction: &SVector<f64, LIMBS>) {
    let unit = direction / sqrt(direction.norm_squared());
    *projector -= unit * unit.transpose();
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;

    use super::*;

    fn unit(weights: [f64; LIMBS]) -> SVector<f64, LIMBS> {
        SVector::from(weights).normalize()
    }

    #[test]
    fn directions_are_named() {
        // Two pairs, mixed, and one limb against all others.
        let a = unit([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let b = unit([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0]);
        let c = unit([-1.0, -1.0, -1.0, -1.0, 8.0, -1.0, -1.0, -1.0, -1.0]);
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let open = UnobservableDirections::of([(a + b) * half, c, (a - b) * half].into_iter());
        assert_eq!(
            format!("{open}"),
            "limb 2 against limb 4, limb 3 against limb 7, limb 5 against the others"
        );
        assert_eq!(open.len(), 3);
    }
}
