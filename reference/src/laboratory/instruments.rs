//! The two reference instruments: an accelerometer on the slider and a gyroscope on the pinion shaft.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::continuous::lagged;

/// Bandwidth of the standard gyroscope, Hz.
pub const GYROSCOPE_BANDWIDTH_HZ: f64 = 10.0;

/// Largest error of either reference instrument: the paper says below 1 %.
pub const INSTRUMENT_CLASS: f64 = 0.01;

/// Share of the class that a certificate leaves to the gain: linearity and noise have the rest.
pub const GAIN_SHARE: f64 = 0.5;

/// Both reference instruments as they are, which the laboratory does not know.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Instruments {
    /// Relative gain error of the accelerometer.
    pub accelerometer_gain_error: f64,
    /// Relative gain error of the gyroscope.
    pub gyroscope_gain_error: f64,
    /// First-order bandwidth of the gyroscope, Hz. None: it follows at once.
    pub gyroscope_bandwidth_hz: Option<f64>,
    /// Ratio of a sine of the run's own peak to the noise of one sample, dB. None: no noise.
    pub signal_to_noise_db: Option<f64>,
}

impl Instruments {
    /// Instruments without error.
    pub const fn perfect() -> Self {
        Self {
            accelerometer_gain_error: 0.0,
            gyroscope_gain_error: 0.0,
            gyroscope_bandwidth_hz: None,
            signal_to_noise_db: None,
        }
    }

    /// One pair out of the 1 % class: 60 dB, gyroscope of 10 Hz.
    pub fn of_class(rng: &mut impl Rng) -> Self {
        Self {
            gyroscope_bandwidth_hz: Some(GYROSCOPE_BANDWIDTH_HZ),
            signal_to_noise_db: Some(60.0),
            ..Self::drawn(INSTRUMENT_CLASS, rng)
        }
    }

    /// One pair out of a class, a relative error: gain errors even over [`GAIN_SHARE`] of it, no lag, no noise.
    ///
    /// The gain error of an instrument is fixed for a campaign; it is what its calibration certificate bounds.
    pub fn drawn(class: f64, rng: &mut impl Rng) -> Self {
        let mut gain_error = || GAIN_SHARE * class * (2.0 * rng.random::<f64>() - 1.0);
        Self {
            accelerometer_gain_error: gain_error(),
            gyroscope_gain_error: gain_error(),
            ..Self::perfect()
        }
    }

    /// The accelerometer's reading of the true acceleration along its axis, m/s^2.
    pub fn read_accelerometer(&self, true_m_s2: &[f64], rng: &mut impl Rng) -> Vec<f64> {
        let noise = self.noise(true_m_s2);
        true_m_s2
            .iter()
            .map(|a| a * (1.0 + self.accelerometer_gain_error) + normal(noise, rng))
            .collect()
    }

    /// The gyroscope's reading of the true rate about its axis, rad/s.
    pub fn read_gyroscope(
        &self,
        true_rad_s: &[f64],
        sample_rate_hz: f64,
        rng: &mut impl Rng,
    ) -> Vec<f64> {
        let noise = self.noise(true_rad_s);
        let followed = self.gyroscope_bandwidth_hz.map_or_else(
            || true_rad_s.to_vec(),
            |corner_hz| lagged(true_rad_s, corner_hz, sample_rate_hz),
        );
        followed
            .iter()
            .map(|w| w * (1.0 + self.gyroscope_gain_error) + normal(noise, rng))
            .collect()
    }

    /// Standard deviation of the noise of one sample in the unit of the signal.
    fn noise(&self, signal: &[f64]) -> f64 {
        let peak = signal.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        self.signal_to_noise_db.map_or(0.0, |db| {
            peak / core::f64::consts::SQRT_2 / 10.0_f64.powf(db / 20.0)
        })
    }
}

fn normal(deviation: f64, rng: &mut impl Rng) -> f64 {
    if deviation == 0.0 {
        return 0.0;
    }
    let unit: f64 = StandardNormal.sample(rng);
    deviation * unit
}
