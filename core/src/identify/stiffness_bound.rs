//! How well any method can know k/m from harmonic motion: frequency response of the nine forces and Cramer-Rao bound.
//!
//! # The response
//! Let x = (r, phi) be the small motion of the mass in the shell and (a; alpha) the shell's acceleration. Per mass,
//! M x'' + K x = -M (a; alpha), M = diag(1, I/m), K = (k/m) J^T J with rows (e_i, t_i x e_i) of J, and the limbs carry
//! f/m = -(k/m) J x. With y = m/k and motion at the angular frequency w this is
//!
//! ```text
//! f/m = J H M (a; alpha),   H = (J^T J - y w^2 M)^-1.
//! ```
//!
//! At w = 0 there is no y in it: limbs of equal stiffness share a static load in a way that does not depend on how stiff
//! they are. All that k/m does to the nine signals is
//!
//! ```text
//! d(f/m) / d ln(k/m) = -y w^2 J H M H M (a; alpha),
//! ```
//!
//! a share of (w/w_n)^2: 3e-6 at 5 Hz. It comes with inertia, d(f/m)/dI = J H M_I (1 + y w^2 H M)(a; alpha) where M_I is
//! 1 in that entry of I/m, and with scale factors, d u_i / d ln s_i = -u_i, which look much the same.
//!
//! # The bound
//! Nine channels with white noise of standard deviation sigma in f/m, N samples over whole periods: a trial adds
//! N / (2 sigma^2) D^T D to the information, where the columns of D are the derivatives above. The inverse's diagonal
//! bounds every unbiased estimate. The shell's motion counts as known exactly, there is no damping: reality is worse.
//!
//! # Limbs that tilt
//! Linear theory leaves out the tilt of loaded limbs, a share a/(L k/m) of the signals, quadratic in the motion: at 5 Hz and 9 g
//! 3.6 times w^2/(k/m), and at twice the frequency, where it is not taken for anything else. The linear figure is therefore no
//! bound there: an estimate that looks at the second harmonic does better ([`tilted`], [`Information::push_trial`]; drifts are
//! unknown with it). At one acceleration tilt falls behind with the square of the frequency, to a thirtieth at 50 Hz.

mod tilted;

use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, Matrix6, SMatrix};

use super::bias::limb_jacobian;
use crate::columns::{matrix, stacked};
use crate::error::{Error, Result, require, require_samples};
use crate::float::sqrt;
use crate::geometry::{Geometry, LIMBS};
use crate::model::InertiaPerMass;

/// ln(k/m), then ln of nine scale factors, then six entries of I/m.
pub const UNKNOWNS: usize = 1 + LIMBS + INERTIAS;
const INERTIAS: usize = 6;
const TAU: f64 = 2.0 * core::f64::consts::PI;

/// The sensor without damping: as a linear system in small motion without gravity ([`Self::response`]), and with the tilt of its
/// limbs ([`Self::tilted`]).
#[derive(Debug, Clone, PartialEq)]
pub struct LinearSensor {
    geometry: Geometry,
    /// Rows (e_i, t_i x e_i / n): lengths in half edges n of the mass keep forces and torques of one size.
    jacobian: SMatrix<f64, LIMBS, 6>,
    normal: Matrix6<f64>,
    /// Its inverse.
    inverse: Matrix6<f64>,
    mass: Matrix6<f64>,
    tensor_m2: DMat3,
    compliance_s2: f64,
}

/// Harmonic motion of the shell: amplitudes in shell axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excitation {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of a, m/s^2.
    pub linear_shell_m_s2: DVec3,
    /// Amplitude of alpha, rad/s^2.
    pub angular_shell_rad_s2: DVec3,
}

/// Amplitudes of nine forces, or the forces of one instant, and what moves them. Without damping all are in phase with the
/// shell's acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// f_i/m, positive in compression, m/s^2.
    pub force_per_mass_m_s2: [f64; LIMBS],
    /// d(f_i/m) / d ln(k/m), m/s^2.
    pub by_log_stiffness_m_s2: [f64; LIMBS],
    /// d(f_i/m) / d(I_j/m) in the paper's order, m/s^2 over m^2.
    pub by_inertia: [[f64; LIMBS]; INERTIAS],
}

impl LinearSensor {
    /// From the drawing, I/m and k/m.
    ///
    /// # Errors
    /// Those of [`Geometry::validate`] and [`InertiaPerMass::validate`]; [`Error::OutOfRange`] for a k/m that is not
    /// positive and finite.
    pub fn new(
        geometry: &Geometry,
        inertia_per_mass: &InertiaPerMass,
        stiffness_per_mass_per_s2: f64,
    ) -> Result<Self> {
        geometry.validate()?;
        inertia_per_mass.validate()?;
        let compliance_s2 = 1.0 / stiffness_per_mass_per_s2;
        require(
            compliance_s2.is_normal() && compliance_s2 > 0.0,
            "stiffness_per_mass_per_s2",
            stiffness_per_mass_per_s2,
            "positive and finite",
        )?;
        let half_edge_m = geometry.half_edge_m;
        let jacobian = limb_jacobian();
        let mut mass = inertia_part(&inertia_per_mass.to_paper_order());
        mass /= half_edge_m * half_edge_m;
        for axis in 0..3 {
            mass[(axis, axis)] = 1.0;
        }
        let normal = jacobian.transpose() * jacobian;
        Ok(Self {
            geometry: *geometry,
            inverse: normal.try_inverse().ok_or(Error::NotConverged {
                what: "inverse of J^T J",
                iterations: 0,
            })?,
            normal,
            jacobian,
            mass,
            tensor_m2: inertia_per_mass.matrix_mass_m2(),
            compliance_s2,
        })
    }

    /// Response to a harmonic motion of the shell.
    ///
    /// At frequency 0, equals the static share f/m = J (J^T J)^-1 (a; (I/m) alpha).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a frequency that is negative or not below the lowest mode, from where on this system
    /// without damping says nothing of a real one, or an amplitude that is not finite.
    pub fn response(&self, excitation: &Excitation) -> Result<Response> {
        let frequency_hz = excitation.frequency_hz;
        let omega = TAU * frequency_hz;
        let stretch = self.compliance_s2 * omega * omega;
        let (a, alpha) = (
            excitation.linear_shell_m_s2,
            excitation.angular_shell_rad_s2,
        );
        require(
            a.is_finite() && alpha.is_finite(),
            "excitation",
            a.element_sum() + alpha.element_sum(),
            "finite",
        )?;
        // Positive definite below the lowest mode and only there; NaN is not.
        let dynamic = Cholesky::new(self.normal - self.mass * stretch)
            .filter(|_| frequency_hz >= 0.0)
            .ok_or(Error::out_of_range(
                "frequency_hz",
                frequency_hz,
                "not negative and below the sensor's lowest mode",
            ))?;
        let n = self.geometry.half_edge_m;
        let shell = stacked(a, alpha * n);
        let load = dynamic.solve(&(self.mass * shell));
        let moved = dynamic.solve(&(self.mass * load));
        // The mass's own acceleration in ground axes: what its inertia acts on.
        let whole = shell + load * stretch;
        Ok(Response {
            force_per_mass_m_s2: (self.jacobian * load).into(),
            by_log_stiffness_m_s2: (self.jacobian * moved * -stretch).into(),
            by_inertia: core::array::from_fn(|entry| {
                let mut unit = [0.0; INERTIAS];
                unit[entry] = 1.0 / (n * n);
                (self.jacobian * dynamic.solve(&(inertia_part(&unit) * whole))).into()
            }),
        })
    }
}

/// I/m in the lower right of a 6 x 6 matrix, zero elsewhere.
fn inertia_part(paper_order: &[f64; INERTIAS]) -> Matrix6<f64> {
    let tensor = InertiaPerMass::from_paper_order(*paper_order).matrix_mass_m2();
    let mut part = Matrix6::zeros();
    part.fixed_view_mut::<3, 3>(3, 3).copy_from(&matrix(tensor));
    part
}

/// Information of several trials on all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    matrix: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    inertia_size_m2: f64,
}

/// Standard deviations of ln(k/m) that no unbiased estimate falls below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// k/m together with nine scale factors and six inertias.
    pub all_unknown: f64,
    /// k/m together with six inertias, the scale factors known.
    pub scale_known: f64,
    /// k/m alone, everything else known.
    pub all_else_known: f64,
}

impl Information {
    /// No information yet. `inertia_size_m2` is the size of I/m, any will do: it only keeps the numbers of one size.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a size that is not positive and finite.
    pub fn new(inertia_size_m2: f64) -> Result<Self> {
        require(
            inertia_size_m2.is_normal() && inertia_size_m2 > 0.0,
            "inertia_size_m2",
            inertia_size_m2,
            "positive and finite",
        )?;
        Ok(Self {
            matrix: SMatrix::zeros(),
            inertia_size_m2,
        })
    }

    /// Adds a trial of `samples` samples over whole periods with white noise of standard deviation `noise_m_s2` in the
    /// f/m of every channel.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for noise that is not positive and finite.
    pub fn push(&mut self, response: &Response, noise_m_s2: f64, samples: usize) -> Result<()> {
        // The mean square of a sine is a half.
        let weight = 0.5 * samples as f64 / square(noise_m_s2)?;
        for channel in 0..LIMBS {
            let row = self.row(response, channel);
            self.matrix += row * row.transpose() * weight;
        }
        Ok(())
    }

    /// Adds a trial of `samples` samples over whole periods from its forces at evenly spaced phases of one period
    /// ([`LinearSensor::tilted`]), with nine zero drifts of the trial's own unknown, too.
    ///
    /// # Errors
    /// As [`Self::push`]; [`Error::TooFewSamples`] below five phases, which do not tell the second harmonic from a constant.
    pub fn push_trial(
        &mut self,
        phases: &[Response],
        noise_m_s2: f64,
        samples: usize,
    ) -> Result<()> {
        const FEWEST: usize = 5;
        let count = phases.len();
        require_samples("phases of a period", FEWEST, count)?;
        let weight = samples as f64 / (count as f64 * square(noise_m_s2)?);
        for channel in 0..LIMBS {
            let rows = || phases.iter().map(|phase| self.row(phase, channel));
            let sum = rows().fold(SMatrix::<f64, UNKNOWNS, 1>::zeros(), |sum, row| sum + row);
            let mean = sum / count as f64;
            let information = rows().fold(SMatrix::zeros(), |sum, row| {
                // An unknown constant takes the mean.
                let row = row - mean;
                sum + row * row.transpose()
            });
            self.matrix += information * weight;
        }
        Ok(())
    }

    /// Derivatives of one channel by all unknowns.
    fn row(&self, response: &Response, channel: usize) -> SMatrix<f64, UNKNOWNS, 1> {
        let mut row = SMatrix::zeros();
        row[0] = response.by_log_stiffness_m_s2[channel];
        row[1 + channel] = -response.force_per_mass_m_s2[channel];
        for (entry, by) in response.by_inertia.iter().enumerate() {
            row[1 + LIMBS + entry] = by[channel] * self.inertia_size_m2;
        }
        row
    }

    /// The bounds on ln(k/m).
    ///
    /// # Errors
    /// [`Error::RankDeficient`] when the trials leave an unknown open.
    pub fn bound(&self) -> Result<Bound> {
        let alone = self.matrix[(0, 0)];
        Ok(Bound {
            all_unknown: 1.0 / sqrt(self.left_of_first(|_| true)?),
            scale_known: 1.0 / sqrt(self.left_of_first(|unknown| unknown > LIMBS)?),
            all_else_known: 1.0 / sqrt(alone),
        })
    }

    /// The bound on ln(k/m) together with nine scale factors, the inertias known: linear motion alone does not show them.
    ///
    /// # Errors
    /// As [`Self::bound`].
    pub fn bound_with_inertia_known(&self) -> Result<f64> {
        Ok(1.0 / sqrt(self.left_of_first(|unknown| unknown <= LIMBS)?))
    }

    /// Information on the first unknown that is left when those others that are `open` are unknown: the square of the
    /// last pivot of a Cholesky factor in which it comes last.
    fn left_of_first(&self, open: impl Fn(usize) -> bool) -> Result<f64> {
        let last = UNKNOWNS - 1;
        // Of unit diagonal, the first unknown last; an unknown that is known is a row of its own.
        let mut scaled = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        let at = |unknown: usize| if unknown == 0 { last } else { unknown - 1 };
        let asked = |unknown: usize| unknown == 0 || open(unknown);
        for row in (0..UNKNOWNS).filter(|&u| asked(u)) {
            for column in (0..UNKNOWNS).filter(|&u| asked(u)) {
                let size = sqrt(self.matrix[(row, row)]) * sqrt(self.matrix[(column, column)]);
                scaled[(at(row), at(column))] = self.matrix[(row, column)] / size;
            }
        }
        let pivot = Cholesky::new(scaled).map_or(0.0, |factor| factor.l_dirty()[(last, last)]);
        let share = pivot * pivot;
        if share > SINGULAR {
            return Ok(share * self.matrix[(0, 0)]);
        }
        let mut lost_direction = [0.0; LIMBS];
        lost_direction[0] = 1.0;
        Err(Error::RankDeficient {
            what: "bound of stiffness per mass",
            unknowns: UNKNOWNS,
            rank: UNKNOWNS - 1,
            condition: 1.0 / sqrt(share),
            lost_direction,
        })
    }
}

fn square(noise_m_s2: f64) -> Result<f64> {
    let square = noise_m_s2 * noise_m_s2;
    require(
        noise_m_s2 > 0.0 && square.is_normal(),
        "noise_m_s2",
        noise_m_s2,
        "positive and finite, and its square, too",
    )?;
    Ok(square)
}

/// Share of the information on k/m, left after all other unknowns, that is no more than rounding.
const SINGULAR: f64 = 1e3 * f64::EPSILON;
