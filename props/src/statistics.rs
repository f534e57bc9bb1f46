//! Noise, and gates for it: how far a sum of squares may stray before it is not chance.

use glam::DVec3;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::significance::chi_square_limit;
use statrs::function::beta::inv_beta_reg;

/// Three independent numbers of unit variance.
pub fn normal(rng: &mut Pcg64) -> DVec3 {
    DVec3::from_array(core::array::from_fn(|_| StandardNormal.sample(rng)))
}

/// One false alarm in a million, two-sided: the normal quantile of 1 - 5e-7.
pub const ONE_IN_A_MILLION: f64 = 4.8916;

/// Interval that a chi-square variable stays in with the probability that belongs to the normal quantile `z`, by Wilson
/// and Hilferty's cube root: good to a per cent of the interval's width from ten degrees of freedom.
fn chi_square_interval(degrees_of_freedom: usize, z: f64) -> (f64, f64) {
    let n = degrees_of_freedom as f64;
    let spread = (2.0 / (9.0 * n)).sqrt();
    let bound = |z: f64| n * (1.0 - 2.0 / (9.0 * n) + z * spread).powi(3);
    (bound(-z), bound(z))
}

/// Distance of a chi-square variable from the middle of its interval, in half widths: at most 1 unless it is not one.
pub fn chi_square_departure(value: f64, degrees_of_freedom: usize) -> f64 {
    let (low, high) = chi_square_interval(degrees_of_freedom, ONE_IN_A_MILLION);
    (value - 0.5 * (low + high)).abs() / (0.5 * (high - low))
}

/// Ends of the exact two-sided interval, of the given confidence, for the mean of a Poisson variable of which `count` was seen
/// (Garwood): halves of chi-square quantiles with twice the count, and two more above, degrees of freedom.
///
/// # Panics
/// For a confidence that is not between 0 and 1.
pub fn poisson_interval(count: u64, confidence: f64) -> [f64; 2] {
    let beyond = 0.5 * (1.0 - confidence);
    let half = |tail: f64, freedom: u64| {
        0.5 * chi_square_limit(tail, freedom as usize).expect("a probability")
    };
    let low = match count {
        0 => 0.0,
        _ => half(1.0 - beyond, 2 * count),
    };
    [low, half(beyond, 2 * count + 2)]
}

/// The least share of which so many of so many may be seen, but for a chance of one in a million: the lower end of Clopper and
/// Pearson's interval, a quantile of the beta distribution B(k, n - k + 1).
pub fn least_share(count: usize, of: usize) -> f64 {
    if count == 0 {
        return 0.0;
    }
    inv_beta_reg(count as f64, (of - count + 1) as f64, 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_least_share_has_the_chance_that_it_says() {
        // All of n at least: p^n is the chance.
        assert!((least_share(108, 108).powi(108) - 1e-6).abs() < 1e-12);
        // One of n at least: 1 - (1 - p)^n.
        let p = least_share(1, 72);
        assert!((1.0 - (1.0 - p).powi(72) - 1e-6).abs() < 1e-12);
        assert!(least_share(0, 72) == 0.0);
    }

    #[test]
    fn poisson_intervals_are_those_of_the_tables() {
        // Garwood 1936: 95 % of 0, 1 and 10.
        for (count, low, high) in [(0, 0.0, 3.6889), (1, 0.0253, 5.5716), (10, 4.7954, 18.3904)] {
            let [l, h] = poisson_interval(count, 0.95);
            let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
            assert!(near(l, low) && near(h, high), "{count}: {l} {h}");
        }
    }
}
