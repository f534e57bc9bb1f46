//! What the static record leaves open of the zeros beyond its noise.

use sixaxis_core::{LIMBS, Parameter};

use super::EVEN_95;
use crate::diagnosis::still::still;
use crate::report::ParameterReport;
use crate::series::deviation;
use crate::trial::Trial;

/// Noise, in steps of the converter, from which rounding is lost in it and means go on below a step: with half a step the
/// mean of many is off by exp(-pi^2 / 2) / pi, 2.3e-3, steps at worst.
const DITHERED: f64 = 0.5;

/// Widens the zeros' intervals by half a step where noise does not carry the mean below one, and takes them away where the channel
/// read nothing.
pub(crate) fn put_rest(reports: &mut [ParameterReport], rest: &Trial, steps_v: &[f64; LIMBS]) {
    let still = still(&rest.voltage_v, steps_v);
    for report in reports {
        let Parameter::Drift(limb) = report.parameter else {
            continue;
        };
        if still[limb].is_some() {
            report.half_width_95 = None;
            report.determined = false;
            "the static record".clone_into(&mut report.dominated_by);
            "not determined: the channel read nothing in the static record"
                .clone_into(&mut report.remark);
            continue;
        }
        let rounding_v = EVEN_95 * 0.5 * steps_v[limb];
        if noise_v(rest, limb) < DITHERED * steps_v[limb] && rounding_v.is_finite() {
            report.half_width_95 = report.half_width_95.map(|own| own.hypot(rounding_v));
            "step of the converter".clone_into(&mut report.dominated_by);
        }
    }
}

/// Standard deviation of a sample, V.
fn noise_v(rest: &Trial, limb: usize) -> f64 {
    let series: Vec<f64> = rest.voltage_v.iter().map(|row| row[limb]).collect();
    deviation(&series)
}
