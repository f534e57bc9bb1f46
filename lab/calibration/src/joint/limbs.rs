//! The limbs and channels that the fit found, as a calibration keeps them.

use sixaxis_core::identify::joint::unknowns::{
    MASS_CENTRE, MASS_PER_SCALE, ROD_MASS, STIFFNESS, Unknowns,
};

use super::JointReport;
use crate::calibration::CalibratedLimbs;

impl JointReport {
    /// Limbs and channels beside the 25.
    pub fn limbs(&self) -> CalibratedLimbs {
        let estimate = &self.estimate;
        let unknowns = &estimate.unknowns;
        let stiffness_ratio = unknowns.stiffness_ratio();
        let spreads = &estimate.spreads;
        // ln of (s_i/m)/(k_i/k) by m/s_i and k_i/k.
        let slopes = |limb: usize| {
            let (scale, stiffness) = (MASS_PER_SCALE + limb, STIFFNESS + limb);
            [
                (scale, -1.0 / unknowns.values[scale]),
                (stiffness, -1.0 / stiffness_ratio[limb]),
            ]
        };
        let wider = self.misfit.wider();
        let covariance = |i: usize, j: usize| {
            let pairs = slopes(i)
                .into_iter()
                .flat_map(|a| slopes(j).map(|b| (a, b)));
            let sum: f64 = pairs
                .map(|((a, by_a), (b, by_b))| by_a * estimate.covariance[(a, b)] * by_b)
                .sum();
            wider * wider * sum
        };
        CalibratedLimbs {
            stiffness_ratio,
            mass_centre_m: core::array::from_fn(|axis| self.at_known_gain(MASS_CENTRE + axis)),
            rod_mass: self.at_known_gain(ROD_MASS),
            cross_talk: core::array::from_fn(|into| {
                core::array::from_fn(|from| {
                    if into == from {
                        0.0
                    } else {
                        unknowns.values[Unknowns::cross_talk(into, from)]
                    }
                })
            }),
            cross_talk_spread: spreads.cross_talk(),
            strain_covariance: core::array::from_fn(|i| {
                core::array::from_fn(|j| {
                    let moved = if i == j {
                        spreads.next_sensitivity()
                    } else {
                        0.0
                    };
                    covariance(i, j) + moved * moved
                })
            }),
        }
    }
}
