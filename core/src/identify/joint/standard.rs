//! What a standard shows of a trial's motion: with its gain, a first-order lag and a delay.

use alloc::vec::Vec;

use nalgebra::Complex;

use super::trial::{Drive, Trial};
use super::unknowns::{ACCELEROMETER_GAIN, GYROSCOPE_GAIN, GYROSCOPE_LAG, Unknowns};
use crate::float::sin_cos;

/// The standard's answer to the motion.
pub(super) struct Standard {
    /// Response at each harmonic.
    pub response: Vec<Complex<f64>>,
    /// Its derivative by the gyroscope's lag.
    pub by_lag: Vec<Complex<f64>>,
    /// Place of the gain.
    pub gain: usize,
}

impl Trial {
    /// The standard's answer to the motion.
    pub fn standard(&self, unknowns: &Unknowns) -> Standard {
        let [accelerometer_s, gyroscope_s] = self.standard_delay_s;
        let (lag, delay_s, gain) = match self.drive {
            Drive::Linear => (
                self.accelerometer_lag_s,
                accelerometer_s,
                ACCELEROMETER_GAIN,
            ),
            Drive::Angular => (unknowns.values[GYROSCOPE_LAG], gyroscope_s, GYROSCOPE_GAIN),
        };
        let (response, by_lag) = (1..=self.grid.harmonics)
            .map(|k| {
                let iw = Complex::new(0.0, self.grid.rate_rad_s(k));
                let (sin, cos) = sin_cos(self.grid.rate_rad_s(k) * delay_s);
                let late = Complex::new(cos, -sin);
                let follows = Complex::new(1.0, 0.0) / (Complex::new(1.0, 0.0) + iw * lag);
                (late * follows, -iw * late * follows * follows)
            })
            .unzip();
        Standard {
            response,
            by_lag,
            gain,
        }
    }
}
