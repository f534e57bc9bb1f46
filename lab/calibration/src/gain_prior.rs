//! A number that carries two errors: one normal, one that a certificate bounds.
//!
//! A certificate gives a limit, and within it every value is as likely as any other; whatever the data themselves say of the
//! gain narrows that. A parameter is off by `slope` times the gain plus a normal error; its distribution is the convolution of
//! both, and the 95 % interval is read off that instead of adding squares of things that are no standard deviations.

/// What is known of a standard's relative gain error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundedGain {
    /// The certificate's limit.
    pub limit: f64,
    /// The data's own estimate, and one over its variance; 0 where they do not determine it.
    pub seen: f64,
    /// See [`Self::seen`].
    pub information: f64,
}

/// Standard deviations by which the data must contradict a certificate before they are not believed, and it is said: what else they
/// contain than the accelerometer's gain, nobody knows then, and the certificate alone holds.
pub const BEYOND_CERTIFICATE: f64 = 4.0;
/// A certificate is wrong at times. Where data speak, a gain beyond its limit is this much less likely than one within...
const BEYOND_SHARE: f64 = 0.01;
/// ... up to so many limits: with a prior that ended at the limit, data that lie three deviations beyond it, which is not enough to disbelieve it,
/// gave the narrowest of intervals.
const BEYOND_REACH: f64 = 4.0;
/// Nodes of the quadrature over the gain. The integrand is smooth on the scale of its width over this many nodes.
const NODES: usize = 256;
/// Standard deviations of the data's word beyond which there is nothing to integrate.
const REACH: f64 = 8.0;
/// Halvings of the bracket of a quantile: to 2^-40 of it.
const HALVINGS: usize = 40;

impl BoundedGain {
    /// Gains and how likely each is, adding up to 1: an even spread within the limit and a hundredth of it beyond, weighed by the data;
    /// without data the limit.
    fn nodes(&self) -> Vec<(f64, f64)> {
        let (mut low, mut high) = (-self.limit, self.limit);
        let information = self.believed();
        if information > 0.0 {
            let reach = REACH / information.sqrt();
            let end = BEYOND_REACH * self.limit;
            low = (self.seen - reach).clamp(-end, end);
            high = (self.seen + reach).clamp(-end, end);
        }
        let width = (high - low) / NODES as f64;
        let log = |gain: f64| {
            let within = gain.abs() <= self.limit;
            let prior = if within { 0.0 } else { BEYOND_SHARE.ln() };
            prior - 0.5 * information * (gain - self.seen).powi(2)
        };
        let best = log(self.seen.clamp(-self.limit, self.limit));
        let mut nodes: Vec<(f64, f64)> = (0..NODES)
            .map(|i| {
                let gain = low + width * (i as f64 + 0.5);
                (gain, (log(gain) - best).exp())
            })
            .collect();
        let sum: f64 = nodes.iter().map(|n| n.1).sum();
        nodes.iter_mut().for_each(|n| n.1 /= sum);
        nodes
    }

    /// Its mean.
    pub fn mean(&self) -> f64 {
        self.nodes().iter().map(|(gain, share)| gain * share).sum()
    }

    /// Its standard deviation.
    pub fn deviation(&self) -> f64 {
        let mean = self.mean();
        self.nodes()
            .iter()
            .map(|(gain, share)| share * (gain - mean).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// Information of the data that is used.
    fn believed(&self) -> f64 {
        if self.is_beyond_certificate() {
            0.0
        } else {
            self.information
        }
    }

    /// Whether the data contradict the certificate.
    pub fn is_beyond_certificate(&self) -> bool {
        self.contradiction() > BEYOND_CERTIFICATE
    }

    /// Standard deviations by which the data contradict the certificate; 0 where the one allows what the other says.
    pub fn contradiction(&self) -> f64 {
        (self.seen.abs() - self.limit).max(0.0) * self.information.sqrt()
    }

    /// Ends of the 95 % intervals of quantities that take `values` at a gain and have normal errors with the given deviations
    /// beside.
    pub fn intervals_95<const N: usize>(
        &self,
        values: impl Fn(f64) -> [f64; N],
        deviations: &[f64; N],
    ) -> [(f64, f64); N] {
        let (shares, at): (Vec<f64>, Vec<[f64; N]>) = self
            .nodes()
            .into_iter()
            .map(|(gain, share)| (share, values(gain)))
            .unzip();
        core::array::from_fn(|p| {
            // A deviation of nothing is a step, not a quotient of nothing by nothing.
            let deviation = deviations[p].max(f64::MIN_POSITIVE.sqrt());
            let below = |x: f64| -> f64 {
                shares
                    .iter()
                    .zip(&at)
                    .map(|(share, centre)| share * normal_below((x - centre[p]) / deviation))
                    .sum()
            };
            let lowest = at.iter().fold(f64::INFINITY, |a, v| a.min(v[p]));
            let highest = at.iter().fold(f64::NEG_INFINITY, |a, v| a.max(v[p]));
            let quantile = |share: f64| {
                let (mut low, mut high) = (lowest - REACH * deviation, highest + REACH * deviation);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if below(middle) < share {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                0.5 * (low + high)
            };
            (quantile(0.025), quantile(0.975))
        })
    }
}

/// Probability that a standard normal variable is below `x`.
fn normal_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * core::f64::consts::FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use sixaxis_core::significance::NORMAL_95;

    use super::*;

    /// The quadrature's midpoints leave a 256th of the spread's ends.
    const QUADRATURE: f64 = 5e-3;

    #[test]
    fn inv_no_slope_is_normal() {
        let gain = BoundedGain {
            limit: 0.01,
            seen: 0.0,
            information: 0.0,
        };
        let [(low, high)] = gain.intervals_95(|_| [0.0], &[2.0]);
        assert!((high - 2.0 * NORMAL_95).abs() < 1e-9);
        assert!((low + 2.0 * NORMAL_95).abs() < 1e-9);
    }

    #[test]
    fn inv_no_noise_is_the_certificate() {
        let gain = BoundedGain {
            limit: 0.01,
            seen: 0.0,
            information: 0.0,
        };
        let [(_, high)] = gain.intervals_95(|g| [3.0 * g], &[1e-9]);
        assert!((high / (0.95 * 0.03) - 1.0).abs() < QUADRATURE);
    }

    #[test]
    fn inv_data_that_know_better_rule() {
        let gain = BoundedGain {
            limit: 0.01,
            seen: 2e-3,
            information: 1e10,
        };
        assert!((gain.mean() - 2e-3).abs() < 1e-9);
        let [(low, high)] = gain.intervals_95(|g| [g], &[1e-5]);
        let expected = NORMAL_95 * 1e-5 * 2.0_f64.sqrt();
        assert!((high - 2e-3 - expected).abs() < QUADRATURE * expected);
        assert!((low - 2e-3 + expected).abs() < QUADRATURE * expected);
    }

    #[test]
    fn inv_bent_quantities_are_followed() {
        let gain = BoundedGain {
            limit: 0.1,
            seen: 0.0,
            information: 0.0,
        };
        // What goes as 1/(1 + gain): the ends of an even spread go where the function takes them.
        let [(low, high)] = gain.intervals_95(|g| [1.0 / (1.0 + g)], &[1e-9]);
        assert!((low * 1.095 - 1.0).abs() < 1e-3);
        assert!((high * 0.905 - 1.0).abs() < 1e-3);
        assert_eq!(gain.contradiction(), 0.0);
        let contradicted = BoundedGain {
            seen: 0.2,
            information: 1e4,
            ..gain
        };
        assert!((contradicted.contradiction() - 10.0).abs() < 1e-9);
        // What contradicts it has no say: neither its end nor less than its width.
        assert!(contradicted.mean().abs() < 1e-12);
        let ends = |gain: BoundedGain| gain.intervals_95(|g| [g], &[1e-9])[0];
        assert_eq!(ends(contradicted), ends(gain));
    }

    /// Between what noise does and what nobody believes lies a certificate that may be wrong: the interval has both in it.
    #[test]
    fn inv_an_interval_reaches_from_the_certificate_to_what_contradicts_it() {
        for deviations in [1.5, 2.5, 0.95 * BEYOND_CERTIFICATE] {
            let doubtful = BoundedGain {
                limit: 0.1,
                seen: 0.1 + deviations / 1e2,
                information: 1e4,
            };
            let [(_, high)] = doubtful.intervals_95(|g| [g], &[1e-9]);
            assert!(high > doubtful.seen, "{high} of {}", doubtful.seen);
        }
        // What says next to nothing leaves the certificate nearly as it is.
        let vague = BoundedGain {
            limit: 0.1,
            seen: 0.0,
            information: 1.0,
        };
        let [(_, high)] = vague.intervals_95(|g| [g], &[1e-9]);
        assert!((high / 0.1 - 0.98).abs() < 0.02, "{high}");
    }
}
