//! What the joint fit comes to: the 25 with their deviations, intervals and covariances.

use nalgebra::SMatrix;
use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::estimate::JointEstimate;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{LIMBS, Parameters};

use super::misfit::Misfit;
use crate::gain_prior::BoundedGain;

/// 1/(k/m) whose standard deviation is below this share of it is known; what is below a tenth is a measurement.
const COMPLIANCE_KNOWN: f64 = 0.1;

/// Largest relative change of all sensitivities together between the trials that travel and those that turn: two kelvins of a room, at a
/// permille each, which is usual for piezoelectric ceramic. Within a kind of trials nothing shows it.
const TOGETHER_LIMIT: f64 = 2e-3;

/// Information on a gain that trials which turn in gravity tell against those which travel, gravity itself having this relative deviation.
fn between_kinds_of_trials(information: f64, gravity_deviation: f64) -> f64 {
    let variance = gravity_deviation * gravity_deviation + TOGETHER_LIMIT * TOGETHER_LIMIT / 3.0;
    information / (1.0 + information * variance)
}

/// Rows and columns of the 25.
type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;
/// Those of the scale factors.
const SCALES: core::ops::Range<usize> = LIMBS..2 * LIMBS;

/// The joint estimate of the 25 with intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct JointReport {
    /// The fit.
    pub estimate: JointEstimate,
    /// Names of its trials' recordings, in order.
    pub recordings: Vec<String>,
    /// What is known of the accelerometer's gain.
    pub gain: BoundedGain,
    /// The 25: d, V; s/m, 1/kg; I/m, m^2; 1/(k/m), s^2.
    pub values: [f64; PARAMETERS],
    /// Their standard deviations, the accelerometer's gain included.
    pub deviations: [f64; PARAMETERS],
    /// Ends of their 95 % intervals.
    pub intervals_95: [(f64, f64); PARAMETERS],
    /// Whether 1/(k/m) is determined.
    pub compliance_is_determined: bool,
    /// Whether the channels agree with the model; where not, all of the above is that much wider.
    pub misfit: Misfit,
}

impl JointReport {
    /// What the fit to these recordings comes to.
    pub fn new(
        estimate: JointEstimate,
        recordings: Vec<String>,
        accelerometer_gain_limit: f64,
        gravity_deviation: f64,
    ) -> Self {
        let misfit = Misfit::of(&estimate);
        let wider = misfit.wider();
        let gain = BoundedGain {
            limit: accelerometer_gain_limit,
            seen: estimate.accelerometer_gain_seen,
            information: between_kinds_of_trials(
                estimate.accelerometer_gain_information / (wider * wider),
                gravity_deviation,
            ),
        };
        let slopes = estimate.slopes();
        let covariance = with_moved(&estimate, noise_covariance(&estimate, wider));
        let noise: [f64; PARAMETERS] = core::array::from_fn(|p| covariance[(p, p)].max(0.0).sqrt());
        let (mean, spread) = (gain.mean(), gain.deviation());
        let compliance = estimate.compliance_s2().0;
        Self {
            values: estimate.values(mean),
            deviations: core::array::from_fn(|p| noise[p].hypot(spread * slopes[p])),
            intervals_95: gain.intervals_95(|gain| estimate.values(gain), &noise),
            compliance_is_determined: compliance > 0.0
                && noise[PARAMETERS - 1] < COMPLIANCE_KNOWN * compliance,
            gain,
            misfit,
            estimate,
            recordings,
        }
    }

    /// Covariance of the 25 without the accelerometer's gain: noise, and whatever the channels disagree by.
    pub fn noise_covariance(&self) -> Square {
        noise_covariance(&self.estimate, self.misfit.wider())
    }

    /// What parameter `p`, from 0, is off before or after the trials, a standard deviation: of a scale factor how far its sensitivity has moved.
    pub fn moved(&self, p: usize) -> f64 {
        moved(&self.estimate, p)
    }

    /// Covariance of the 25 without the accelerometer's gain for a recording of another time, with what sensitivities and zeros are off there.
    pub fn covariance_of_next_recording(&self) -> Square {
        let mut all = with_moved(&self.estimate, self.noise_covariance());
        for limb in 0..LIMBS {
            let zeros = self.estimate.trials.iter().map(|trial| trial.zero_v[limb]);
            all[(limb, limb)] += spread(zeros).powi(2);
        }
        all
    }

    /// Covariance of the 25 that the accelerometer's gain alone gives.
    pub fn gain_covariance(&self) -> Square {
        let (slopes, spread) = (self.estimate.slopes(), self.gain.deviation());
        SMatrix::from_fn(|a, b| slopes[a] * slopes[b] * spread * spread)
    }

    /// To decouple with: where 1/(k/m) is open, with the given k/m, 1/s^2.
    pub fn parameters(&self, otherwise_per_s2: f64) -> Parameters {
        let (compliance, _) = self.estimate.compliance_s2();
        let stiffness = if self.compliance_is_determined {
            1.0 / compliance
        } else {
            otherwise_per_s2
        };
        self.estimate.parameters(self.gain.mean(), stiffness)
    }
}

/// Factors on the fit's own deviations. A compliance that was given is not the trials' to spoil.
fn widths(estimate: &JointEstimate, wider: f64) -> [f64; PARAMETERS] {
    let mut widths = [wider; PARAMETERS];
    if estimate.compliance_from_elsewhere {
        widths[PARAMETERS - 1] = 1.0;
    }
    widths
}

/// Covariance of the 25 with the accelerometer's gain held, that much wider.
fn noise_covariance(estimate: &JointEstimate, wider: f64) -> Square {
    let widths = widths(estimate, wider);
    let own = estimate.parameter_covariance();
    Square::from_fn(|a, b| widths[a] * widths[b] * own[(a, b)])
}

/// See [`JointReport::moved`]. In the place of a scale factor stands its reciprocal.
fn moved(estimate: &JointEstimate, p: usize) -> f64 {
    if SCALES.contains(&p) {
        estimate.spreads.next_sensitivity() / estimate.unknowns.values[p]
    } else {
        0.0
    }
}

/// A covariance with how far sensitivities have moved.
fn with_moved(estimate: &JointEstimate, mut covariance: Square) -> Square {
    for p in SCALES {
        covariance[(p, p)] += moved(estimate, p).powi(2);
    }
    covariance
}

/// Spread about zero of what is known with errors of its own.
fn spread(of: impl Iterator<Item = Known>) -> f64 {
    let (sum, count) = of.fold((0.0, 0.0), |(sum, count), known| {
        let square = known.value * known.value - known.deviation * known.deviation;
        (sum + square, count + 1.0)
    });
    if count > 0.0 {
        f64::max(sum / count, 0.0).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_no_spread() {
        let known = |value: f64, deviation: f64| Known { value, deviation };
        assert_eq!(spread([known(1.0, 1.0), known(-1.0, 1.0)].into_iter()), 0.0);
        assert_eq!(spread([known(3.0, 0.0), known(-3.0, 0.0)].into_iter()), 3.0);
        assert_eq!(spread(core::iter::empty()), 0.0);
    }
}
