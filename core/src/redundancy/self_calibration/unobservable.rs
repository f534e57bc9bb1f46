//! What a poor motion leaves open, in words.

use core::fmt;

use nalgebra::{SMatrix, SVector};

use super::RATIOS;
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// Share of a direction that must lie in what is open to be called so.
const LIES_IN: f64 = 0.9;
/// Weight over the largest of a direction below which a limb is not named.
const NAMED: f64 = 0.25;

/// Changes of nine ln scale factors of which a motion says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnobservableDirections {
    /// Limbs that grow and limbs that shrink.
    pairs: [(LimbSet, LimbSet); RATIOS],
    count: usize,
}

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
                if open.count < size && within.norm_squared() > LIES_IN {
                    open.add(LimbSet::EMPTY.with(i), LimbSet::EMPTY.with(j));
                    deflate(&mut projector, &within);
                }
            }
        }
        // What is left has more limbs to it: the direction on which the heaviest limb weighs most, then the next.
        while open.count < size {
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

    fn add(&mut self, up: LimbSet, down: LimbSet) {
        if let Some(place) = self.pairs.get_mut(self.count) {
            *place = (up, down);
            self.count += 1;
        }
    }

    /// For each direction the limbs that grow and the limbs that shrink by it; the latter empty for one limb against all others.
    pub fn pairs(&self) -> impl Iterator<Item = (LimbSet, LimbSet)> {
        self.pairs.into_iter().take(self.count)
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
}

fn deflate(projector: &mut SMatrix<f64, LIMBS, LIMBS>, direction: &SVector<f64, LIMBS>) {
    let unit = direction / sqrt(direction.norm_squared());
    *projector -= unit * unit.transpose();
}

/// "limb 2 against limb 4, limb 3 against limb 7".
impl fmt::Display for UnobservableDirections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let limbs = |set: LimbSet| if set.len() == 1 { "limb" } else { "limbs" };
        for (place, (up, down)) in self.pairs().enumerate() {
            if place > 0 {
                f.write_str(", ")?;
            }
            write!(f, "{} {up} against ", limbs(up))?;
            if down.is_empty() {
                f.write_str("the others")?;
            } else {
                write!(f, "{} {down}", limbs(down))?;
            }
        }
        Ok(())
    }
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
