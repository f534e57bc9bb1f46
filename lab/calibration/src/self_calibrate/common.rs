//! The change that all limbs share, which no ratio shows and one known change of acceleration does.

use sixaxis_core::redundancy::self_calibration::Scales;
use sixaxis_core::significance::chi_square_limit;
use sixaxis_core::{LIMBS, LimbSet, Result};

/// Change of the scale factors of the limbs that kept their ratios, against the calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Common {
    /// ln of it.
    pub ln_change: f64,
    /// Its standard deviation, with the calibration's own.
    pub deviation: f64,
    /// Whether chance leaves as much less often than false alarms are allowed.
    pub drifted: bool,
}

impl Common {
    /// Of all limbs but those that have `changed` against the others; all calibrated scale factors have an error of deviation `calibrated`
    /// in common.
    ///
    /// # Errors
    /// A rate of false alarms that is none.
    pub fn of(
        scales: &Scales,
        changed: LimbSet,
        calibrated: f64,
        false_alarm: f64,
    ) -> Result<Self> {
        let kept = || (0..LIMBS).filter(|limb| !changed.contains(*limb));
        let count = (LIMBS - changed.len()) as f64;
        let ln_change = kept().map(|limb| scales.ln_scale[limb]).sum::<f64>() / count;
        // Of a mean of errors that hang together in whatever way: no more than the mean of their deviations.
        let measured = kept().map(|limb| scales.deviation[limb]).sum::<f64>() / count;
        let deviation = measured.hypot(calibrated);
        let limit = chi_square_limit(false_alarm, 1)?;
        Ok(Self {
            ln_change,
            deviation,
            drifted: ln_change * ln_change > limit * deviation * deviation,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_what_limbs_share_is_told_apart_from_what_one_of_them_has_of_its_own() {
        let of = |ln_scale: [f64; LIMBS], changed: LimbSet, calibrated: f64| {
            let scales = Scales {
                ln_scale,
                deviation: [1e-3; LIMBS],
                ln_common: 0.0,
                common_deviation: 1e-3,
            };
            Common::of(&scales, changed, calibrated, 0.01).expect("a rate")
        };
        let fourth = LimbSet::EMPTY.with(3);
        let mut one = [0.0; LIMBS];
        one[3] = 0.05;
        assert!(!of(one, fourth, 0.0).drifted);
        let all = one.map(|own| own + 0.01);
        let common = of(all, fourth, 0.0);
        assert!(common.drifted && (common.ln_change - 0.01).abs() < 1e-15);
        // A hundredth is three deviations of a gain that is known to a third of that, and two of one that is known to half.
        let deviation = |calibrated: f64| of([0.01; LIMBS], LimbSet::EMPTY, calibrated);
        assert!(deviation(3e-3).drifted && !deviation(5e-3).drifted);
    }
}
