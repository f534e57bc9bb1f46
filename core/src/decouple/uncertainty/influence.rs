//! How the steps' estimates answer to a change of one row of theirs.
//!
//! A least-squares estimate theta = argmin sum |A theta - b|^2 with a regressor A of *measured* numbers moves by
//!
//! ```text
//! d theta = (A^T A)^-1 A^T (db - dA theta),
//! ```
//!
//! to first order in the residual, too, which is noise itself. So a row A_t answers to whatever its right side lacks by
//! G_t = (A^T A)^-1 A_t^T, and all sources of error, noise of a channel or of a standard, gains, wedges, earlier steps,
//! differ only in the three numbers that they put on that right side: the *discrepancies* here.

use glam::DVec3;
use nalgebra::{SMatrix, SVector};

pub use crate::columns::column;
use crate::columns::matrix;
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS};
use crate::identify::inertia::{InertiaEstimate, euler_torque, regressor};
use crate::identify::scale::ScalePerMass;
use crate::model::InertiaPerMass;
use crate::paper::signal::SignalChain;

/// Force on the mass, m/s^2, that one volt of each channel stands for.
#[must_use]
pub fn force_per_volt(chain: &SignalChain) -> [DVec3; LIMBS] {
    let sensitivity = chain.sensitivity_m_s2_per_v();
    core::array::from_fn(|i| DIRECTIONS_SHELL[i] * sensitivity[i])
}

/// Torque per mass, m^2/s^2, that one volt of each channel stands for.
#[must_use]
pub fn torque_per_volt(geometry: &Geometry, chain: &SignalChain) -> [DVec3; LIMBS] {
    let (sensitivity, arms) = (chain.sensitivity_m_s2_per_v(), geometry.arms_m());
    core::array::from_fn(|i| arms[i] * sensitivity[i])
}

/// Step 2: how the nine scale factors answer.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaleInfluence {
    inverse_normal: SMatrix<f64, LIMBS, LIMBS>,
}

impl ScaleInfluence {
    /// From step 2's result.
    #[must_use]
    pub fn new(found: &ScalePerMass) -> Self {
        Self {
            inverse_normal: found.estimate.inverse_normal,
        }
    }

    /// Answer of s_i/m, 1/kg, to an acceleration, m/s^2, on the right side of the sample with these measured forces, N.
    ///
    /// A volt more on channel i is a discrepancy of -(s_i/m) c_i e_i; a reference that reads more, of what it reads more.
    #[must_use]
    pub fn of_sample(&self, measured_force_n: &[f64; LIMBS]) -> SMatrix<f64, LIMBS, 3> {
        let rows = SMatrix::<f64, LIMBS, 3>::from_fn(|i, axis| {
            measured_force_n[i] * DIRECTIONS_SHELL[i][axis]
        });
        self.inverse_normal * rows
    }
}

/// Step 3: how the six inertias answer.
///
/// The gain of the gyroscope may be trusted, identified as a seventh unknown, or anything between: its estimate gamma enters
/// with a share lambda, and the certificate with the rest. With W the regressor at gamma, J = gamma I/m what is solved for,
/// and q = w x J w, which gamma multiplies, partitioned least squares gives for a discrepancy r of one row
///
/// ```text
/// d J at fixed gamma = K W^T r                    K = (W^T W)^-1
/// d gamma identified = (q - W g) . r / sum |q - W g|^2,   g = K sum W^T q
/// d I/m = (d J - lambda (g + I/m) d gamma) / gamma
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaInfluence {
    inverse_normal: SMatrix<f64, 6, 6>,
    inertia: InertiaPerMass,
    gain: GyroscopeShare,
    /// g, and the inverse of sum |q - W g|^2.
    by_gain: SVector<f64, 6>,
    gain_precision: f64,
}

/// What the angular trials' own word on the gyroscope's gain counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GyroscopeShare {
    /// gamma: true rate over reading, as step 3 took it.
    pub rate_over_reading: f64,
    /// Share of the trials in it: 0 where the gyroscope is trusted, 1 where its gain is identified.
    pub of_trials: f64,
}

impl GyroscopeShare {
    /// The gyroscope is believed.
    pub const TRUSTED: Self = Self {
        rate_over_reading: 1.0,
        of_trials: 0.0,
    };
}

impl InertiaInfluence {
    /// From step 3's result and its samples: rates, rad/s, and their derivatives, rad/s^2, shell axes, as read.
    #[must_use]
    pub fn new(
        found: &InertiaEstimate,
        gain: GyroscopeShare,
        samples: impl Iterator<Item = (DVec3, DVec3)>,
    ) -> Self {
        let mut influence = Self {
            inverse_normal: found.estimate.inverse_normal,
            inertia: found.inertia_per_mass,
            gain,
            by_gain: SVector::zeros(),
            gain_precision: 0.0,
        };
        if gain.of_trials == 0.0 {
            return influence;
        }
        let (mut projected, mut squares) = (SVector::<f64, 6>::zeros(), 0.0);
        for (rate, derivative) in samples {
            let q = column(influence.gyroscopic(rate));
            projected += influence.regressor(rate, derivative).transpose() * q;
            squares += q.norm_squared();
        }
        influence.by_gain = influence.inverse_normal * projected;
        let left = squares - projected.dot(&influence.by_gain);
        influence.gain_precision = if left > 0.0 { 1.0 / left } else { 0.0 };
        influence
    }

    /// w x J w of a reading.
    fn gyroscopic(&self, rate: DVec3) -> DVec3 {
        let tensor = self.inertia.matrix_mass_m2() * self.gain.rate_over_reading;
        rate.cross(tensor * rate)
    }

    /// W with its quadratic part taken gamma times.
    fn regressor(&self, rate: DVec3, derivative: DVec3) -> SMatrix<f64, 3, 6> {
        let gamma = self.gain.rate_over_reading;
        // w' gamma + gamma^2 w x w, over gamma.
        let rows = regressor(rate * gamma, derivative * gamma);
        SMatrix::from_fn(|axis, j| rows[axis][j] / gamma)
    }

    /// Answer of I/m, m^2, to a torque, m^2/s^2, on the right side of the sample with this reading.
    ///
    /// A volt more on channel i is a discrepancy of (s_i/m) c_i t_i x e_i.
    #[must_use]
    pub fn of_sample(&self, rate: DVec3, derivative: DVec3) -> SMatrix<f64, 6, 3> {
        let GyroscopeShare {
            rate_over_reading: gamma,
            of_trials,
        } = self.gain;
        let w = self.regressor(rate, derivative);
        let at_fixed_gain = self.inverse_normal * w.transpose();
        let of_gain =
            (column(self.gyroscopic(rate)) - w * self.by_gain).transpose() * self.gain_precision;
        let inertia = SVector::<f64, 6>::from(self.inertia.to_paper_order());
        (at_fixed_gain - (self.by_gain + inertia) * of_gain * of_trials) / gamma
    }

    /// Discrepancy, m^2/s^2, of a reading that is higher than it should be by a rate, rad/s, and a derivative, rad/s^2:
    /// minus the change of (J w' + gamma w x J w).
    #[must_use]
    pub fn of_reading(&self, rate: DVec3, more_rate: DVec3, more_derivative: DVec3) -> DVec3 {
        let gamma = self.gain.rate_over_reading;
        let tensor = self.inertia.matrix_mass_m2() * gamma;
        let quadratic = more_rate.cross(tensor * rate) + rate.cross(tensor * more_rate);
        -(tensor * more_derivative + quadratic * gamma)
    }

    /// Discrepancy, m^2/s^2, of a gyroscope that reads too much by the whole of a reading: see [`Self::of_reading`].
    #[must_use]
    pub fn of_gain(&self, rate: DVec3, derivative: DVec3) -> DVec3 {
        let gamma = self.gain.rate_over_reading;
        let once = euler_torque(&self.inertia, rate * gamma, derivative * gamma);
        -(once + self.gyroscopic(rate) * gamma)
    }
}

/// Step 4: how the compliance answers to torques.
///
/// In pure linear motion w* is zero but for what is wrong with the torques, so that w*' = (I/m)^-1 (discrepancy): along the
/// run a single integral, which Heun's scheme takes by trapezoids. The compliance that makes the mean square of
/// w* = p + (x - x_0) q smallest answers by dx = -sum dp . q / sum |q|^2; the integral's transpose turns sum dp . q into a
/// sum over torques, each weighted by the sum of all later q. At the solution w* is zero, and so the inertia has no say. Neglected
/// is that strains are as wrong as the scale factors that they come from: x ds/s, little where x is not known to a few per cent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplianceInfluence {
    inverse_inertia: SMatrix<f64, 3, 3>,
    step_s: f64,
    /// 1 / sum |q|^2 over all trials, s^4/rad^2.
    precision: f64,
}

impl ComplianceInfluence {
    /// With the sum of |q|^2, (rad/s)^2/s^4, over all trials; none for one that tells nothing, or an inertia without inverse.
    #[must_use]
    pub fn new(inertia: &InertiaPerMass, sample_rate_hz: f64, slope_squares: f64) -> Option<Self> {
        let inverse = matrix(inertia.matrix_mass_m2()).try_inverse()?;
        let precision = 1.0 / slope_squares;
        (slope_squares > 0.0 && precision.is_finite()).then_some(Self {
            inverse_inertia: inverse,
            step_s: 1.0 / sample_rate_hz,
            precision,
        })
    }

    /// Answer of m/k, s^2, to a torque, m^2/s^2, at each sample of one trial: `slopes` holds q, the change of w* with the
    /// compliance, of consecutive samples, and is overwritten.
    pub fn of_trial(&self, slopes: &mut [DVec3]) {
        let mut later = DVec3::ZERO;
        for (i, q) in slopes.iter_mut().enumerate().rev() {
            let own = *q;
            // Half a step before a sample and half a step behind it; the rate at the first sample is given.
            *q = if i == 0 {
                later * 0.5
            } else {
                later + own * 0.5
            };
            later += own;
        }
        let weight = -self.step_s * self.precision;
        for q in slopes {
            let answer = self.inverse_inertia.transpose() * column(*q) * weight;
            *q = DVec3::new(answer.x, answer.y, answer.z);
        }
    }
}
