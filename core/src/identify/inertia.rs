//! Step 3: the six inertia/mass entries from pure angular motion: eqs. (15) to (19).

use glam::DVec3;

use super::Verdict;
use super::least_squares::{Accumulator, Estimate};
use super::noise_verdict_relative_to;
use super::scale::check_finite;
use crate::dynamics::LimbWrench;
use crate::error::Result;
use crate::geometry::{Geometry, LIMBS};
use crate::parameters::InertiaPerMass;

/// Result of step 3; values I1..I6 in m^2.
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaEstimate {
    /// I1..I6 over m with covariance and conditioning; residual in m^2/s^2.
    pub estimate: Estimate<6>,
    /// The same as a tensor.
    pub inertia_per_mass: InertiaPerMass,
    /// Whether the data determine them.
    pub verdict: Verdict,
}

/// Regressor W of (18) for one sample: three rows of (I/m) w' + w x (I/m) w in the unknowns I1..I6.
///
/// `rate` is w*, rad/s, `rate_derivative` w*', rad/s^2, both in shell axes. W times the six entries equals
/// [`euler_torque`] of their tensor.
#[must_use]
pub fn regressor(rate: DVec3, rate_derivative: DVec3) -> [[f64; 6]; 3] {
    let (x, y, z) = (rate.x, rate.y, rate.z);
    let (dx, dy, dz) = (rate_derivative.x, rate_derivative.y, rate_derivative.z);
    [
        [dx, -y * z, y * z, dy - x * z, dz + x * y, y * y - z * z],
        [x * z, dy, -x * z, dx + y * z, z * z - x * x, dz - x * y],
        [-x * y, x * y, dz, x * x - y * y, dx - y * z, dy + x * z],
    ]
}

/// Left side of (15): (I/m) w' + w x (I/m) w, m^2/s^2.
#[must_use]
pub fn euler_torque(inertia: &InertiaPerMass, rate: DVec3, rate_derivative: DVec3) -> DVec3 {
    let tensor = inertia.matrix_mass_m2();
    tensor * rate_derivative + rate.cross(tensor * rate)
}

/// Collects samples of pure angular motion.
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaIdentification {
    geometry: Geometry,
    rows: Accumulator<6>,
    samples: usize,
}

impl InertiaIdentification {
    /// Starts an empty collection.
    #[must_use]
    pub fn new(geometry: Geometry) -> Self {
        Self {
            geometry,
            rows: Accumulator::default(),
            samples: 0,
        }
    }

    /// Adds one sample: limb forces per mass (scaled by step 2), m/s^2; the shell's rate, rad/s, and its derivative,
    /// rad/s^2, in shell axes. A constant load at rest has no torque about the mass's centre, so a tared signal
    /// serves as well as a full one.
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`] (channel 0 is the reference).
    pub fn push(
        &mut self,
        force_per_mass_m_s2: &[f64; LIMBS],
        rate_shell_rad_s: DVec3,
        rate_derivative_shell_rad_s2: DVec3,
    ) -> Result<()> {
        check_finite(
            force_per_mass_m_s2,
            rate_shell_rad_s + rate_derivative_shell_rad_s2,
            self.samples,
        )?;
        let torque = LimbWrench::at_rest(&self.geometry, force_per_mass_m_s2).torque_shell_m2_s2;
        self.push_torque(torque, rate_shell_rad_s, rate_derivative_shell_rad_s2)
    }

    /// Adds one sample with its torque per mass given: see [`super::compliance`].
    pub(super) fn push_torque(
        &mut self,
        torque_m2_s2: DVec3,
        rate_rad_s: DVec3,
        rate_derivative_rad_s2: DVec3,
    ) -> Result<()> {
        let rows = regressor(rate_rad_s, rate_derivative_rad_s2);
        for (axis, row) in rows.into_iter().enumerate() {
            self.rows.push(row, torque_m2_s2[axis]);
        }
        self.samples += 1;
        Ok(())
    }

    /// Solves (18) by the pseudo-inverse (19).
    ///
    /// # Errors
    /// Those of [`Accumulator::solve`]; [`crate::Error::ImpossibleInertia`] if the solution is a tensor that no body
    /// has.
    pub fn solve(&self) -> Result<InertiaEstimate> {
        let estimate = self.rows.solve("inertia per mass (step 3)")?;
        let inertia_per_mass = InertiaPerMass::from_paper_order(estimate.values);
        inertia_per_mass.validate()?;
        let largest = estimate.values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let verdict = noise_verdict_relative_to(largest, &estimate.standard_error());
        Ok(InertiaEstimate {
            estimate,
            inertia_per_mass,
            verdict,
        })
    }
}
