//! The chi-square distribution to its tail: survival by the incomplete gamma function, quantiles by Newton's method.

use crate::scalar::{exp, ln};

/// Terms of the series and of the continued fraction; both settle in a few times the root of the degrees of freedom.
const TERMS: usize = 2000;
/// Newton steps; convergence is monotone and quadratic.
const STEPS: usize = 100;

/// Probability that a chi-square variable of `freedom` degrees of freedom exceeds `value`.
///
/// Relative error below 1e-12 for up to some hundred degrees of freedom; 1 for what is not positive.
#[must_use]
pub fn survival(value: f64, freedom: u32) -> f64 {
    let positive = value > 0.0;
    if !positive {
        return 1.0;
    }
    let (a, x) = (0.5 * f64::from(freedom), 0.5 * value);
    if x < a + 1.0 {
        // P = x^a e^-x / gamma(a + 1) (1 + x/(a + 1) + ...).
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..TERMS {
            term *= x / (a + k as f64);
            sum += term;
            if term < f64::EPSILON * sum {
                break;
            }
        }
        1.0 - sum * exp(a * ln(x) - x - ln_gamma_half(freedom + 2))
    } else {
        // Q = x^a e^-x / gamma(a) over x + 1 - a - 1 (1 - a)/(x + 3 - a - ...), from the front (Lentz).
        let mut b = x + 1.0 - a;
        let mut c = f64::MAX;
        let mut d = 1.0 / b;
        let mut fraction = d;
        for k in 1..TERMS {
            let k = k as f64;
            let numerator = -k * (k - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            fraction *= d * c;
            if (d * c - 1.0).abs() < f64::EPSILON {
                break;
            }
        }
        fraction * exp(a * ln(x) - x - ln_gamma_half(freedom))
    }
}

/// What a chi-square variable of `freedom` (at least 2) degrees of freedom exceeds with the given probability, in (0, 1).
///
/// The logarithm of the survival is concave from two degrees of freedom on, so Newton's method on it comes from above after
/// one step, whatever it begins with.
#[must_use]
pub fn quantile(exceedance: f64, freedom: u32) -> f64 {
    let half = 0.5 * f64::from(freedom);
    let mut value = f64::from(freedom);
    for _ in 0..STEPS {
        let left = survival(value, freedom);
        let density =
            0.5 * exp((half - 1.0) * ln(0.5 * value) - 0.5 * value - ln_gamma_half(freedom));
        let step = left * ln(left / exceedance) / density;
        // Far below the median the first step may fall short of zero: halve instead.
        let next = if value + step > 0.0 {
            value + step
        } else {
            0.5 * value
        };
        if (next - value).abs() <= 4.0 * f64::EPSILON * value {
            return next;
        }
        value = next;
    }
    value
}

/// ln gamma(n/2) by its recurrence, from gamma(1/2) or gamma(1).
fn ln_gamma_half(n: u32) -> f64 {
    let mut sum = if n.is_multiple_of(2) {
        0.0
    } else {
        0.5 * ln(core::f64::consts::PI)
    };
    let mut below = if n.is_multiple_of(2) { 2 } else { 1 };
    while below < n {
        sum += ln(0.5 * f64::from(below));
        below += 2;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Value, degrees of freedom, survival to 16 digits (mpmath, regularised upper incomplete gamma at 30 digits).
    const KNOWN: [(f64, u32, f64); 7] = [
        (0.5, 3, 0.91889141165467586),
        (2.3, 3, 0.51252090697714559),
        (16.25, 3, 0.0010077006085612759),
        (45.0, 3, 9.2527021045372786e-10),
        (100.0, 186, 0.99999996448347527),
        (186.0, 186, 0.4862097336020194),
        (300.0, 186, 2.3082453799017283e-7),
    ];

    #[test]
    fn survival_to_its_tail() {
        for (value, freedom, expected) in KNOWN {
            let ours = survival(value, freedom);
            assert!(
                (ours / expected - 1.0).abs() < 1e-11,
                "{value} {freedom}: {ours:e} {expected:e}"
            );
        }
    }

    #[test]
    fn quantile_is_the_inverse() {
        for freedom in [2, 3, 6, 186, 1530] {
            for exceedance in [0.9, 0.5, 1e-2, 1e-6, 1e-12] {
                let back = survival(quantile(exceedance, freedom), freedom);
                assert!(
                    (back / exceedance - 1.0).abs() < 1e-9,
                    "{freedom} {exceedance}: {back:e}"
                );
            }
        }
    }
}
