//! Zero drifts and scale factors that a filter has corrected.

use super::correction::Correction;
use crate::geometry::LIMBS;
use crate::model::Parameters;

/// Zero drifts and scale factors as they turn out to be. The decoupler keeps those that it was made with, and is given the voltages
/// that these would show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Channels {
    made_with: Parameters,
    drift_v: [f64; LIMBS],
    scale_per_mass_per_kg: [f64; LIMBS],
}

impl Channels {
    pub(super) const fn new(made_with: Parameters) -> Self {
        Self {
            made_with,
            drift_v: made_with.zero_drift_v,
            scale_per_mass_per_kg: made_with.scale_per_mass_per_kg,
        }
    }

    pub(super) fn mended(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| {
            let ratio = self.scale_per_mass_per_kg[i] / self.made_with.scale_per_mass_per_kg[i];
            self.made_with.zero_drift_v[i] + ratio * (voltage_v[i] - self.drift_v[i])
        })
    }

    /// What voltages that others have mended are by these.
    pub(super) fn anew(&self, mended_v: &[f64; LIMBS], by: &Self) -> [f64; LIMBS] {
        self.mended(&core::array::from_fn(|i| {
            let ratio = by.scale_per_mass_per_kg[i] / by.made_with.scale_per_mass_per_kg[i];
            by.drift_v[i] + (mended_v[i] - by.made_with.zero_drift_v[i]) / ratio
        }))
    }

    pub(super) fn parameters(&self) -> Parameters {
        Parameters {
            zero_drift_v: self.drift_v,
            scale_per_mass_per_kg: self.scale_per_mass_per_kg,
            ..self.made_with
        }
    }

    pub(super) fn take(&mut self, found: &Correction) {
        for i in 0..LIMBS {
            self.drift_v[i] -= found.drift_v[i];
            self.scale_per_mass_per_kg[i] -= found.scale_per_mass_per_kg[i];
        }
    }
}
