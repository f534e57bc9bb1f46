//! Ratios of the nine scale factors without a reference, from any motion that excites all limbs.
//!
//! Limbs of equal stiffness on one undeformed mass obey the coordination equations of [`crate::redundancy::parity`] at every instant,
//! whatever the motion, the mass and its inertia. Written with the voltages, W^T C (u - d) = second order, they are three
//! equations linear in nine sensitivities c_i: a motion that excites all of them determines c_1 : c_2 : ... : c_9, eight numbers. The
//! ninth, a common factor, needs one known acceleration.
//!
//! | file | holds |
//! |---|---|
//! | [`moments`] | the recording as a stream: means and products of block means, constant memory |
//! | `noise` | the channels' noise from the rows' residuals |
//! | `fit` | the ratios that make the rows vanish, noise in all nine channels taken into account |
//! | `unobservable` | the combinations of ratios that a poor motion leaves unobservable |
//! | [`ratios`] | the result, its covariance and its tests |
//! | [`drift`] | which limbs have drifted since a calibration |
//! | [`common_scale`] | the common factor |
//! | [`stiffness`] | a test of equal stiffness: ratios from the balance of forces beside those from the rows |
//!
//! # Assumptions
//! The result is c_i/k_i over the calibration's c_i: where the k_i are known from elsewhere (a joint fit), ln(k_i/k) is to be added to
//! its logarithm, and where they are not, unequal ones look like a drift; no residual shows them. *Changes* of c_i from one recording to
//! another need only stiffnesses that have not changed: they do not depend on equal stiffness except at second order.
//! Zero drifts need not be known, but must be constant; the noise must be white above the length of a block.

pub mod common_scale;
pub mod drift;
mod fit;
pub mod moments;
mod noise;
pub mod ratios;
pub mod stiffness;
mod unobservable;

pub use common_scale::{KnownChange, Scales};
pub use drift::{Drifted, drifted};
pub use moments::{Accumulator, Moments};
pub use ratios::{Limits, ScaleRatios};
pub use stiffness::StiffnessTest;

use nalgebra::SMatrix;

use crate::geometry::LIMBS;

/// Ratios of nine scale factors.
pub const RATIOS: usize = LIMBS - 1;

/// A matrix over nine limbs.
pub type PerLimbs = SMatrix<f64, LIMBS, LIMBS>;

/// Eight orthonormal columns whose entries add up to zero: what is left of nine logarithms without a common one.
fn contrasts() -> SMatrix<f64, LIMBS, RATIOS> {
    SMatrix::from_fn(|i, j| {
        let n = (j + 1) as f64;
        let size = 1.0 / crate::float::sqrt(n * (n + 1.0));
        match i {
            i if i <= j => size,
            i if i == j + 1 => -n * size,
            _ => 0.0,
        }
    })
}

/// The inverse of a covariance of nine logarithms, their common one taken for unknown. None where it has none.
fn information_without_common(covariance: &PerLimbs) -> Option<PerLimbs> {
    let basis = contrasts();
    let inner = (basis.transpose() * covariance * basis).cholesky()?;
    Some(basis * inner.inverse() * basis.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contrasts_are_orthonormal_and_without_a_mean() {
        let basis = contrasts();
        let ones = SMatrix::<f64, 1, LIMBS>::repeat(1.0);
        let gram = basis.transpose() * basis - SMatrix::<f64, RATIOS, RATIOS>::identity();
        assert!(gram.amax() < 4.0 * f64::EPSILON && (ones * basis).amax() < 4.0 * f64::EPSILON);
    }
}
