//! What undoing amplifiers' high-pass makes of their channels' noise: zeros that wander.
//!
//! Undoing adds to each sample the integral of what was shown before it, times omega = 2 pi corner. White noise of deviation
//! sigma becomes a random walk by that, the integral of the very noise that single samples have, and the error of the level about which it is undone, that of a mean of n samples, a ramp. At a time t from
//! the first sample on, with dt between samples, a zero is off by a deviation of
//!
//! ```text
//! omega sigma sqrt(t dt + t^2 / n).
//! ```

use core::f64::consts::TAU;

use crate::error::{Result, require_not_negative, require_positive};
use crate::geometry::LIMBS;

/// Variance of a ramp twice integrated, over that of a walk whose steps grow so that it is as far off at any time: for k integrations (2k + 1) / (k + 1).
const TWICE_INTEGRATED: f64 = 5.0 / 3.0;

/// How far the zeros of nine channels wander.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZeroWander {
    /// Variance of the walk over time, V^2/s, and its covariance with the integral of the noise over time, V^2.
    walk_v2_per_s: [f64; LIMBS],
    shared_v2: [f64; LIMBS],
    /// Variance of the ramp over time squared, V^2/s^2.
    ramp_v2_per_s2: [f64; LIMBS],
}

impl ZeroWander {
    /// Of channels with this white noise, V, undone about levels that are means of so many samples.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for frequencies or numbers of samples that are not positive, or noise that is negative.
    pub fn new(
        corner_hz: f64,
        sample_rate_hz: f64,
        white_v: &[f64; LIMBS],
        samples_of_level: &[usize; LIMBS],
    ) -> Result<Self> {
        require_positive("corner of a high-pass", corner_hz)?;
        require_positive("sample rate", sample_rate_hz)?;
        for (&noise_v, &samples) in white_v.iter().zip(samples_of_level) {
            require_not_negative("channel noise", noise_v)?;
            require_positive("samples of a level", samples as f64)?;
        }
        let omega = TAU * corner_hz;
        let pulled = |limb: usize| {
            let pulled_v_per_s = omega * white_v[limb];
            pulled_v_per_s * pulled_v_per_s
        };
        Ok(Self {
            walk_v2_per_s: core::array::from_fn(|limb| pulled(limb) / sample_rate_hz),
            shared_v2: white_v.map(|sd| omega * sd * sd / sample_rate_hz),
            ramp_v2_per_s2: core::array::from_fn(|limb| {
                pulled(limb) / samples_of_level[limb] as f64
            }),
        })
    }

    /// Variance of each zero's error at a time, V^2.
    #[must_use]
    pub fn variance_v2(&self, time_s: f64) -> [f64; LIMBS] {
        core::array::from_fn(|limb| {
            time_s * (self.walk_v2_per_s[limb] + time_s * self.ramp_v2_per_s2[limb])
        })
    }

    /// What it grows by from one time to a later one as a walk that, integrated twice, as an error of the zeros is in the attitude, comes as far
    /// as the ramp, V^2. Where something corrects the zeros in between a ramp has come less far.
    #[must_use]
    pub fn growth_v2(&self, from_s: f64, to_s: f64) -> [f64; LIMBS] {
        let ramp = TWICE_INTEGRATED * (to_s + from_s);
        core::array::from_fn(|limb| {
            (to_s - from_s) * (self.walk_v2_per_s[limb] + ramp * self.ramp_v2_per_s2[limb])
        })
    }

    /// Covariance of what a zero walks, with the integral of its channel's noise over the same time, by that time, V^2.
    #[must_use]
    pub const fn shared_v2(&self) -> &[f64; LIMBS] {
        &self.shared_v2
    }

    /// Variance over a sample's time of a walk, V^2, and over that time squared of a ramp, V^2: what a zero changes by from sample to sample.
    #[must_use]
    pub fn steps_v2(&self, step_s: f64) -> [[f64; LIMBS]; 2] {
        [
            self.walk_v2_per_s.map(|walk| walk * step_s),
            self.ramp_v2_per_s2.map(|ramp| ramp * step_s * step_s),
        ]
    }
}
