//! What a measurement does: errors that are found, and what they have bent.

use glam::DVec3;
use nalgebra::{SMatrix, SVector};

use super::model::{ATTITUDE, DYNAMIC, Dynamics, ERRORS, RATE, VELOCITY};
use crate::columns::vector;
use crate::geometry::LIMBS;
use crate::parameter::SCALE;

/// What a measurement says of the errors, in the axes of [`super::Deviations`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// psi.
    pub attitude_ground_rad: DVec3,
    /// Of w*.
    pub rate_shell_rad_s: DVec3,
    /// Of the velocity.
    pub velocity_ground_m_s: DVec3,
    /// Of the zero drifts.
    pub drift_v: [f64; LIMBS],
    /// Of the scale factors.
    pub scale_per_mass_per_kg: [f64; LIMBS],
    /// Whether the measurement contradicts what was known.
    pub contradicts: bool,
}

/// What a measurement does to the errors: those that it finds are taken off.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Update {
    /// Place of the first of the three errors that it shows.
    pub(super) place: usize,
    pub(super) gain: SMatrix<f64, ERRORS, 3>,
    /// Covariance of the measurement, as it counted.
    pub(super) noise: SMatrix<f64, 3, 3>,
    /// The errors found.
    pub(super) found: SMatrix<f64, ERRORS, 1>,
    /// What they have done in second order to those that have dynamics.
    pub(super) bent: SVector<f64, DYNAMIC>,
    /// Those that are left about what was found, by those of first order.
    pub(super) about: Dynamics,
    pub(super) contradicts: bool,
}

impl Correction {
    pub(super) fn of(found: &SMatrix<f64, ERRORS, 1>, contradicts: bool) -> Self {
        let three = |at: usize| vector(found.fixed_rows::<3>(at).into_owned());
        Self {
            attitude_ground_rad: three(ATTITUDE),
            rate_shell_rad_s: three(RATE),
            velocity_ground_m_s: three(VELOCITY),
            drift_v: core::array::from_fn(|i| found[DYNAMIC + i]),
            scale_per_mass_per_kg: core::array::from_fn(|i| found[DYNAMIC + SCALE.start + i]),
            contradicts,
        }
    }
}

impl Update {
    pub(super) fn correction(&self) -> Correction {
        let mut found = self.found;
        let mut dynamic = found.fixed_rows_mut::<DYNAMIC>(0);
        dynamic += self.bent;
        Correction::of(&found, self.contradicts)
    }
}
