//! How errors grow from one block of samples to the next, to first order.
//!
//! With f the specific force and w the rate in shell axes, d_w' the errors of parameters in w*' at once and d_f those in f,
//!
//! ```text
//! psi' = R dw
//! dw'  = (I/m)^-1 ([I/m w]x - [w]x I/m) dw + d_w'
//! dv'  = psi x R f + R d_f.
//! ```
//!
//! Attitude in ground axes and rate in shell axes leave next to nothing on the diagonal, a cube's inertias being nearly equal, so that
//! a series of second order keeps its length over hours.

use glam::{DMat3, DVec3};
use nalgebra::SMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::block::Block;
use crate::columns::{cross, matrix};
pub use crate::decouple::uncertainty::error_model::{ErrorModel, PARAMETRIC};
use crate::geometry::LIMBS;
use crate::paper::attitude;

/// Errors that have dynamics: attitude, rate, velocity.
pub const DYNAMIC: usize = 9;
/// Place of the attitude's error.
pub const ATTITUDE: usize = 0;
/// Place of the rate's.
pub const RATE: usize = 3;
/// Place of the velocity's.
pub const VELOCITY: usize = 6;

/// Changes of dynamic errors with dynamic ones.
pub type Dynamics = SMatrix<f64, DYNAMIC, DYNAMIC>;
/// Changes of dynamic errors with those of parameters.
pub type Drives = SMatrix<f64, DYNAMIC, PARAMETRIC>;

/// All errors.
pub const ERRORS: usize = DYNAMIC + PARAMETRIC;

/// One block's part in the errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// Dynamic errors at the block's end by all those at its beginning.
    pub by_errors: SMatrix<f64, DYNAMIC, ERRORS>,
    /// Covariance that the channels' noise adds.
    pub noise: Dynamics,
}

/// a b, column by column, in the widest registers of the processor: the same bits in all.
pub(super) fn times<const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<f64, R, K>,
    b: &SMatrix<f64, K, C>,
) -> SMatrix<f64, R, C> {
    Arch::new().dispatch(Product(a, b))
}

struct Product<'a, const R: usize, const K: usize, const C: usize>(
    &'a SMatrix<f64, R, K>,
    &'a SMatrix<f64, K, C>,
);

impl<const R: usize, const K: usize, const C: usize> WithSimd for Product<'_, R, K, C> {
    type Output = SMatrix<f64, R, C>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> SMatrix<f64, R, C> {
        let Self(a, b) = self;
        let mut product = SMatrix::<f64, R, C>::zeros();
        for (kept, of_b) in product.data.0.iter_mut().zip(&b.data.0) {
            let mut sum = [0.0; R];
            for (of_a, factor) in a.data.0.iter().zip(of_b) {
                for i in 0..R {
                    sum[i] += of_a[i] * factor;
                }
            }
            *kept = sum;
        }
        product
    }
}

impl ErrorModel {
    /// What one block does to the errors.
    #[must_use]
    pub fn transition(&self, block: &Block) -> Transition {
        self.transition_by_noise(block, &self.density)
    }

    /// The same where the integrals of the channels' noise have more variance than of white noise, by these times, s, over it.
    pub(super) fn transition_with(&self, block: &Block, more_s: &[f64; LIMBS]) -> Transition {
        let mut density = self.density;
        for ((column, more_s), noise) in
            (self.per_volt.column_iter().zip(more_s)).zip(self.noise_v2_s)
        {
            density += column * column.transpose() * (noise * more_s / block.duration_s);
        }
        self.transition_by_noise(block, &density)
    }

    fn transition_by_noise(&self, block: &Block, density: &SMatrix<f64, 6, 6>) -> Transition {
        let h = block.duration_s;
        let rate = block.rate_shell_rad_s;
        // In its middle.
        let turned = block.attitude * attitude::exp(rate * (-0.5 * h));
        let r = DMat3::from_quat(turned);
        let force_ground = r * self.specific_force(&block.voltage_v);
        let derivative = turned.inverse() * block.angular_ground_rad_s2;
        let [angular, linear] = self.at_once(&block.voltage_v, rate, derivative);
        let mut n = Dynamics::zeros();
        let mut put = |row: usize, column: usize, m: DMat3| {
            n.fixed_view_mut::<3, 3>(row, column)
                .copy_from(&(matrix(m) * h));
        };
        put(ATTITUDE, RATE, r);
        put(RATE, RATE, self.gyroscopic(rate));
        put(VELOCITY, ATTITUDE, -cross(force_ground));
        let one = Dynamics::identity();
        let square = times(&n, &n);
        let mut drives = Drives::zeros();
        drives
            .fixed_view_mut::<3, PARAMETRIC>(RATE, 0)
            .copy_from(&(angular * h));
        drives
            .fixed_view_mut::<3, PARAMETRIC>(VELOCITY, 0)
            .copy_from(&(times(&matrix(r), &linear) * h));
        let driven = times(&(one + n * 0.5 + square * (1.0 / 6.0)), &drives);
        let mut by_errors = SMatrix::<f64, DYNAMIC, ERRORS>::zeros();
        by_errors
            .fixed_columns_mut::<DYNAMIC>(0)
            .copy_from(&(one + n + square * 0.5));
        by_errors
            .fixed_columns_mut::<PARAMETRIC>(DYNAMIC)
            .copy_from(&driven);
        Transition {
            by_errors,
            noise: noise(density, &matrix(r), h),
        }
    }

    /// Covariance that a block adds of the dynamic errors with zeros that wander, by the noise that both integrate: a zero that walks up is one
    /// that is taken for too low.
    pub(super) fn shared(
        &self,
        block: &Block,
        shared: &[f64; LIMBS],
    ) -> SMatrix<f64, DYNAMIC, LIMBS> {
        let h = block.duration_s;
        let turned = block.attitude * attitude::exp(block.rate_shell_rad_s * (-0.5 * h));
        let r = matrix(DMat3::from_quat(turned));
        let mut per_volt = self.per_volt;
        for ((mut column, shared), noise) in
            (per_volt.column_iter_mut().zip(shared)).zip(self.noise_v2_s)
        {
            column *= -shared * noise;
        }
        let angular = per_volt.fixed_rows::<3>(0).into_owned();
        let linear = per_volt.fixed_rows::<3>(3).into_owned();
        let mut shared = SMatrix::<f64, DYNAMIC, LIMBS>::zeros();
        shared
            .fixed_rows_mut::<3>(ATTITUDE)
            .copy_from(&(times(&r, &angular) * (0.5 * h)));
        shared.fixed_rows_mut::<3>(RATE).copy_from(&angular);
        shared
            .fixed_rows_mut::<3>(VELOCITY)
            .copy_from(&times(&r, &linear));
        shared
    }

    /// Errors of a and w', ground axes, by the errors after a block.
    #[must_use]
    pub fn shown(&self, block: &Block) -> SMatrix<f64, 6, ERRORS> {
        let r = DMat3::from_quat(block.attitude);
        let force_ground = r * self.specific_force(&block.voltage_v);
        let rate = block.rate_shell_rad_s;
        let derivative = block.attitude.inverse() * block.angular_ground_rad_s2;
        let [angular, linear] = self.at_once(&block.voltage_v, rate, derivative);
        let turned = matrix(r);
        let mut shown = SMatrix::<f64, 6, ERRORS>::zeros();
        let mut put = |row: usize, column: usize, m: DMat3| {
            shown
                .fixed_view_mut::<3, 3>(row, column)
                .copy_from(&matrix(m));
        };
        put(0, ATTITUDE, -cross(force_ground));
        put(3, ATTITUDE, -cross(block.angular_ground_rad_s2));
        put(3, RATE, r * self.gyroscopic(rate));
        shown
            .fixed_view_mut::<3, PARAMETRIC>(0, DYNAMIC)
            .copy_from(&times(&turned, &linear));
        shown
            .fixed_view_mut::<3, PARAMETRIC>(3, DYNAMIC)
            .copy_from(&times(&turned, &angular));
        shown
    }

    /// Specific force, m/s^2, and w', rad/s^2, in ground axes after a block: what an error of the attitude turns.
    #[must_use]
    pub fn turned(&self, block: &Block) -> [DVec3; 2] {
        let force = block.attitude * self.specific_force(&block.voltage_v);
        [force, block.angular_ground_rad_s2]
    }
}

/// White noise of a density over a block: an integral of it in rate and velocity, a second one in attitude.
fn noise(density: &SMatrix<f64, 6, 6>, r: &SMatrix<f64, 3, 3>, h: f64) -> Dynamics {
    let of = |row, column| density.fixed_view::<3, 3>(row, column).into_owned();
    let (angular, linear, both) = (of(0, 0), of(3, 3), of(3, 0));
    let mut q = Dynamics::zeros();
    let mut put = |row: usize, column: usize, m: SMatrix<f64, 3, 3>| {
        q.fixed_view_mut::<3, 3>(row, column).copy_from(&m);
        q.fixed_view_mut::<3, 3>(column, row)
            .copy_from(&m.transpose());
    };
    put(
        ATTITUDE,
        ATTITUDE,
        r * angular * r.transpose() * (h * h * h / 3.0),
    );
    put(ATTITUDE, RATE, r * angular * (0.5 * h * h));
    put(RATE, RATE, angular * h);
    put(VELOCITY, VELOCITY, r * linear * r.transpose() * h);
    put(VELOCITY, RATE, r * both * h);
    put(VELOCITY, ATTITUDE, r * both * r.transpose() * (0.5 * h * h));
    q
}
