//! The measuring chain: from limb forces to the nine voltages on disk.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;
use sixaxis_core::dsp::lag::FirstOrder;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::{Gains, LIMBS, Parameters};

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
    #[must_use]
    pub const fn noise_free() -> Self {
        Self {
            coupling: Coupling::Tared,
            signal_to_noise_db: None,
            resolution_bits: None,
            full_scale_v: 10.0,
        }
    }

    /// Tared, 60 dB, 16 bits over +-10 V.
    #[must_use]
    pub const fn laboratory() -> Self {
        Self {
            coupling: Coupling::Tared,
            signal_to_noise_db: Some(60.0),
            resolution_bits: Some(16),
            full_scale_v: 10.0,
        }
    }

    /// Standard deviation of the noise of one sample, V.
    #[must_use]
    pub fn noise_v(&self) -> f64 {
        self.signal_to_noise_db.map_or(0.0, |db| {
            self.full_scale_v / core::f64::consts::SQRT_2 / 10.0_f64.powf(db / 20.0)
        })
    }

    /// What the converter makes of one voltage.
    #[must_use]
    pub fn convert(&self, voltage_v: f64, rng: &mut impl Rng) -> f64 {
        self.converter().convert(voltage_v, rng)
    }

    /// The converter by itself, for many voltages.
    #[must_use]
    pub fn converter(&self) -> Converter {
        Converter {
            noise_v: self.signal_to_noise_db.map(|_| self.noise_v()),
            step_v: self
                .resolution_bits
                .map(|bits| 2.0 * self.full_scale_v / 2.0_f64.powi(bits as i32)),
            full_scale_v: self.full_scale_v,
        }
    }

    /// The nine voltages of a sensor with the given true parameters under the given whole limb forces.
    pub fn record(
        &self,
        limb_force_per_mass_m_s2: &[[f64; LIMBS]],
        parameters: &Parameters,
        gains: &Gains,
        sample_rate_hz: f64,
        rng: &mut impl Rng,
    ) -> Vec<[f64; LIMBS]> {
        let signal = SignalChain::new(gains, parameters);
        let converter = self.converter();
        let rest = limb_force_per_mass_m_s2
            .first()
            .copied()
            .unwrap_or([0.0; LIMBS]);
        let mut filters = match self.coupling {
            Coupling::AlternatingCurrent { corner_hz } => {
                FirstOrder::high_pass(corner_hz, sample_rate_hz)
                    .ok()
                    .map(|filter| [filter; LIMBS])
            }
            Coupling::Ideal | Coupling::Tared => None,
        };
        limb_force_per_mass_m_s2
            .iter()
            .map(|force| {
                let sensed: [f64; LIMBS] = core::array::from_fn(|i| match self.coupling {
                    Coupling::Ideal => force[i],
                    Coupling::Tared => force[i] - rest[i],
                    Coupling::AlternatingCurrent { .. } => {
                        let change = force[i] - rest[i];
                        filters.as_mut().map_or(change, |f| f[i].step(change))
                    }
                });
                signal.voltage_v(&sensed).map(|u| converter.convert(u, rng))
            })
            .collect()
    }
}

/// A chain's converter with its powers of ten and two worked out once: for each sample they took two fifths of the time that
/// playing a session without MuJoCo takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    noise_v: Option<f64>,
    step_v: Option<f64>,
    full_scale_v: f64,
}

impl Converter {
    /// What it makes of one voltage.
    #[must_use]
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

/// Share of the converter's range that the amplifier range is chosen to fill at most.
const RANGE_HEADROOM: f64 = 0.8;
/// Full scale of the most sensitive range, N: a channel that senses less is all noise.
const SMALLEST_RANGE_N: f64 = 1e-2;

/// The amplifier range of each channel, N/V, that fills the converter best: steps of 1, 2 and 5 per decade, as charge
/// amplifiers have them. Chosen from the largest change of force that a trial run showed.
#[must_use]
pub fn amplifier_ranges(
    limb_force_per_mass_m_s2: &[[f64; LIMBS]],
    parameters: &Parameters,
    full_scale_v: f64,
) -> Gains {
    let rest = limb_force_per_mass_m_s2
        .first()
        .copied()
        .unwrap_or([0.0; LIMBS]);
    Gains {
        gain_n_per_v: core::array::from_fn(|i| {
            let largest_n = limb_force_per_mass_m_s2
                .iter()
                .map(|force| ((force[i] - rest[i]) / parameters.scale_per_mass_per_kg[i]).abs())
                .fold(SMALLEST_RANGE_N, f64::max);
            let needed = largest_n / (RANGE_HEADROOM * full_scale_v);
            let decade = 10.0_f64.powf(needed.log10().floor());
            let step = [1.0, 2.0, 5.0]
                .into_iter()
                .find(|step| step * decade >= needed)
                .unwrap_or(10.0);
            step * decade
        }),
    }
}
