//! The measuring chain: from limb forces to the nine voltages on disk.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::continuous::lagged;
use crate::geometry::LIMBS;
use crate::sensor::TrueSensor;

/// Share of the converter's range that an amplifier range is chosen to fill at most.
pub(super) const RANGE_FILLED: f64 = 0.8;
/// Full scale of the most sensitive range, N: a channel that senses less is all noise.
const SMALLEST_RANGE_N: f64 = 1e-2;

/// What becomes of a constant load between piezo and converter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Coupling {
    /// An ideal force cell: the whole force.
    Ideal,
    /// The change of force since the first sample, at rest: a piezo whose time constant is long against the run.
    Tared,
    /// A charge amplifier's first-order high-pass with this corner, Hz.
    AlternatingCurrent {
        /// Corner frequency, Hz.
        corner_hz: f64,
    },
}

/// Amplifier, converter and noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Chain {
    /// What becomes of a constant load.
    pub coupling: Coupling,
    /// Ratio of a full-scale sine to the noise of one sample, dB. None: no noise.
    pub signal_to_noise_db: Option<f64>,
    /// Converter resolution, bits over the whole of +-`full_scale_v`. None: no quantisation.
    pub resolution_bits: Option<u32>,
    /// Converter limit, V; beyond it the converter clips. Infinite: no limit.
    pub full_scale_v: f64,
}

impl Chain {
    /// Tared and otherwise perfect.
    pub const fn noise_free() -> Self {
        Self {
            coupling: Coupling::Tared,
            signal_to_noise_db: None,
            resolution_bits: None,
            full_scale_v: 10.0,
        }
    }

    /// Tared, 60 dB, 16 bits over +-10 V.
    pub const fn laboratory() -> Self {
        Self {
            coupling: Coupling::Tared,
            signal_to_noise_db: Some(60.0),
            resolution_bits: Some(16),
            full_scale_v: 10.0,
        }
    }

    /// Standard deviation of the noise of one sample, V.
    pub fn noise_v(&self) -> f64 {
        self.signal_to_noise_db.map_or(0.0, |db| {
            self.full_scale_v / core::f64::consts::SQRT_2 / 10.0_f64.powf(db / 20.0)
        })
    }

    /// The converter by itself, for many voltages.
    pub fn converter(&self) -> Converter {
        Converter {
            noise_v: self.signal_to_noise_db.map(|_| self.noise_v()),
            step_v: self
                .resolution_bits
                .map(|bits| 2.0 * self.full_scale_v / 2.0_f64.powi(bits as i32)),
            full_scale_v: self.full_scale_v,
        }
    }

    /// The amplifier range of each channel, N/V, that fills the converter best: steps of 1, 2 and 5 per decade, as charge
    /// amplifiers have them, chosen from the largest force that a trial run showed.
    pub fn amplifier_ranges(
        &self,
        limb_force_per_mass_m_s2: &[[f64; LIMBS]],
        sensor: &TrueSensor,
    ) -> [f64; LIMBS] {
        let sensed = self.coupling.sensed(limb_force_per_mass_m_s2);
        core::array::from_fn(|i| {
            let largest_n = sensed
                .iter()
                .map(|force| (force[i] / sensor.scale_per_mass_per_kg[i]).abs())
                .fold(SMALLEST_RANGE_N, f64::max);
            let needed = largest_n / (RANGE_FILLED * self.full_scale_v);
            let decade = 10.0_f64.powf(needed.log10().floor());
            let step = [1.0, 2.0, 5.0]
                .into_iter()
                .find(|step| step * decade >= needed)
                .unwrap_or(10.0);
            step * decade
        })
    }

    /// The nine voltages, V, that the converter makes of whole limb forces per mass, m/s^2, behind amplifiers of the given
    /// gains, N/V.
    pub fn record(
        &self,
        limb_force_per_mass_m_s2: &[[f64; LIMBS]],
        sensor: &TrueSensor,
        gain_n_per_v: &[f64; LIMBS],
        sample_rate_hz: f64,
        rng: &mut impl Rng,
    ) -> Vec<[f64; LIMBS]> {
        let converter = self.converter();
        let mut sensed = self.coupling.sensed(limb_force_per_mass_m_s2);
        if let Coupling::AlternatingCurrent { corner_hz } = self.coupling {
            high_pass(&mut sensed, corner_hz, sample_rate_hz);
        }
        sensed
            .iter()
            .map(|force| {
                let voltage_v = sensor.voltage_v(force, gain_n_per_v);
                voltage_v.map(|voltage_v| converter.convert(voltage_v, rng))
            })
            .collect()
    }
}

impl Coupling {
    /// The forces per mass, m/s^2, whose change reaches the amplifier: whole, or less those of the first sample, at rest.
    fn sensed(self, limb_force_per_mass_m_s2: &[[f64; LIMBS]]) -> Vec<[f64; LIMBS]> {
        let rest = match (self, limb_force_per_mass_m_s2.first()) {
            (Self::Ideal, _) | (_, None) => [0.0; LIMBS],
            (_, Some(first)) => *first,
        };
        limb_force_per_mass_m_s2
            .iter()
            .map(|force| core::array::from_fn(|i| force[i] - rest[i]))
            .collect()
    }
}

/// What a charge amplifier's analogue first-order high-pass lets through of the forces.
fn high_pass(forces: &mut [[f64; LIMBS]], corner_hz: f64, sample_rate_hz: f64) {
    for limb in 0..LIMBS {
        let whole: Vec<f64> = forces.iter().map(|row| row[limb]).collect();
        let lost = lagged(&whole, corner_hz, sample_rate_hz);
        for (row, lost) in forces.iter_mut().zip(lost) {
            row[limb] -= lost;
        }
    }
}

/// A chain's converter with its powers of ten and two worked out once: for each sample they took two fifths of the time that
/// simulating a session without MuJoCo takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    noise_v: Option<f64>,
    step_v: Option<f64>,
    full_scale_v: f64,
}

impl Converter {
    /// What it makes of one voltage.
    pub fn convert(&self, voltage_v: f64, rng: &mut impl Rng) -> f64 {
        let mut u = voltage_v;
        if let Some(noise_v) = self.noise_v {
            let unit: f64 = StandardNormal.sample(rng);
            u += noise_v * unit;
        }
        if let Some(step_v) = self.step_v {
            u = (u / step_v).round() * step_v;
        }
        u.clamp(-self.full_scale_v, self.full_scale_v)
    }
}
