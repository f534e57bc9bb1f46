//! Step 2: the nine scale/mass ratios from pure linear motion: eqs. (12), (13), (14).
//!
//! Below the linear threshold frequency the mass moves with the shell, so a = sum (s_i/m) f~_i e_i, three equations a
//! sample. Neglecting the relative motion costs about 1.5e-6 of s_i/m at 2 Hz; that is the method's, not ours.

use glam::DVec3;

use super::Verdict;
use super::least_squares::{Accumulator, Estimate};
use super::noise_verdict;
use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, LIMBS};

/// Result of step 2; values in 1/kg.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalePerMass {
    /// s_i/m with covariance and conditioning; residual in m/s^2.
    pub estimate: Estimate<LIMBS>,
    /// Whether the data determine them.
    pub verdict: Verdict,
}

/// Collects samples of pure linear motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScaleIdentification {
    rows: Accumulator<LIMBS>,
    samples: usize,
}

impl ScaleIdentification {
    /// Adds one sample: measured forces f~_i (drift removed), N, and the change of the shell's acceleration since
    /// rest, shell axes, m/s^2.
    ///
    /// # Errors
    /// [`Error::NotFinite`] (channel 0 is the reference acceleration).
    pub fn push(
        &mut self,
        measured_force_n: &[f64; LIMBS],
        acceleration_shell_m_s2: DVec3,
    ) -> Result<()> {
        self.push_along(measured_force_n, &DIRECTIONS_SHELL, acceleration_shell_m_s2)
    }

    /// Adds one sample with the limbs along given directions and whatever (3) leaves on its right side: see
    /// [`super::compliance`].
    pub(super) fn push_along(
        &mut self,
        measured_force_n: &[f64; LIMBS],
        directions_shell: &[DVec3; LIMBS],
        right_side_m_s2: DVec3,
    ) -> Result<()> {
        check_finite(measured_force_n, right_side_m_s2, self.samples)?;
        for axis in 0..3 {
            let row = core::array::from_fn(|i| measured_force_n[i] * directions_shell[i][axis]);
            self.rows.push(row, right_side_m_s2[axis]);
        }
        self.samples += 1;
        Ok(())
    }

    /// Solves (13) by the pseudo-inverse (14).
    ///
    /// # Errors
    /// [`Error::RankDeficient`] when fewer than three independent accelerations were seen, and the other errors of
    /// [`Accumulator::solve`].
    pub fn solve(&self) -> Result<ScalePerMass> {
        let estimate = self.rows.solve("scale per mass (step 2)")?;
        let verdict = noise_verdict(&estimate.values, &estimate.standard_error());
        Ok(ScalePerMass { estimate, verdict })
    }
}

pub(super) fn check_finite(forces: &[f64; LIMBS], reference: DVec3, sample: usize) -> Result<()> {
    for (channel, &value) in forces.iter().enumerate() {
        if !value.is_finite() {
            return Err(Error::NotFinite {
                channel: channel + 1,
                sample,
                value,
            });
        }
    }
    if !reference.is_finite() {
        return Err(Error::NotFinite {
            channel: 0,
            sample,
            value: reference.element_sum(),
        });
    }
    Ok(())
}
