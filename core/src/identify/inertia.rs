//! Step 3: the six inertia/mass entries from pure angular motion: eqs. (15) to (19).
//!
//! # The gain of the reference gyroscope
//! Euler's equation is not indifferent to the scale of the rate: (I/m) w' grows with it once, w x (I/m) w twice. A
//! gyroscope that reads w/gamma makes (15) read I1 w' + gamma w x I1 w = torque with I1 = gamma I/m, so that gamma can
//! be found from the same data as the six entries, with no other standard than the clock. Left alone, a gain error of
//! half a per cent leaves a constant torque that the decoupler integrates twice.

use glam::DVec3;

use super::Verdict;
use super::least_squares::factor::Factor;
use super::least_squares::{Accumulator, Estimate};
use super::noise_verdict_relative_to;
use super::scale::{all_finite, check_forces, check_reference};
use crate::error::{Error, Result, require};
use crate::float::sqrt;
use crate::geometry::{Geometry, LIMBS};
use crate::model::InertiaPerMass;

/// Name of the step in errors.
const WHAT: &str = "inertia per mass (step 3)";

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

/// Terms of Euler's equation that the nine columns hold.
const TERMS: usize = 9;

/// What the three rows of W are put together from: w*', then the products of w* that w x (I/m) w consists of.
///
/// The last three add up to zero, but each has to be there itself: motion about one axis makes one of them exactly
/// zero, which the sum of the others would not be after rounding.
#[inline]
fn terms(rate: DVec3, rate_derivative: DVec3) -> [f64; TERMS] {
    let (x, y, z) = (rate.x, rate.y, rate.z);
    let (dx, dy, dz) = (rate_derivative.x, rate_derivative.y, rate_derivative.z);
    [
        dx,
        dy,
        dz,
        y * z,
        x * z,
        x * y,
        y * y - z * z,
        z * z - x * x,
        x * x - y * y,
    ]
}

/// One axis's row of W from the terms, what is quadratic in the rate taken `gamma` times.
fn row(axis: usize, terms: &[f64; TERMS], gamma: f64) -> [f64; 6] {
    let [dx, dy, dz, ..] = *terms;
    let [_, _, _, yz, xz, xy, yy_zz, zz_xx, xx_yy] = terms.map(|term| gamma * term);
    match axis {
        0 => [dx, -yz, yz, dy - xz, dz + xy, yy_zz],
        1 => [xz, dy, -xz, dx + yz, zz_xx, dz - xy],
        _ => [-xy, xy, dz, xx_yy, dx - yz, dy + xz],
    }
}

/// What each entry of an inertia, paper's order, counts for in u . I v, which is linear in them.
#[must_use]
pub const fn between(u: DVec3, v: DVec3) -> [f64; 6] {
    [
        u.x * v.x,
        u.y * v.y,
        u.z * v.z,
        u.x * v.y + u.y * v.x,
        u.x * v.z + u.z * v.x,
        u.y * v.z + u.z * v.y,
    ]
}

/// Regressor W of (18) for one sample: three rows of (I/m) w' + w x (I/m) w in the unknowns I1..I6.
///
/// `rate` is w*, rad/s, `rate_derivative` w*', rad/s^2, both in shell axes. W times the six entries equals
/// [`euler_torque`] of their tensor.
#[must_use]
pub fn regressor(rate: DVec3, rate_derivative: DVec3) -> [[f64; 6]; 3] {
    let terms = terms(rate, rate_derivative);
    core::array::from_fn(|axis| row(axis, &terms, 1.0))
}

/// Left side of (15): (I/m) w' + w x (I/m) w, m^2/s^2.
#[must_use]
pub fn euler_torque(inertia: &InertiaPerMass, rate: DVec3, rate_derivative: DVec3) -> DVec3 {
    let tensor = inertia.matrix_mass_m2();
    tensor * rate_derivative + rate.cross(tensor * rate)
}

/// sum (f_i/m) t_i x e_i with the limbs at rest, as (19) prints it: of nine limbs three point at the mass's centre, and
/// the others act in pairs. Equals [`crate::paper::wrench::LimbWrench::at_rest`] up to rounding.
fn torque_at_rest(half_edge_m: f64, force_per_mass_m_s2: &[f64; LIMBS]) -> DVec3 {
    let [_, f2, f3, f4, _, f6, f7, f8, _] = *force_per_mass_m_s2;
    half_edge_m * DVec3::new(f4 - f2, f3 - f7, f8 - f6)
}

/// Collects samples of pure angular motion.
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaIdentification {
    geometry: Geometry,
    /// A sample is one row of [`terms`] with three right sides, its torque: the rows of W hold the same nine numbers in
    /// three arrangements. Smaller than W itself, and it serves every gain.
    rows: Factor<TERMS, 3>,
    samples: usize,
}

/// Result of step 3 with the gyroscope's gain as a seventh unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaAndGain {
    /// The six entries at the true scale of the rate.
    pub inertia: InertiaEstimate,
    /// gamma: true rate over reading.
    pub rate_over_reading: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// Interval searched for gamma: no instrument worth the name is off by a tenth. What is found at an end of it lies there or beyond.
pub const GAIN_RANGE: (f64, f64) = (0.9, 1.1);
/// Golden-section steps: the interval shrinks to 0.2 x 0.618^60 = 6e-14.
const GAIN_STEPS: usize = 60;

impl InertiaIdentification {
    /// Starts an empty collection.
    #[must_use]
    pub fn new(geometry: Geometry) -> Self {
        Self {
            geometry,
            rows: Factor::default(),
            samples: 0,
        }
    }

    /// Adds one sample: limb forces per mass (scaled by step 2), m/s^2; the shell's rate, rad/s, and its derivative,
    /// rad/s^2, in shell axes. A constant load at rest has no torque about the mass's centre, so a tared signal
    /// serves as well as a full one.
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`] (channel 0 is the reference), [`crate::Error::Overflow`] if the square of the rate is
    /// not.
    #[inline]
    pub fn push(
        &mut self,
        force_per_mass_m_s2: &[f64; LIMBS],
        rate_shell_rad_s: DVec3,
        rate_derivative_shell_rad_s2: DVec3,
    ) -> Result<()> {
        // The rate is looked at with the terms made of it.
        check_forces(force_per_mass_m_s2, self.samples)?;
        let torque = torque_at_rest(self.geometry.half_edge_m, force_per_mass_m_s2);
        self.push_torque(torque, rate_shell_rad_s, rate_derivative_shell_rad_s2)
    }

    /// Adds one sample with its torque per mass given: see [`super::compliance`].
    #[inline]
    pub(super) fn push_torque(
        &mut self,
        torque_m2_s2: DVec3,
        rate_rad_s: DVec3,
        rate_derivative_rad_s2: DVec3,
    ) -> Result<()> {
        let terms = terms(rate_rad_s, rate_derivative_rad_s2);
        // A rate or a derivative that is not finite leaves no set of finite terms.
        if !(all_finite(&terms) && all_finite(&torque_m2_s2.to_array())) {
            for reference in [rate_rad_s, rate_derivative_rad_s2] {
                check_reference(reference, self.samples)?;
            }
            return Err(Error::overflow(WHAT, self.samples));
        }
        self.rows.push(&terms, &torque_m2_s2.to_array());
        self.samples += 1;
        Ok(())
    }

    /// The problem with six unknowns that a given gamma leaves.
    fn at_gain(&self, gamma: f64) -> Accumulator<6> {
        self.rows.combined(|axis, terms| row(axis, terms, gamma))
    }

    /// Solves (18) by the pseudo-inverse (19).
    ///
    /// # Errors
    /// Those of [`Accumulator::solve`]; [`crate::Error::ImpossibleInertia`] if the solution is a tensor that no body
    /// has.
    pub fn solve(&self) -> Result<InertiaEstimate> {
        Self::judged(self.at_gain(1.0).solve(WHAT)?)
    }

    /// Solves (18) for a gyroscope of which the true rate is `rate_over_reading` times its reading. Equals [`Self::solve`] at 1.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`crate::Error::OutOfRange`] for a ratio that is not positive and finite.
    pub fn solve_at_gain(&self, rate_over_reading: f64) -> Result<InertiaEstimate> {
        require(
            rate_over_reading.is_normal() && rate_over_reading > 0.0,
            "rate_over_reading",
            rate_over_reading,
            "positive and finite",
        )?;
        let mut estimate = self.at_gain(rate_over_reading).solve(WHAT)?;
        // What was solved for is gamma I/m.
        estimate.values = estimate.values.map(|v| v / rate_over_reading);
        estimate.covariance /= rate_over_reading * rate_over_reading;
        Self::judged(estimate)
    }

    /// Solves for the six entries and the gyroscope's gain.
    ///
    /// # Errors
    /// As [`Self::solve`], and [`crate::Error::NotConverged`] where the residual has no minimum in the gain: the motion
    /// does not tell it.
    pub fn solve_with_gain(&self) -> Result<InertiaAndGain> {
        let squares = |gamma: f64| -> Result<f64> {
            let rms = self.at_gain(gamma).solve(WHAT)?.residual_rms;
            Ok(rms * rms)
        };
        let ratio = 0.618_033_988_749_894_9;
        let (mut low, mut high) = GAIN_RANGE;
        let mut inner = [high - ratio * (high - low), low + ratio * (high - low)];
        let mut value = [squares(inner[0])?, squares(inner[1])?];
        for _ in 0..GAIN_STEPS {
            if value[0] <= value[1] {
                high = inner[1];
                inner = [high - ratio * (high - low), inner[0]];
                value = [squares(inner[0])?, value[0]];
            } else {
                low = inner[0];
                inner = [inner[1], low + ratio * (high - low)];
                value = [value[1], squares(inner[1])?];
            }
        }
        let gamma = 0.5 * (low + high);
        let mut estimate = self.at_gain(gamma).solve(WHAT)?;
        // Curvature of the profiled sum of squares: var(gamma) = 2 sigma^2 / (d^2 S/d gamma^2), S = rows x mean square.
        let probe = 1e-3;
        let middle = estimate.residual_rms * estimate.residual_rms;
        let curvature =
            (squares(gamma + probe)? - 2.0 * middle + squares(gamma - probe)?) / (probe * probe);
        let degrees_of_freedom = (estimate.rows - 6) as f64;
        let standard_error = sqrt(2.0 * middle / (curvature * degrees_of_freedom));
        if !(curvature > 0.0 && standard_error.is_finite()) {
            return Err(Error::NotConverged {
                what: "gain of the gyroscope (step 3)",
                iterations: GAIN_STEPS,
            });
        }
        // What was solved for is gamma I/m.
        estimate.values = estimate.values.map(|v| v / gamma);
        estimate.covariance /= gamma * gamma;
        Ok(InertiaAndGain {
            inertia: Self::judged(estimate)?,
            rate_over_reading: gamma,
            standard_error,
        })
    }

    fn judged(estimate: Estimate<6>) -> Result<InertiaEstimate> {
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
