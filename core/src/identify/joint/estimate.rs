//! The joint estimate in the paper's parameters.

use alloc::vec::Vec;

use crate::parameter::PARAMETERS;
use nalgebra::{DMatrix, DVector, SMatrix};

use super::Known;
use super::room::Spreads;
use super::unknowns::{ACCELEROMETER_GAIN, COMPLIANCE, DRIFT, INERTIA, MASS_PER_SCALE, Unknowns};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::model::Parameters;

/// What one trial turned out to have for itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialEstimate {
    /// Its wedge.
    pub wedge: usize,
    /// Squares of its residuals, each over its noise, that are left more than noise leaves: residuals less unknowns of its own.
    pub excess: f64,
    /// Zeros against those of the static record, V.
    pub zero_v: [Known; LIMBS],
    /// Sensitivities against the usual ones, relative.
    pub sensitivity: [Known; LIMBS],
    /// From the axis to the mass's centre in the wedge's two sideways directions, m; none where nothing turns.
    pub centre_m: Option<[Known; 2]>,
    /// What gravity in the sensor has more of square to the axis, over its size; none where nothing turns.
    pub plumb: Option<[Known; 2]>,
}

/// Result of the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEstimate {
    /// All unknowns.
    pub unknowns: Unknowns,
    /// Covariance of all unknowns, from noise and certificates, with the accelerometer's gain held; zero for unknowns that
    /// were not free. It is the Cramer-Rao bound.
    pub covariance: DMatrix<f64>,
    /// Change of the unknowns' estimates with the accelerometer's assumed gain.
    pub by_accelerometer_gain: DVector<f64>,
    /// The accelerometer's gain as the trials themselves determine it.
    pub accelerometer_gain_seen: f64,
    /// One over its variance; 0 where the trials do not determine it.
    pub accelerometer_gain_information: f64,
    /// Whether 1/(k/m) had a prior.
    pub compliance_from_elsewhere: bool,
    /// Sum of squared residuals, each over its noise.
    pub squares: f64,
    /// Residuals less unknowns.
    pub degrees_of_freedom: usize,
    /// Gauss-Newton steps taken.
    pub iterations: usize,
    /// Spreads of what nobody states, as the trials show them.
    pub spreads: Spreads,
    /// What each trial has for itself, in the order in which they were added.
    pub trials: Vec<TrialEstimate>,
}

impl JointEstimate {
    /// The 25, the accelerometer's gain taken to be `gain`.
    #[must_use]
    pub fn values(&self, gain: f64) -> [f64; PARAMETERS] {
        let held = self.accelerometer_gain_held();
        let at = |u: usize, change: f64| {
            self.unknowns.values[u] + change * self.by_accelerometer_gain[u]
        };
        let change = gain - held;
        core::array::from_fn(|p| match p {
            p if is_scale(p) => 1.0 / at(p, change),
            // What a gain multiplies m/s by, it divides I/m by: exact where nothing but the gain is open.
            p if is_inertia(p) => at(p, change * (1.0 + held) / (1.0 + gain)),
            p => at(p, change),
        })
    }

    /// Gain of the accelerometer that the fit was made at.
    #[must_use]
    pub fn accelerometer_gain_held(&self) -> f64 {
        self.unknowns.values[ACCELEROMETER_GAIN]
    }

    /// Change of the 25 with the accelerometer's gain.
    #[must_use]
    pub fn slopes(&self) -> [f64; PARAMETERS] {
        core::array::from_fn(|p| self.reciprocal(p) * self.by_accelerometer_gain[p])
    }

    /// Covariance of the 25 with the accelerometer's gain held.
    #[must_use]
    pub fn parameter_covariance(&self) -> SMatrix<f64, PARAMETERS, PARAMETERS> {
        SMatrix::from_fn(|a, b| self.reciprocal(a) * self.reciprocal(b) * self.covariance[(a, b)])
    }

    /// Their standard deviations.
    #[must_use]
    pub fn deviations(&self) -> [f64; PARAMETERS] {
        let covariance = self.parameter_covariance();
        core::array::from_fn(|p| sqrt(covariance[(p, p)]))
    }

    /// As parameters to decouple with; `stiffness_per_mass_per_s2` is the caller's to choose, since the compliance may well be
    /// open.
    #[must_use]
    pub fn parameters(&self, gain: f64, stiffness_per_mass_per_s2: f64) -> Parameters {
        let v = self.values(gain);
        Parameters {
            zero_drift_v: core::array::from_fn(|i| v[DRIFT + i]),
            scale_per_mass_per_kg: core::array::from_fn(|i| v[MASS_PER_SCALE + i]),
            inertia_per_mass: crate::model::InertiaPerMass::from_paper_order(core::array::from_fn(
                |i| v[INERTIA + i],
            )),
            stiffness_per_mass_per_s2,
        }
    }

    /// 1/(k/m), s^2, and its standard deviation.
    #[must_use]
    pub fn compliance_s2(&self) -> (f64, f64) {
        (
            self.unknowns.values[COMPLIANCE],
            sqrt(self.covariance[(COMPLIANCE, COMPLIANCE)]),
        )
    }

    /// Squares per degree of freedom: 1 where the model and the noise are right.
    #[must_use]
    pub fn misfit(&self) -> f64 {
        self.squares / (self.degrees_of_freedom.max(1)) as f64
    }

    /// Derivative of a reported parameter by the unknown that stands for it.
    fn reciprocal(&self, p: usize) -> f64 {
        if is_scale(p) {
            let y = self.unknowns.values[p];
            -1.0 / (y * y)
        } else {
            1.0
        }
    }
}

fn is_inertia(p: usize) -> bool {
    (INERTIA..INERTIA + 6).contains(&p)
}

fn is_scale(p: usize) -> bool {
    (MASS_PER_SCALE..MASS_PER_SCALE + LIMBS).contains(&p)
}
