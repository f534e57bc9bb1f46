//! What errors have done to attitude and velocity in second order.
//!
//! An error of the attitude of 0.1 rad bends gravity by 5 cm/s^2 into the velocity, which a rest tells to a millimetre a second. With R
//! the decoded attitude, exp(\[psi\]x) times the true one, an error e_w of the rate and the decoded specific force F in ground axes,
//!
//! ```text
//! psi' = R e_w - psi x R e_w / 2        v' = psi x F - psi x (psi x F) / 2,
//! ```
//!
//! of which the filter knows the terms of first order. Integrals of the others, psi's own second order being part of psi x F, are
//! quadratic forms of attitude's and rate's errors. Those of a block earlier are what the present ones say of them, z_before = B z with
//! B = E\[z_before z^T\] E\[z z^T\]^-1, which carries a form on: Q becomes B^T Q B.

use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, SMatrix, SVector};

use super::model::{ATTITUDE, DYNAMIC, Dynamics, ERRORS, RATE, VELOCITY, times};
use crate::columns::{cross, matrix};
use crate::float::sqrt;

/// Errors that bend: attitude and rate.
pub(super) const BENT_BY: usize = 6;
/// Added to the correlation of each error with itself: some are known by others.
const JITTER: f64 = 1e-9;
/// Attitude beyond which second order says nothing either, rad.
const LARGEST_RAD: f64 = 1.0;

/// z^T Q z of attitude's and rate's errors z.
pub(super) type Form = SMatrix<f64, BENT_BY, BENT_BY>;

/// Those that bend, of all errors.
pub(super) fn errors(all: &SVector<f64, ERRORS>) -> SVector<f64, BENT_BY> {
    all.fixed_rows::<BENT_BY>(0).into_owned()
}

/// Their covariance.
pub(super) fn covariance(all: &SMatrix<f64, ERRORS, ERRORS>) -> Form {
    all.fixed_view::<BENT_BY, BENT_BY>(0, 0).into_owned()
}

/// Since each was measured last, a form of each component.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bending {
    attitude_rad: [Form; 3],
    velocity_m_s: [Form; 3],
}

impl Bending {
    /// Nothing yet.
    pub(super) fn none() -> Self {
        Self {
            attitude_rad: [Form::zeros(); 3],
            velocity_m_s: [Form::zeros(); 3],
        }
    }

    /// What present errors do in a time, R and F being as they are.
    pub(super) fn grow(&mut self, to_ground: DMat3, force_ground: DVec3, time_s: f64) {
        let force = force_ground;
        for (axis, form) in DVec3::AXES.into_iter().zip(&mut self.velocity_m_s) {
            // psi x F along the axis is psi (F x axis); the double product, (axis psi) (psi F) - (axis F) psi^2.
            let of_attitude = force.cross(axis) * time_s;
            for (j, attitude) in self.attitude_rad.iter().enumerate() {
                *form += attitude * of_attitude[j];
            }
            for i in 0..3 {
                for j in 0..3 {
                    let both = axis[i] * force[j] + force[i] * axis[j];
                    form[(i, j)] -= 0.25 * time_s * both;
                }
                form[(i, i)] += 0.5 * time_s * axis.dot(force);
            }
        }
        for (axis, form) in DVec3::AXES.into_iter().zip(&mut self.attitude_rad) {
            // psi x R e_w along the axis is -psi (axis x R e_w).
            let share = matrix(cross(axis) * to_ground) * (0.25 * time_s);
            let mut block = form.fixed_view_mut::<3, 3>(ATTITUDE, RATE);
            block += share;
            let mut block = form.fixed_view_mut::<3, 3>(RATE, ATTITUDE);
            block += share.transpose();
        }
    }

    /// From errors before a block to those after it, by E\[z z_before^T\] and E\[z z^T\].
    pub(super) fn carry(&mut self, with_before: &Form, now: &Form) {
        let over_deviation = SVector::<f64, BENT_BY>::from_fn(|i, _| {
            if now[(i, i)] > 0.0 {
                1.0 / sqrt(now[(i, i)])
            } else {
                0.0
            }
        });
        let correlation = Form::from_fn(|i, j| {
            let own = if i == j { JITTER } else { 0.0 };
            over_deviation[i] * now[(i, j)] * over_deviation[j] + own
        });
        let Some(correlation) = Cholesky::new(correlation) else {
            *self = Self::none();
            return;
        };
        let mut solved = Form::from_fn(|i, j| over_deviation[i] * with_before[(i, j)]);
        correlation.solve_mut(&mut solved);
        let before = Form::from_fn(|i, j| over_deviation[j] * solved[(j, i)]);
        let transposed = before.transpose();
        for form in self.attitude_rad.iter_mut().chain(&mut self.velocity_m_s) {
            *form = times(&times(&transposed, form), &before);
        }
    }

    fn forms(&self) -> impl Iterator<Item = (usize, &Form)> {
        let attitude = (ATTITUDE..).zip(&self.attitude_rad);
        attitude.chain((VELOCITY..).zip(&self.velocity_m_s))
    }

    /// What such errors have done to those that have dynamics.
    pub(super) fn of(&self, errors: &SVector<f64, BENT_BY>) -> SVector<f64, DYNAMIC> {
        let mut done = SVector::zeros();
        if is_small(errors) {
            for (place, form) in self.forms() {
                done[place] = errors.dot(&(form * errors));
            }
        }
        done
    }

    /// Errors that are left about these, once they have been found and taken off, by those of first order: to second order, what they
    /// have done goes with what was found.
    pub(super) fn about(&self, errors: &SVector<f64, BENT_BY>) -> Dynamics {
        let mut about = Dynamics::identity();
        if is_small(errors) {
            for (place, form) in self.forms() {
                let mut row = about.fixed_view_mut::<1, BENT_BY>(place, ATTITUDE);
                row += (form * errors).transpose() * 2.0;
            }
        }
        about
    }

    /// Mean square of what has been done to the velocity, m^2/s^2, along the axis that has most of it, by the covariance of z.
    pub(super) fn variance_m2_s2(&self, now: &Form) -> f64 {
        self.velocity_m_s
            .iter()
            .map(|form| {
                let by = times(form, now);
                2.0 * times(&by, &by).trace() + by.trace() * by.trace()
            })
            .fold(0.0, f64::max)
    }

    /// Three errors have been measured: what was done to them until then is taken to be known, however well that was.
    pub(super) fn measured(&mut self, place: usize) {
        match place {
            ATTITUDE => self.attitude_rad = [Form::zeros(); 3],
            VELOCITY => self.velocity_m_s = [Form::zeros(); 3],
            _ => {}
        }
    }
}

fn is_small(errors: &SVector<f64, BENT_BY>) -> bool {
    errors.fixed_rows::<3>(ATTITUDE).norm_squared() < LARGEST_RAD * LARGEST_RAD
}
