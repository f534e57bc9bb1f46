//! Sensors tumbled in the field after a calibration that no longer holds, and what their rows say of it.

use crate::truth;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::redundancy::self_calibration::{Limits, Moments, ScaleRatios};
use sixaxis_core::{Gains, Geometry, LIMBS, Parameters, Result, Sensor, Settings};
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::rig::field::{Field, Pace};
use sixaxis_reference::rigid::{Load, RigidSensor};

/// Noise of one sample over its channel's peak: the 0.33 %.
pub const NOISE_SHARE: f64 = 0.0033;
/// Samples per second of a field recording.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// Standard deviation of the scale factors' drift since the calibration.
pub const DRIFT: f64 = 5e-3;
/// Standard deviation of the zero drifts' change since then, V.
const ZERO_DRIFT_V: f64 = 5e-3;
/// Random streams.
const SENSOR_STREAM: u128 = 11;
const NOISE_STREAM: u128 = 12;

/// One sensor in the field.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Seed of everything.
    pub seed: u64,
    /// The sensor as it is.
    pub truth: Parameters,
    /// As it was calibrated.
    pub calibration: Parameters,
    /// Amplifier ranges.
    pub gains: Gains,
    /// The motion.
    pub field: Field,
    /// What it asks of the limbs.
    pub loads: Vec<Load>,
    /// Limb forces per mass, m/s^2.
    pub forces: Vec<[f64; LIMBS]>,
}

/// Nine numbers of unit variance.
pub fn nine(rng: &mut Pcg64) -> [f64; LIMBS] {
    core::array::from_fn(|_| StandardNormal.sample(rng))
}

/// Nine numbers without their mean.
pub fn without_mean(values: [f64; LIMBS]) -> [f64; LIMBS] {
    let mean = values.iter().sum::<f64>() / LIMBS as f64;
    values.map(|value| value - mean)
}

impl Case {
    /// A random sensor whose scale factors have drifted, tumbled briskly by hand, with equally stiff limbs.
    ///
    /// # Panics
    /// Never: the paper's geometry holds its mass.
    pub fn random(seed: u64, duration_s: f64) -> Self {
        Self::of(seed, Pace::Brisk, duration_s, DRIFT)
    }

    /// The same at another pace and with another standard deviation of the drifts.
    ///
    /// # Panics
    /// Never.
    pub fn of(seed: u64, pace: Pace, duration_s: f64, drift: f64) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), SENSOR_STREAM);
        let truth = truth::random_parameters(&mut rng);
        let mut calibration = truth;
        for (scale, unit) in calibration
            .scale_per_mass_per_kg
            .iter_mut()
            .zip(nine(&mut rng))
        {
            *scale *= (-drift * unit).exp();
        }
        for (zero, unit) in calibration.zero_drift_v.iter_mut().zip(nine(&mut rng)) {
            *zero += ZERO_DRIFT_V * unit;
        }
        Self::tumbled(seed, truth, calibration, pace, duration_s, &mut rng)
    }

    /// A sensor that a laboratory has calibrated, tumbled briskly by hand.
    ///
    /// # Panics
    /// Never.
    pub fn calibrated(
        seed: u64,
        truth: Parameters,
        calibration: Parameters,
        duration_s: f64,
    ) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), SENSOR_STREAM);
        Self::tumbled(seed, truth, calibration, Pace::Brisk, duration_s, &mut rng)
    }

    fn tumbled(
        seed: u64,
        truth: Parameters,
        calibration: Parameters,
        pace: Pace,
        duration_s: f64,
        rng: &mut Pcg64,
    ) -> Self {
        let field = Field::by_hand(rng, pace, duration_s, SAMPLE_RATE_HZ);
        let sensor = truth::sensor(&truth);
        let (loads, motion) = field.simulate(&sensor);
        let forces = compliant_forces_m_s2(&sensor, field.gravity_ground_m_s2, &motion)
            .expect("the limbs hold the mass");
        let gains = truth::amplifier_ranges(&forces, &truth);
        Self {
            seed,
            truth,
            calibration,
            gains,
            field,
            loads,
            forces,
        }
    }

    /// The same motion with limbs of other stiffnesses, as shares of their mean; to first order.
    ///
    /// # Panics
    /// For limbs that do not hold the mass.
    #[must_use]
    pub fn with_stiffness(mut self, ratio: &[f64; LIMBS]) -> Self {
        let sensor =
            RigidSensor::new(&truth::sensor(&self.truth), ratio).expect("limbs that hold the mass");
        let loads = self.loads.iter();
        self.forces = loads.map(|load| sensor.forces_m_s2(load)).collect();
        self
    }

    /// What a laboratory knows of the sensor.
    pub fn sensor(&self) -> Sensor {
        Sensor {
            geometry: Geometry::PAPER,
            gains: self.gains,
        }
    }

    /// From rest, tared, under gravity.
    pub fn settings(&self) -> Settings {
        Settings {
            gravity_ground_m_s2: self.field.gravity_ground_m_s2,
            ..Settings::new(self.field.sample_rate_hz)
        }
    }

    /// ln of the true scale factors over the calibration's.
    pub fn true_ln_scale(&self) -> [f64; LIMBS] {
        core::array::from_fn(|i| {
            (self.truth.scale_per_mass_per_kg[i] / self.calibration.scale_per_mass_per_kg[i]).ln()
        })
    }

    /// The same without their mean.
    pub fn true_ln_ratio(&self) -> [f64; LIMBS] {
        without_mean(self.true_ln_scale())
    }

    /// Tared voltages without noise.
    pub fn voltage_v(&self) -> Vec<[f64; LIMBS]> {
        let sensor = truth::sensor(&self.truth);
        let gains = &self.gains.gain_n_per_v;
        let rest = self.forces.first().copied().unwrap_or_default();
        self.forces
            .iter()
            .map(|force| sensor.voltage_v(&core::array::from_fn(|i| force[i] - rest[i]), gains))
            .collect()
    }

    /// White noise of one sample of each channel, V, as a share of its peak.
    pub fn noise_v(&self, share: f64) -> [f64; LIMBS] {
        let clean = self.voltage_v();
        core::array::from_fn(|i| {
            share
                * clean
                    .iter()
                    .map(|u| (u[i] - clean[0][i]).abs())
                    .fold(0.0, f64::max)
        })
    }

    /// Voltages with white noise.
    pub fn noisy_v(&self, share: f64) -> Vec<[f64; LIMBS]> {
        let noise = self.noise_v(share);
        let mut rng = Pcg64::new(u128::from(self.seed), NOISE_STREAM);
        let mut voltage_v = self.voltage_v();
        for u in &mut voltage_v {
            for (u, (unit, size)) in u.iter_mut().zip(nine(&mut rng).into_iter().zip(noise)) {
                *u += size * unit;
            }
        }
        voltage_v
    }

    /// Moments of some voltages, with the usual blocks.
    ///
    /// # Errors
    /// Those of [`Moments::of`].
    pub fn moments(&self, voltage_v: &[[f64; LIMBS]]) -> Result<Moments> {
        Moments::of(
            &self.sensor(),
            &self.calibration,
            &self.settings(),
            voltage_v,
        )
    }

    /// Ratios from some voltages.
    ///
    /// # Errors
    /// Those of [`Moments::of`] and [`Moments::ratios`].
    pub fn ratios(&self, voltage_v: &[[f64; LIMBS]]) -> Result<ScaleRatios> {
        self.moments(voltage_v)?.ratios(&Limits::default())
    }
}

/// Errors of some ratios, limb by limb.
pub fn errors(found: &ScaleRatios, true_ln_ratio: &[f64; LIMBS]) -> [f64; LIMBS] {
    core::array::from_fn(|i| found.ln_ratio[i] - true_ln_ratio[i])
}
