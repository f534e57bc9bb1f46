//! Strains of nine voltages, each limb giving way by its own stiffness.

use crate::geometry::LIMBS;
use crate::kernel::constants::Constants;
use crate::kernel::order::from_kernel_order;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::{ROWS, SIGNATURES};

/// What a voltage is in strain, limb by limb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strains {
    pub per_v: [f64; LIMBS],
    at_zero: [f64; LIMBS],
    /// At rest. A scale factor's error is one of what is counted from there.
    pub at_rest: [f64; LIMBS],
}

impl Strains {
    /// For limbs of these stiffnesses over their mean, which at rest show these voltages.
    pub fn new(
        constants: &Constants<f64>,
        zero_drift_v: &[f64; LIMBS],
        stiffness_ratio: &[f64; LIMBS],
    ) -> Self {
        let slope = from_kernel_order(constants.strain_per_v);
        let zero = from_kernel_order(constants.strain_at_zero);
        let at_rest: [f64; LIMBS] =
            core::array::from_fn(|i| (slope[i] * zero_drift_v[i] + zero[i]) / stiffness_ratio[i]);
        let per_v: [f64; LIMBS] = core::array::from_fn(|i| slope[i] / stiffness_ratio[i]);
        Self {
            per_v,
            at_zero: core::array::from_fn(|i| at_rest[i] - per_v[i] * zero_drift_v[i]),
            at_rest,
        }
    }

    #[inline]
    pub fn of_limb(&self, limb: usize, voltage_v: f64) -> f64 {
        self.per_v[limb] * voltage_v + self.at_zero[limb]
    }

    #[inline]
    pub fn of(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|limb| self.of_limb(limb, voltage_v[limb]))
    }

    /// Parity rows of the same voltage on all channels but these limbs', by that voltage.
    pub fn of_a_common_voltage(&self, gone: LimbSet) -> [f64; ROWS] {
        let mut rows = [0.0; ROWS];
        for limb in (0..LIMBS).filter(|&limb| !gone.contains(limb)) {
            for (row, &sign) in rows.iter_mut().zip(&SIGNATURES[limb]) {
                *row += f64::from(sign) * self.per_v[limb];
            }
        }
        rows
    }

    #[inline]
    pub fn counted_from_rest(&self, strain: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| strain[i] - self.at_rest[i])
    }
}
