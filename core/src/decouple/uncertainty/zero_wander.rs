//! What undoing amplifiers' high-pass makes of their channels' noise: zeros that wander.
//!
//! Undoing adds to each sample the integral of what was shown before it, less the level, times omega = 2 pi corner. The level is the mean of the n
//! samples at rest that a recording begins with, over T = n dt. With white noise of deviation sigma a zero is off, t after the first sample, by a
//! deviation of
//!
//! ```text
//! omega sigma sqrt(dt t (1 - t/T))             a bridge, while the sensor rests,
//! omega sigma sqrt(dt s + s^2 / n)             s = t - T after that:
//! ```
//!
//! a walk, the integral of the very noise that single samples have, and a ramp, as the level is off by the mean of its own noise.

use core::f64::consts::TAU;

use crate::error::{Result, require_positive};
use crate::geometry::LIMBS;

/// Variance of a ramp twice integrated, over that of a walk whose steps grow so that it is as far off at any time: for k integrations (2k + 1) / (k + 1).
const TWICE_INTEGRATED: f64 = 5.0 / 3.0;
/// Variance of a bridge's integral over that of its time cubed.
const INTEGRATED_BRIDGE: f64 = 1.0 / 12.0;

/// How far the zeros of nine channels wander, in their white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZeroWander {
    omega_rad_s: f64,
    step_s: f64,
    /// T of each channel.
    rest_s: [f64; LIMBS],
}

/// What happens over a stretch of time, in units of a channel's white variance over the sample rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    /// Variance that the noise's integral has more while the sensor rests, s.
    pub(crate) bridge_s: [f64; LIMBS],
    /// Covariance of the noise's integral with the walk after that.
    pub(crate) shared: [f64; LIMBS],
    /// Variance of the zeros, 1/s: of a walk that, integrated twice, as an error of the zeros is in the attitude, comes as far as walk and ramp.
    /// Where something corrects the zeros in between a ramp has come less far.
    pub(crate) walk_per_s: [f64; LIMBS],
}

impl ZeroWander {
    /// Of channels undone about levels that are means of so many samples.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for frequencies or numbers of samples that are not positive.
    pub fn new(
        corner_hz: f64,
        sample_rate_hz: f64,
        samples_of_level: &[usize; LIMBS],
    ) -> Result<Self> {
        require_positive("corner of a high-pass", corner_hz)?;
        require_positive("sample rate", sample_rate_hz)?;
        for &samples in samples_of_level {
            require_positive("samples of a level", samples as f64)?;
        }
        Ok(Self {
            omega_rad_s: TAU * corner_hz,
            step_s: 1.0 / sample_rate_hz,
            rest_s: samples_of_level.map(|samples| samples as f64 / sample_rate_hz),
        })
    }

    /// Variance of each zero's error at a sample, over the white variance of its channel.
    #[must_use]
    pub fn variances(&self, sample: u64) -> [f64; LIMBS] {
        let t = sample as f64 * self.step_s;
        let scale = self.omega_rad_s * self.omega_rad_s * self.step_s;
        self.rest_s.map(|rest_s| {
            let since = t - rest_s;
            let bent = if since < 0.0 {
                -t * since / rest_s
            } else {
                since * (1.0 + since / rest_s)
            };
            scale * bent
        })
    }

    /// Variances of what a zero changes by from sample to sample, over the white variance of its channel: of a walk, and of a ramp.
    #[must_use]
    pub fn steps(&self) -> [[f64; LIMBS]; 2] {
        let walk = self.omega_rad_s * self.omega_rad_s * self.step_s * self.step_s;
        [
            [walk; LIMBS],
            self.rest_s.map(|rest_s| walk * self.step_s / rest_s),
        ]
    }

    /// From one time to a later one.
    pub(crate) fn stretch(&self, from_s: f64, to_s: f64) -> Stretch {
        let omega = self.omega_rad_s;
        let after = |rest_s: f64| [from_s, to_s].map(|t| (t - rest_s).max(0.0));
        Stretch {
            bridge_s: self.rest_s.map(|rest_s| {
                let resting_s = to_s.min(rest_s) - from_s.min(rest_s);
                omega * omega * rest_s * rest_s * INTEGRATED_BRIDGE * resting_s
            }),
            shared: self.rest_s.map(|rest_s| {
                let [from, to] = after(rest_s);
                omega * (to - from)
            }),
            walk_per_s: self.rest_s.map(|rest_s| {
                let [from, to] = after(rest_s);
                let ramp = TWICE_INTEGRATED * (to + from) / rest_s;
                omega * omega * (to - from) * (1.0 + ramp)
            }),
        }
    }
}
