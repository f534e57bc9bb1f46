//! The free decay of the mass in a shell at rest, and its derivatives by k/m, damping and I/m.
//!
//! With x = (r, phi), M = diag(1, I/m) and J of rows \[e_i, t_i x e_i\], limbs of stiffness k and damping c give
//!
//! ```text
//! M x'' + (c/m) J^T J x' + (k/m) J^T J x = 0,      f_i/m = -( (k/m) J x + (c/m) J x' )_i
//! ```
//!
//! # Modes
//! X with X^T M X = 1 and X^T J^T J X = diag(lambda) takes it apart: x = X q, and p = -((k/m) q + (c/m) q') is the force in
//! each mode, f/m = J X p. With z the damping of one limb as a share of critical under the whole mass, c/m = 2 z sqrt(k/m),
//!
//! ```text
//! p_j'' + 2 s_j p_j' + (k/m) lambda_j p_j = 0,     s_j = z sqrt(k/m) lambda_j,     w_j^2 = (k/m) lambda_j - s_j^2
//! p_j(t) = C_j(t) a_j + D_j(t) b_j,    D_j = exp(-s_j t) sin(w_j t)/w_j,    C_j = exp(-s_j t) cos(w_j t) + s_j D_j
//! ```
//!
//! linear in the initial values a and b. A mode's damping ratio z sqrt(lambda_j) grows with its frequency.
//!
//! # Derivatives
//! They are taken at fixed a and b in a basis that goes along; what a change of basis adds is a combination of the C and D
//! columns, which a fit with free a and b does not see.
//!
//! - ln k/m at fixed z merely runs time faster: p depends on sqrt(k/m) t, so that dp/d ln(k/m) = (t/2) p'.
//! - z: through s_j and w_j.
//! - I/m: let M become L (1 + N) L^T, L L^T = M. In the basis L (1 + N)^(1/2), to first order, the operator whose functions
//!   C and D are becomes lambda - (N lambda + lambda N)/2 and the shapes X (1 - N/2), with N = X^T dM X between modes. The
//!   derivative of a function of a symmetric matrix is its divided differences times the entries (Daletskii and Krein), so
//!
//! ```text
//! dp_i = sum_j N_ij ( -(lambda_i + lambda_j)/2 (C[i,j] a_j + D[i,j] b_j) - p_j/2 )
//! C[i,j] = (C_i - C_j)/(lambda_i - lambda_j),     dC/dlambda where both are equal
//! ```
//!
//! Derivatives of single modes' frequencies and shapes, which blow up as two frequencies meet, do not occur.

use glam::DVec3;
use nalgebra::{Matrix6, SymmetricEigen};

use crate::columns::matrix;
use crate::error::{Error, Result, require};
use crate::float::{exp, sin_cos, sqrt};
use crate::geometry::{Geometry, LIMBS};
use crate::identify::inertia::between;
use crate::model::{InertiaPerMass, STIFFNESS_PER_MASS_RANGE_PER_S2};

/// Modes of the mass in its shell.
pub const MODES: usize = 6;
/// Unknowns on which the decay depends nonlinearly: ln k/m, z, I1 to I6 over m.
pub const SHARED: usize = 8;

/// Eigenvalues nearer to each other than this share of them count as one. The quotient loses eps/gap of its digits, the mean of
/// both derivatives is off by the square of the gap times that of the phase, some hundred radians: 1e-9 and 1e-10 here.
const ONE_AND_THE_SAME: f64 = 1e-7;
/// Relative off-diagonal size that the eigenvalue iteration is asked for, and its cap.
const EIGEN_TOLERANCE: f64 = 1e-15;
const EIGEN_ITERATIONS: usize = 500;

/// The six damped modes of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct RingDown {
    stiffness_per_mass_per_s2: f64,
    damping_ratio: f64,
    /// lambda, ascending.
    eigenvalue: [f64; MODES],
    /// J X: limb forces of each mode.
    shape: [[f64; MODES]; LIMBS],
    /// Rotations of the mass in each mode, rad: the lower half of X.
    rotation: [DVec3; MODES],
    /// s_j, 1/s.
    decay_per_s: [f64; MODES],
    /// w_j, rad/s.
    rate_rad_s: [f64; MODES],
}

/// C and D of each mode at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant {
    time_s: f64,
    pub cosine: [f64; MODES],
    pub sine: [f64; MODES],
    /// exp(-s t) cos(w t) and exp(-s t) sin(w t).
    damped: [(f64, f64); MODES],
}

impl RingDown {
    /// The modes of a sensor with the given k/m and damping ratio of one limb under the whole mass.
    ///
    /// # Errors
    /// Those of [`Geometry::validate`] and [`InertiaPerMass::validate`]; [`Error::OutOfRange`] for a k/m outside
    /// [`STIFFNESS_PER_MASS_RANGE_PER_S2`] and a damping that is negative or keeps a mode from swinging;
    /// [`Error::NotConverged`] of the eigenvalue iteration.
    pub fn new(
        geometry: &Geometry,
        inertia_per_mass: &InertiaPerMass,
        stiffness_per_mass_per_s2: f64,
        damping_ratio: f64,
    ) -> Result<Self> {
        geometry.validate()?;
        inertia_per_mass.validate()?;
        let (low, high) = STIFFNESS_PER_MASS_RANGE_PER_S2;
        require(
            (low..=high).contains(&stiffness_per_mass_per_s2),
            "stiffness_per_mass_per_s2",
            stiffness_per_mass_per_s2,
            "between 1e7 and 1e10",
        )?;
        let jacobian = geometry.limb_jacobian();
        let mut mass = Matrix6::identity();
        let tensor = inertia_per_mass.matrix_mass_m2();
        mass.fixed_view_mut::<3, 3>(3, 3).copy_from(&matrix(tensor));
        // 1 and 1e-4 m^2 on one diagonal: Cholesky is indifferent to scaling.
        let impossible = || {
            Error::out_of_range(
                "inertia_per_mass",
                tensor.determinant(),
                "positive definite",
            )
        };
        let lower = mass.cholesky().ok_or_else(impossible)?.l();
        let inverse = lower
            .solve_lower_triangular(&Matrix6::identity())
            .ok_or_else(impossible)?;
        let operator = inverse * (jacobian.transpose() * jacobian) * inverse.transpose();
        let eigen = SymmetricEigen::try_new(operator, EIGEN_TOLERANCE, EIGEN_ITERATIONS).ok_or(
            Error::NotConverged {
                what: "modes of the mass in its shell",
                iterations: EIGEN_ITERATIONS,
            },
        )?;
        let mut order: [usize; MODES] = core::array::from_fn(|j| j);
        order.sort_unstable_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let eigenvalue = order.map(|j| eigen.eigenvalues[j]);
        let natural = sqrt(stiffness_per_mass_per_s2);
        let stiffest = damping_ratio * sqrt(eigenvalue[MODES - 1]);
        // Written so that NaN is refused.
        require(
            eigenvalue[0] > 0.0 && damping_ratio >= 0.0 && stiffest < 1.0,
            "damping_ratio",
            damping_ratio,
            "not negative and small enough for every mode to swing",
        )?;
        let modes = inverse.transpose() * eigen.eigenvectors;
        let forces = jacobian * modes;
        let decay_per_s = eigenvalue.map(|lambda| damping_ratio * natural * lambda);
        Ok(Self {
            stiffness_per_mass_per_s2,
            damping_ratio,
            eigenvalue,
            shape: core::array::from_fn(|limb| order.map(|j| forces[(limb, j)])),
            rotation: order.map(|j| DVec3::new(modes[(3, j)], modes[(4, j)], modes[(5, j)])),
            decay_per_s,
            rate_rad_s: core::array::from_fn(|j| {
                let undamped = natural * sqrt(eigenvalue[j]);
                let ratio = damping_ratio * sqrt(eigenvalue[j]);
                undamped * sqrt((1.0 - ratio) * (1.0 + ratio))
            }),
        })
    }

    /// Frequencies without damping, ascending, Hz.
    #[must_use]
    pub fn frequencies_hz(&self) -> [f64; MODES] {
        self.eigenvalue
            .map(|lambda| sqrt(self.stiffness_per_mass_per_s2 * lambda) / core::f64::consts::TAU)
    }

    /// Damping ratio of each mode, in the same order.
    #[must_use]
    pub fn damping_ratios(&self) -> [f64; MODES] {
        self.eigenvalue
            .map(|lambda| self.damping_ratio * sqrt(lambda))
    }

    /// Limb forces per mass, m/s^2, at a time after the modes had the values `initial`: a_1 to a_6, m/s^2, b_1 to b_6, m/s^3.
    #[must_use]
    pub fn force_per_mass_m_s2(&self, time_s: f64, initial: &[f64; 2 * MODES]) -> [f64; LIMBS] {
        self.at(time_s).force(self, initial)
    }

    /// Derivatives of [`Self::force_per_mass_m_s2`] by ln k/m, the damping ratio and I1 to I6 over m, at fixed values of the
    /// modes in a basis that goes along (see the module): but for combinations of the modes themselves, the derivatives.
    #[must_use]
    pub fn sensitivities(&self, time_s: f64, initial: &[f64; 2 * MODES]) -> [[f64; LIMBS]; SHARED] {
        self.at(time_s).sensitivities(self, initial)
    }

    /// One limb's force of a unit force in each mode.
    pub(super) fn shape(&self, limb: usize) -> &[f64; MODES] {
        &self.shape[limb]
    }

    pub(super) fn at(&self, time_s: f64) -> Instant {
        let damped: [(f64, f64); MODES] = core::array::from_fn(|j| {
            let size = exp(-self.decay_per_s[j] * time_s);
            let (sin, cos) = sin_cos(self.rate_rad_s[j] * time_s);
            (size * cos, size * sin)
        });
        let sine: [f64; MODES] = core::array::from_fn(|j| damped[j].1 / self.rate_rad_s[j]);
        Instant {
            time_s,
            cosine: core::array::from_fn(|j| damped[j].0 + self.decay_per_s[j] * sine[j]),
            sine,
            damped,
        }
    }

    fn forces_of(&self, modal: &[f64; MODES]) -> [f64; LIMBS] {
        self.shape
            .map(|shape| shape.iter().zip(modal).map(|(w, p)| w * p).sum())
    }
}

impl Instant {
    fn modal(&self, initial: &[f64; 2 * MODES]) -> [f64; MODES] {
        core::array::from_fn(|j| self.cosine[j] * initial[j] + self.sine[j] * initial[MODES + j])
    }

    pub fn force(&self, ring: &RingDown, initial: &[f64; 2 * MODES]) -> [f64; LIMBS] {
        ring.forces_of(&self.modal(initial))
    }

    /// Changes of C_j and D_j with s_j and w_j.
    fn turned(&self, ring: &RingDown, j: usize, decay: f64, rate: f64) -> (f64, f64) {
        let (t, w) = (self.time_s, ring.rate_rad_s[j]);
        let (cos, sin) = self.damped[j];
        let sine = -t * decay * self.sine[j] + t * rate * cos / w - rate / w * self.sine[j];
        let cosine =
            -t * decay * cos - t * rate * sin + decay * self.sine[j] + ring.decay_per_s[j] * sine;
        (cosine, sine)
    }

    pub fn sensitivities(
        &self,
        ring: &RingDown,
        initial: &[f64; 2 * MODES],
    ) -> [[f64; LIMBS]; SHARED] {
        let (a, b): ([f64; MODES], [f64; MODES]) = (
            core::array::from_fn(|j| initial[j]),
            core::array::from_fn(|j| initial[MODES + j]),
        );
        let modal = self.modal(initial);
        let k = ring.stiffness_per_mass_per_s2;
        let natural = sqrt(k);
        // C' = -(k/m) lambda D, D' = C - 2 s D.
        let faster: [f64; MODES] = core::array::from_fn(|j| {
            let slope_c = -k * ring.eigenvalue[j] * self.sine[j];
            let slope_d = self.cosine[j] - 2.0 * ring.decay_per_s[j] * self.sine[j];
            0.5 * self.time_s * (slope_c * a[j] + slope_d * b[j])
        });
        let damped: [f64; MODES] = core::array::from_fn(|j| {
            let decay = natural * ring.eigenvalue[j];
            let rate = -ring.decay_per_s[j] * decay / ring.rate_rad_s[j];
            let (cosine, sine) = self.turned(ring, j, decay, rate);
            cosine * a[j] + sine * b[j]
        });
        let slope: [(f64, f64); MODES] = core::array::from_fn(|j| {
            let decay = ring.damping_ratio * natural;
            let rate = (0.5 * k - ring.decay_per_s[j] * decay) / ring.rate_rad_s[j];
            self.turned(ring, j, decay, rate)
        });
        let mut inertia = [[0.0; MODES]; 6];
        for i in 0..MODES {
            for j in 0..MODES {
                let (li, lj) = (ring.eigenvalue[i], ring.eigenvalue[j]);
                let gap = li - lj;
                let (cosine, sine) = if gap.abs() > ONE_AND_THE_SAME * (li + lj) {
                    (
                        (self.cosine[i] - self.cosine[j]) / gap,
                        (self.sine[i] - self.sine[j]) / gap,
                    )
                } else {
                    (
                        0.5 * (slope[i].0 + slope[j].0),
                        0.5 * (slope[i].1 + slope[j].1),
                    )
                };
                let effect = -0.5 * ((li + lj) * (cosine * a[j] + sine * b[j]) + modal[j]);
                for (entry, n) in inertia
                    .iter_mut()
                    .zip(between(ring.rotation[i], ring.rotation[j]))
                {
                    entry[i] += n * effect;
                }
            }
        }
        let mut all = [[0.0; LIMBS]; SHARED];
        all[0] = ring.forces_of(&faster);
        all[1] = ring.forces_of(&damped);
        for (forces, modal) in all[2..].iter_mut().zip(&inertia) {
            *forces = ring.forces_of(modal);
        }
        all
    }
}
