//! Step 2: the nine scale/mass ratios from pure linear motion: eqs. (12), (13), (14).
//!
//! Below the linear threshold frequency the mass moves with the shell, so a = sum (s_i/m) f~_i e_i, three equations a
//! sample. Neglecting the relative motion costs at most 0.8e-6 of s_i/m at 2 Hz, and with the tilt of limbs
//! that carry gravity up to 2e-6 from 1 to 2 Hz; that is the method's, not ours.

use glam::DVec3;

use super::Verdict;
use super::least_squares::{Accumulator, Estimate};
use super::noise_verdict;
use crate::error::{Error, Result, require_finite_row};
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
    /// Along each axis of the shell the three limbs that lie there: (13) is three systems of three unknowns, as long
    /// as no limb tilts.
    at_rest: [Accumulator<LIMBS_PER_AXIS>; 3],
    /// Rows with limbs along other directions, which tie all nine together.
    tilted: Accumulator<LIMBS>,
    samples: usize,
}

/// Limbs along one axis of the shell.
const LIMBS_PER_AXIS: usize = LIMBS / 3;

/// The limbs along each axis of the shell.
const LIMBS_ALONG: [[usize; LIMBS_PER_AXIS]; 3] = {
    let mut along = [[0; LIMBS_PER_AXIS]; 3];
    let mut found = [0; 3];
    let mut limb = 0;
    while limb < LIMBS {
        let e = DIRECTIONS_SHELL[limb];
        let axis = if e.x != 0.0 {
            0
        } else if e.y != 0.0 {
            1
        } else {
            2
        };
        along[axis][found[axis]] = limb;
        found[axis] += 1;
        limb += 1;
    }
    along
};

impl ScaleIdentification {
    /// Adds one sample: measured forces f~_i (drift removed), N, and the change of the shell's acceleration since
    /// rest, shell axes, m/s^2.
    ///
    /// # Errors
    /// [`Error::NotFinite`] (channel 0 is the reference acceleration).
    #[inline]
    pub fn push(
        &mut self,
        measured_force_n: &[f64; LIMBS],
        acceleration_shell_m_s2: DVec3,
    ) -> Result<()> {
        check_finite(measured_force_n, acceleration_shell_m_s2, self.samples)?;
        for ((system, limbs), a) in self
            .at_rest
            .iter_mut()
            .zip(&LIMBS_ALONG)
            .zip(acceleration_shell_m_s2.to_array())
        {
            system.push(limbs.map(|limb| measured_force_n[limb]), a);
        }
        self.samples += 1;
        Ok(())
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
            self.tilted.push(row, right_side_m_s2[axis]);
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
        let mut rows = self.tilted.clone();
        for (axis, (system, limbs)) in self.at_rest.iter().zip(&LIMBS_ALONG).enumerate() {
            rows.append(&system.combined(|forces| {
                let mut row = [0.0; LIMBS];
                for (limb, force) in limbs.iter().zip(forces) {
                    // A limb may point against its axis.
                    row[*limb] = force * DIRECTIONS_SHELL[*limb][axis];
                }
                row
            }));
        }
        let estimate = rows.solve("scale per mass (step 2)")?;
        let verdict = noise_verdict(&estimate.values, &estimate.standard_error());
        Ok(ScalePerMass { estimate, verdict })
    }
}

/// Whether all numbers are finite, without a branch for each: zero times anything else is NaN.
#[inline]
pub(super) fn all_finite(numbers: &[f64]) -> bool {
    numbers.iter().map(|x| x * 0.0).sum::<f64>() == 0.0
}

/// Refuses a sample with a force or a reference that is not finite.
#[inline]
pub(super) fn check_finite(forces: &[f64; LIMBS], reference: DVec3, sample: usize) -> Result<()> {
    check_forces(forces, sample)?;
    check_reference(reference, sample)
}

/// Refuses a sample with a force that is not finite.
#[inline]
pub(super) fn check_forces(forces: &[f64; LIMBS], sample: usize) -> Result<()> {
    // Which of them it was is asked only if one is not.
    if !all_finite(forces) {
        require_finite_row(forces, sample)?;
    }
    Ok(())
}

/// Refuses a sample with a reference that is not finite.
#[inline]
pub(super) fn check_reference(reference: DVec3, sample: usize) -> Result<()> {
    if reference.is_finite() {
        Ok(())
    } else {
        Err(Error::NotFinite {
            channel: 0,
            sample,
            value: reference.element_sum(),
        })
    }
}
