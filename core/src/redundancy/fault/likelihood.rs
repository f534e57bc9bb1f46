//! The likelihood of a failure of each class of limbs, given the whitened rows of a stretch.
//!
//! A failure of class c of whatever course e_t leaves z_t = l_c d_c e_t + noise, d_c the unit vector of [`RowNoise::direction`].
//! Its course is split into constant, ramp and the rest over the stretch at hand, each a coefficient or coefficients of unknown
//! variance; maximised over that variance, n coefficients of energy P along d_c give the class
//!
//! ```text
//! n/2 (P/n - 1 - ln(P/n))    if P > n, else 0,
//! ```
//!
//! the logarithm of a likelihood ratio against no failure. A constant failure far below a sample's noise is thus recognised by its
//! mean. Differences of these logarithms are ln of odds.

use super::class::CLASSES;
use super::moments::Moments;
use super::noise::{RowNoise, dot};
use crate::float::ln;
use crate::redundancy::parity::ROWS;

/// ln of the likelihood ratio of each class against no failure, over one stretch.
#[must_use]
pub fn likelihood(noise: &RowNoise, rows: &Moments) -> [f64; CLASSES] {
    core::array::from_fn(|class| likelihood_along(noise.direction(class), rows))
}

/// The same of whatever shows along a unit vector.
pub(super) fn likelihood_along(direction: &[f64; ROWS], rows: &Moments) -> f64 {
    let n = rows.samples() as f64;
    if n == 0.0 {
        return 0.0;
    }
    let [mean, slope] = rows.mean_and_slope();
    let constant = dot(direction, &mean);
    let ramp = dot(direction, &slope);
    let (constant, ramp) = (constant * constant, ramp * ramp);
    let rest = rows.energy_along(direction) - constant - ramp;
    gain(constant, 1.0) + gain(ramp, (n - 1.0).min(1.0)) + gain(rest, (n - 2.0).max(0.0))
}

/// The maximum over the variance, at least that of noise, of the likelihood of n coefficients of energy `p`.
pub(super) fn gain(p: f64, n: f64) -> f64 {
    if n > 0.0 && p > n {
        0.5 * (p - n - n * ln(p / n))
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::LIMBS;

    #[test]
    fn a_constant_failure_below_noise_is_found_by_its_mean() {
        let noise = RowNoise::from_channels(&[1.0; LIMBS]).expect("noise");
        for class in 0..CLASSES {
            let mut rows = Moments::default();
            for sample in 0..400 {
                // Half a unit along the class, and as much to and fro across all three rows.
                let to_and_fro = if sample % 2 == 0 { 0.5 } else { -0.5 };
                rows.push(&noise.direction(class).map(|d| 0.5 * d + to_and_fro));
            }
            let scores = likelihood(&noise, &rows);
            for (other, score) in scores.iter().enumerate() {
                assert!(
                    other == class || scores[class] > score + 5.0,
                    "{class}: {scores:?}"
                );
            }
        }
    }
}
