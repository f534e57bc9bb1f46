//! The joint estimate's 25 in the form that the four steps report them in.

use super::JointReport;
use super::misfit::CONTRADICTING;
use crate::interval::{TAP_IT, is_determined};
use crate::report::ParameterReport;
use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::significance::NORMAL_95;

/// Deviation, in that of the gain, of an interval that is the gain's alone: the quadrature needs some.
const NEXT_TO_NOTHING: f64 = 1e-3;

/// What limits a scale factor that is known better than it stays.
const SENSITIVITIES: &str = "sensitivities that move over the day";

impl JointReport {
    /// Reports on all 25; `four_steps` has names, units and designs, and k/m where this fit leaves it open.
    pub fn parameter_reports(&self, four_steps: &[ParameterReport]) -> Vec<ParameterReport> {
        four_steps
            .iter()
            .take(PARAMETERS)
            .enumerate()
            .map(|(p, other)| {
                match other.parameter {
                    Parameter::Stiffness => self.stiffness_report(p, other),
                    // Of the static record both estimators know the same.
                    Parameter::Drift(_) => other.clone(),
                    _ => self.report_on(p, other),
                }
            })
            .collect()
    }

    fn report_on(&self, p: usize, other: &ParameterReport) -> ParameterReport {
        let estimate = self.values[p];
        let half_width = self.half_width_95(p);
        let (noise, gain) = (self.noise_95(p), self.gain_95(p));
        let moved = NORMAL_95 * self.moved(p).abs();
        let determined = is_determined(other.parameter, estimate, half_width);
        ParameterReport {
            parameter: other.parameter,
            unit: other.unit.clone(),
            estimate,
            design: other.design,
            half_width_95: Some(half_width),
            from_noise: Some(noise),
            from_trials: (moved > 0.0).then_some(moved),
            from_standards: Some(gain),
            dominated_by: if moved > noise.max(gain) {
                SENSITIVITIES.to_owned()
            } else {
                self.dominant(noise, gain).to_owned()
            },
            determined,
            remark: if determined {
                String::new()
            } else {
                "not determined: its interval is wider than the value itself".to_owned()
            },
        }
    }

    /// k/m, of which the fit has the reciprocal.
    fn stiffness_report(&self, p: usize, other: &ParameterReport) -> ParameterReport {
        let compliance = self.values[p];
        if !self.compliance_is_determined {
            // Taps that the fit could not use for want of precision determine it all the same.
            if other.determined && other.half_width_95.is_some() {
                return other.clone();
            }
            // Twice the interval is beyond what noise does.
            let less_than_nothing = if compliance < -2.0 * self.half_width_95(p) {
                ", less than any limb yields: something else moves with the acceleration, as a frame that rocks does"
            } else {
                ""
            };
            return ParameterReport {
                estimate: other.design,
                half_width_95: None,
                dominated_by: "trials too slow to load it".to_owned(),
                determined: false,
                remark: format!(
                    "not determined: all trials together tell m/k as {compliance:.1e} ± {:.1e} s²{less_than_nothing}; the design's value is used, which the decoupled accelerations do not notice at the rig's frequencies. {TAP_IT}",
                    self.half_width_95(p)
                ),
                ..other.clone()
            };
        }
        let per_compliance = compliance.powi(-2);
        let (noise, gain) = (self.noise_95(p), self.gain_95(p));
        let (dominated_by, remark) = if self.estimate.compliance_from_elsewhere {
            ("the taps", "from the taps and all trials")
        } else {
            (self.dominant(noise, gain), "from all trials")
        };
        ParameterReport {
            estimate: 1.0 / compliance,
            half_width_95: Some(per_compliance * self.half_width_95(p)),
            from_noise: Some(per_compliance * noise),
            from_trials: None,
            from_standards: Some(per_compliance * gain),
            dominated_by: dominated_by.to_owned(),
            determined: true,
            remark: remark.to_owned(),
            ..other.clone()
        }
    }

    /// The farther end of the interval: about an estimate in its middle, half of it.
    pub fn half_width_95(&self, p: usize) -> f64 {
        let (low, high) = self.intervals_95[p];
        (high - self.values[p]).max(self.values[p] - low)
    }

    fn noise_95(&self, p: usize) -> f64 {
        NORMAL_95 * self.noise_covariance()[(p, p)].max(0.0).sqrt()
    }

    fn gain_95(&self, p: usize) -> f64 {
        let slope = self.estimate.slopes()[p];
        let spread = slope.abs() * self.gain.deviation();
        if spread == 0.0 {
            return 0.0;
        }
        let [(low, high)] = self
            .gain
            .intervals_95(|gain| [slope * gain], &[NEXT_TO_NOTHING * spread]);
        let middle = slope * self.gain.mean();
        (high - middle).max(middle - low)
    }

    fn dominant(&self, noise: f64, gain: f64) -> &'static str {
        if gain > noise {
            if self.gain_is_told() {
                "what the trials tell of the accelerometer's gain"
            } else {
                "certificate of the accelerometer"
            }
        } else if self.misfit.contradicts() {
            CONTRADICTING
        } else {
            "noise"
        }
    }
}
