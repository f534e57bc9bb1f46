//! Noise, and gates for it: how far a sum of squares may stray before it is not chance.

use glam::DVec3;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Three independent numbers of unit variance.
pub fn normal(rng: &mut Pcg64) -> DVec3 {
    DVec3::from_array(core::array::from_fn(|_| StandardNormal.sample(rng)))
}

/// One false alarm in a million, two-sided: the normal quantile of 1 - 5e-7.
pub const ONE_IN_A_MILLION: f64 = 4.8916;

/// Interval that a chi-square variable stays in with the probability that belongs to the normal quantile `z`, by Wilson
/// and Hilferty's cube root: good to a per cent of the interval's width from ten degrees of freedom.
#[must_use]
fn chi_square_interval(degrees_of_freedom: usize, z: f64) -> (f64, f64) {
    let n = degrees_of_freedom as f64;
    let spread = (2.0 / (9.0 * n)).sqrt();
    let bound = |z: f64| n * (1.0 - 2.0 / (9.0 * n) + z * spread).powi(3);
    (bound(-z), bound(z))
}

/// Distance of a chi-square variable from the middle of its interval, in half widths: at most 1 unless it is not one.
#[must_use]
pub fn chi_square_departure(value: f64, degrees_of_freedom: usize) -> f64 {
    let (low, high) = chi_square_interval(degrees_of_freedom, ONE_IN_A_MILLION);
    (value - 0.5 * (low + high)).abs() / (0.5 * (high - low))
}
