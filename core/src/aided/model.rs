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
use crate::columns::{column, cross, matrix};
use crate::decouple::uncertainty::ChannelNoise;
use crate::error::Result;
use crate::float::sqrt;
use crate::geometry::{DIRECTIONS_SHELL, LIMBS};
use crate::limb_set::LimbSet;
use crate::model::{InertiaPerMass, Model, Parameters, Sensor, Settings};
use crate::paper::attitude;
use crate::paper::preload::hidden_preload_m_s2;
use crate::paper::signal::SignalChain;
use crate::parameter::{DRIFT, INERTIA, SCALE};
use crate::redundancy::reconstruction::Reconstruction;

/// Errors that have dynamics: attitude, rate, velocity.
pub const DYNAMIC: usize = 9;
/// Parameters whose errors matter: all but the stiffness.
pub const PARAMETRIC: usize = INERTIA.end;
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

/// A sensor's errors.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    chain: SignalChain,
    scale_per_mass_per_kg: [f64; LIMBS],
    arms_m: [DVec3; LIMBS],
    stiffness_ratio: [f64; LIMBS],
    excluded: LimbSet,
    /// Force and torque, shell axes, per force of each limb: its own and, as those are made of it, that of the excluded ones.
    wrench: [[DVec3; 2]; LIMBS],
    preload_force: DVec3,
    tensor: DMat3,
    inverse: DMat3,
    /// Spectral densities, per s, of each channel's noise, V^2.
    noise_v2_s: [f64; LIMBS],
    /// Spectral densities, per s, of the noise in w*' and f: 6 by 6.
    density: SMatrix<f64, 6, 6>,
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
    /// Of the sensor that a decoupler is made for.
    ///
    /// # Errors
    /// Those of [`Model::new`]; [`crate::Error::NotConverged`] if gravity finds no equilibrium.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        noise: &ChannelNoise,
    ) -> Result<Self> {
        let preload = hidden_preload_m_s2(&Model::new(sensor, parameters, settings)?)?;
        let chain = SignalChain::new(&sensor.gains, parameters);
        let tensor = parameters.inertia_per_mass.matrix_mass_m2();
        let inverse = tensor.inverse();
        let arms_m = sensor.geometry.arms_m();
        let mut model = Self {
            scale_per_mass_per_kg: parameters.scale_per_mass_per_kg,
            arms_m,
            stiffness_ratio: settings.stiffness_ratio,
            excluded: LimbSet::EMPTY,
            wrench: [[DVec3::ZERO; 2]; LIMBS],
            preload_force: (0..LIMBS).map(|i| DIRECTIONS_SHELL[i] * preload[i]).sum(),
            tensor,
            inverse,
            noise_v2_s: noise.white_v.map(|sd| sd * sd / settings.sample_rate_hz),
            density: SMatrix::zeros(),
            chain,
        };
        model.set_excluded(LimbSet::EMPTY)?;
        Ok(model)
    }

    /// Limbs whose channels are not read: their forces are made of those of the others, and so are their errors.
    ///
    /// # Errors
    /// Those of [`Reconstruction::new`].
    pub fn set_excluded(&mut self, limbs: LimbSet) -> Result<()> {
        let reconstruction = Reconstruction::new(limbs)?.with_stiffness(&self.stiffness_ratio);
        self.wrench = reconstruction.wrenches(&self.arms_m);
        self.excluded = limbs;
        self.density = SMatrix::zeros();
        let sensitivities = self.chain.sensitivity_m_s2_per_v();
        for ((wrench, sensitivity), noise) in
            self.wrench.iter().zip(sensitivities).zip(self.noise_v2_s)
        {
            let angular = column(self.inverse * wrench[1] * *sensitivity);
            let linear = column(wrench[0] * *sensitivity);
            let both =
                SMatrix::<f64, 6, 1>::from_fn(
                    |i, _| {
                        if i < 3 { angular[i] } else { linear[i - 3] }
                    },
                );
            self.density += both * both.transpose() * noise;
        }
        Ok(())
    }

    /// Limbs whose channels are not read.
    #[must_use]
    pub const fn excluded(&self) -> LimbSet {
        self.excluded
    }

    /// Forces of the limbs over the mass, m/s^2, of those that are excluded none: theirs are in the others' wrench.
    fn sensed(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        let mut sensed = self.chain.force_per_mass_m_s2(voltage_v);
        for (limb, force) in sensed.iter_mut().enumerate() {
            if self.excluded.contains(limb) {
                *force = 0.0;
            }
        }
        sensed
    }

    /// Change of the zero drifts that changes the specific force by this, m/s^2, and no torque: as if the limbs bore it, so that it is the same
    /// without the channels of some.
    pub(super) fn drift_of_force(&self) -> SMatrix<f64, LIMBS, 3> {
        let wrench = SMatrix::<f64, 6, LIMBS>::from_fn(|row, limb| {
            if row < 3 {
                DIRECTIONS_SHELL[limb][row]
            } else {
                self.arms_m[limb][row - 3] / sqrt(self.tensor.col(0)[0])
            }
        });
        let gram = wrench * wrench.transpose();
        let pure = SMatrix::<f64, 6, 3>::from_fn(|i, j| if i == j { 1.0 } else { 0.0 });
        let forces = gram.try_inverse().map_or_else(SMatrix::zeros, |inverse| {
            wrench.transpose() * inverse * pure
        });
        SMatrix::from_fn(|limb, axis| {
            -forces[(limb, axis)] / self.chain.sensitivity_m_s2_per_v()[limb]
        })
    }

    /// How far the channels' noise lets rate, rad/s, and velocity, m/s, walk in a time: standard deviation of the component that walks most.
    #[must_use]
    pub fn walks(&self, time_s: f64) -> [f64; 2] {
        let variance = self.density.diagonal() * time_s;
        let most = |from: usize| sqrt(variance.fixed_rows::<3>(from).max());
        [most(0), most(3)]
    }

    /// R^T (a - g) of mean voltages, shell axes, m/s^2, but for the mass's own motion in the shell.
    fn specific_force(&self, voltage_v: &[f64; LIMBS]) -> DVec3 {
        let sensed = self.sensed(voltage_v);
        let shown: DVec3 = (0..LIMBS).map(|i| self.wrench[i][0] * sensed[i]).sum();
        self.preload_force + shown
    }

    /// Errors of w*' and f, shell axes, by the parameters' errors, at once.
    fn at_once(&self, block: &Block, derivative: DVec3) -> [SMatrix<f64, 3, PARAMETRIC>; 2] {
        let sensed = self.sensed(&block.voltage_v);
        let mut angular = SMatrix::<f64, 3, PARAMETRIC>::zeros();
        let mut linear = SMatrix::<f64, 3, PARAMETRIC>::zeros();
        let rate = block.rate_shell_rad_s;
        for (limb, [force, torque]) in self.wrench.into_iter().enumerate() {
            let shares = [
                (
                    DRIFT.start + limb,
                    -self.chain.sensitivity_m_s2_per_v()[limb],
                ),
                (
                    SCALE.start + limb,
                    sensed[limb] / self.scale_per_mass_per_kg[limb],
                ),
            ];
            for (place, share) in shares {
                angular.set_column(place, &column(self.inverse * torque * share));
                linear.set_column(place, &column(force * share));
            }
        }
        for entry in 0..INERTIA.len() {
            let unit = InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
                if i == entry { 1.0 } else { 0.0 }
            }))
            .matrix_mass_m2();
            let lacking = unit * derivative + rate.cross(unit * rate);
            angular.set_column(INERTIA.start + entry, &column(self.inverse * -lacking));
        }
        [angular, linear]
    }

    /// d(dw*')/d(dw*).
    fn gyroscopic(&self, rate: DVec3) -> DMat3 {
        self.inverse * (cross(self.tensor * rate) - cross(rate) * self.tensor)
    }

    /// What one block does to the errors.
    #[must_use]
    pub fn transition(&self, block: &Block) -> Transition {
        let h = block.duration_s;
        let rate = block.rate_shell_rad_s;
        // In its middle.
        let turned = block.attitude * attitude::exp(rate * (-0.5 * h));
        let r = DMat3::from_quat(turned);
        let force_ground = r * self.specific_force(&block.voltage_v);
        let [angular, linear] = self.at_once(block, turned.inverse() * block.angular_ground_rad_s2);
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
            noise: self.noise(&matrix(r), h),
        }
    }

    /// White noise over a block: an integral of it in rate and velocity, a second one in attitude.
    fn noise(&self, r: &SMatrix<f64, 3, 3>, h: f64) -> Dynamics {
        let of = |row, column| self.density.fixed_view::<3, 3>(row, column).into_owned();
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

    /// Errors of a and w', ground axes, by the errors after a block.
    #[must_use]
    pub fn shown(&self, block: &Block) -> SMatrix<f64, 6, ERRORS> {
        let r = DMat3::from_quat(block.attitude);
        let force_ground = r * self.specific_force(&block.voltage_v);
        let rate = block.rate_shell_rad_s;
        let derivative = block.attitude.inverse() * block.angular_ground_rad_s2;
        let [angular, linear] = self.at_once(block, derivative);
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
