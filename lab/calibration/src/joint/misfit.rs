//! Channels that contradict the model, and how much wider that makes the intervals.
//!
//! Squares per degree of freedom scatter by root(2/n) where an ordinary room and white noise are all there is: about 0.98 with white noise alone, about
//! 0.95 in a gentle and 0.81 in a usual room, whose hum is taken for noise above the drive's band (24, 12 and 12 simulated days). Where they are
//! larger than 1, Birge's ratio would widen all deviations by their root. That is right for noise that is larger than was thought and
//! far too little for a channel that bends, lags or sticks: it does so in all trials alike, so that its share is not spread over
//! all residuals but lies in a few directions, where nothing averages it. What is taken instead is the size of the disagreement.
//!
//! Of nine forces statics leave three open, and these alone can contradict; the other six look like other parameters. A
//! disagreement of any direction therefore has 6/3 of the visible squares in excess where no residual shows them. Shared out
//! evenly among the 15 parameters that forces tell, every variance grows by that over 15, in units of its own.
//!
//! Measured when unequal stiffness was such a disagreement, before it became an unknown: with stiffnesses that differ by 0.2 %
//! estimates are off by 80 to 190 of the fit's own deviations, root mean square, and these are widened 140 to 390 times; with
//! 0.02 %, 10 to 19, and 22 to 38.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::estimate::JointEstimate;

use crate::error::Error;

/// Standard deviations of chi square by which the squares must be too many to be a contradiction.
const CONTRADICTION: f64 = 5.0;
/// Squares per degree of freedom below which noise is larger than what it is taken from shows in the drive's band: half of it is none of the
/// trials' there.
const FAR_TOO_FEW: f64 = 0.5;
/// What a disagreement hides over what it shows: six combinations of nine forces over three.
const HIDDEN_OVER_SHOWN: f64 = 6.0 / 3.0;
/// s_i/m and I/m.
const TOLD_BY_FORCES: f64 = (LIMBS + 6) as f64;

/// What limits an interval that is made wider.
pub const CONTRADICTING: &str = "channels that contradict the model";

/// Squares of the residuals over what noise explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Squares per degree of freedom.
    pub per_degree: f64,
    /// Residuals less unknowns.
    pub degrees_of_freedom: usize,
}

impl Misfit {
    /// Of a fit.
    pub fn of(estimate: &JointEstimate) -> Self {
        Self {
            per_degree: estimate.misfit(),
            degrees_of_freedom: estimate.degrees_of_freedom,
        }
    }

    /// Of a fit that was given up; none if it refuses for another reason.
    pub fn of_refusal(refusal: &Error) -> Option<Self> {
        let Error::Step { source, .. } = refusal else {
            return None;
        };
        match **source {
            sixaxis_core::Error::Unaccounted {
                over_noise,
                degrees_of_freedom,
                ..
            } => Some(Self {
                per_degree: over_noise * over_noise,
                degrees_of_freedom,
            }),
            _ => None,
        }
    }

    /// Squares per degree of freedom that noise alone may well have.
    pub fn limit(&self) -> f64 {
        1.0 + CONTRADICTION * (2.0 / self.degrees_of_freedom.max(1) as f64).sqrt()
    }

    /// True if the residuals reject an ordinary room or white noise, or if the statistic is NaN.
    pub fn contradicts(&self) -> bool {
        self.per_degree.is_nan() || self.per_degree > self.limit()
    }

    /// What is to be said of squares that are far too few: the noise of the recordings, which is told from above the drive's harmonics, is
    /// not that of the fit.
    pub fn too_few(&self) -> Option<String> {
        (self.per_degree < FAR_TOO_FEW).then(|| {
            format!(
                "above the drive's harmonics the recordings have {:.1} times the noise that is among them, as with mains hum: `sixaxis inspect` names its \
                 frequency, and what is decoupled has it too",
                self.per_degree.sqrt().recip()
            )
        })
    }

    /// Factor on the fit's own standard deviations: 1 where nothing is contradicted.
    pub fn wider(&self) -> f64 {
        if self.contradicts() {
            let excess = (self.per_degree - 1.0) * self.degrees_of_freedom as f64;
            (1.0 + HIDDEN_OVER_SHOWN * excess / TOLD_BY_FORCES).sqrt()
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a root.
    const ROUNDING: f64 = 1e-12;

    fn misfit(per_degree: f64) -> Misfit {
        Misfit {
            per_degree,
            degrees_of_freedom: 20_000,
        }
    }

    #[test]
    fn inv_noise_widens_nothing() {
        let scatter = (2.0_f64 / 20_000.0).sqrt();
        for per_degree in [0.5, 1.0 - scatter, 1.0, 1.0 + 4.0 * scatter] {
            let fine = misfit(per_degree);
            assert!(!fine.contradicts());
            assert_eq!(fine.wider().to_bits(), 1.0_f64.to_bits());
        }
        assert!(misfit(1.0 + 6.0 * scatter).contradicts());
        assert!(misfit(f64::NAN).contradicts());
    }

    #[test]
    fn inv_a_disagreement_twice_as_large_is_twice_as_wide() {
        let wider = |per_degree: f64| {
            let w = misfit(per_degree).wider();
            (w * w - 1.0).sqrt()
        };
        // Squares in excess grow with the square of what is wrong.
        assert!((wider(1.0 + 4.0 * 3.0) / wider(1.0 + 3.0) - 2.0).abs() < ROUNDING);
    }
}
