//! What errors do at once, to first order: force and torque on the mass, (8) and (9), and how parameters and rate change them.
//!
//! In shell axes, with f the specific force R^T (a - g), tau the limbs' torque over the mass and w* the rate, errors of the parameters
//! make d f and d tau, and
//!
//! ```text
//! dw*' = (I/m)^-1 (d tau - dI w*' - w* x dI w* + ([I/m w*]x - [w*]x I/m) dw*).
//! ```
//!
//! [`super::samples`] carries that from sample to sample by the decoupler's own scheme, and [`crate::aided::model`] over blocks of
//! samples. Neglected is compliance, some six millionths of the largest force at 5 Hz.

use glam::{DMat3, DVec3};
use nalgebra::SMatrix;

use crate::columns::{column, cross};
use crate::error::Result;
use crate::float::sqrt;
use crate::geometry::{DIRECTIONS_SHELL, LIMBS};
use crate::limb_set::LimbSet;
use crate::model::{InertiaPerMass, Model, Parameters, Sensor, Settings};
use crate::paper::preload::hidden_preload_m_s2;
use crate::paper::signal::SignalChain;
use crate::parameter::{DRIFT, INERTIA, SCALE};
use crate::redundancy::reconstruction::Reconstruction;

/// Parameters whose errors matter: all but the stiffness.
pub const PARAMETRIC: usize = INERTIA.end;

/// Noise of the nine voltages as the decoupler sees them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelNoise {
    /// Standard deviation of the white noise of one sample, before any filter, V.
    pub white_v: [f64; LIMBS],
    /// Correlation, over the white variance, of a sample with itself, its neighbour and the one after it: what a filter
    /// without gain at zero frequency makes of white noise. 1, 0, 0 without one.
    pub correlation: [f64; 3],
}

impl ChannelNoise {
    /// Noise that no filter has changed.
    #[must_use]
    pub const fn white(white_v: [f64; LIMBS]) -> Self {
        Self {
            white_v,
            correlation: [1.0, 0.0, 0.0],
        }
    }
}

/// A sensor's errors.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    pub(super) chain: SignalChain,
    scale_per_mass_per_kg: [f64; LIMBS],
    arms_m: [DVec3; LIMBS],
    stiffness_ratio: [f64; LIMBS],
    excluded: LimbSet,
    /// Force and torque, shell axes, per force of each limb: its own and, as those are made of it, that of the excluded ones.
    pub(super) wrench: [[DVec3; 2]; LIMBS],
    pub(super) preload_force: DVec3,
    tensor: DMat3,
    pub(super) inverse: DMat3,
    /// Spectral densities, per s, of each channel's noise, V^2.
    pub(crate) noise_v2_s: [f64; LIMBS],
    /// Spectral densities, per s, of the noise in w*' and f: 6 by 6.
    pub(crate) density: SMatrix<f64, 6, 6>,
    /// w*', rad/s^2, and f, m/s^2, per volt of each channel.
    pub(crate) per_volt: SMatrix<f64, 6, LIMBS>,
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
            per_volt: SMatrix::zeros(),
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
        for (limb, ((wrench, sensitivity), noise)) in
            (self.wrench.iter().zip(sensitivities).zip(self.noise_v2_s)).enumerate()
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
            self.per_volt.set_column(limb, &both);
        }
        Ok(())
    }

    /// Limbs whose channels are not read.
    #[must_use]
    pub const fn excluded(&self) -> LimbSet {
        self.excluded
    }

    /// Forces of the limbs over the mass, m/s^2, of those that are excluded none: theirs are in the others' wrench.
    pub(super) fn sensed(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
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
    pub(crate) fn drift_of_force(&self) -> SMatrix<f64, LIMBS, 3> {
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

    /// R^T (a - g), shell axes, m/s^2, but for the mass's own motion in the shell.
    pub(crate) fn specific_force(&self, voltage_v: &[f64; LIMBS]) -> DVec3 {
        let sensed = self.sensed(voltage_v);
        let shown: DVec3 = (0..LIMBS).map(|i| self.wrench[i][0] * sensed[i]).sum();
        self.preload_force + shown
    }

    /// Errors of w*' and f, shell axes, by the parameters' errors, at once.
    pub(crate) fn at_once(
        &self,
        voltage_v: &[f64; LIMBS],
        rate: DVec3,
        derivative: DVec3,
    ) -> [SMatrix<f64, 3, PARAMETRIC>; 2] {
        let sensed = self.sensed(voltage_v);
        let mut angular = SMatrix::<f64, 3, PARAMETRIC>::zeros();
        let mut linear = SMatrix::<f64, 3, PARAMETRIC>::zeros();
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
    pub(crate) fn gyroscopic(&self, rate: DVec3) -> DMat3 {
        self.inverse * (cross(self.tensor * rate) - cross(rate) * self.tensor)
    }
}
