//! How a recording is to be decoupled.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::{Result, require, require_not_negative};
use crate::geometry::LIMBS;
use crate::scheme::Scheme;

/// How eq. (2) turns a limb force into a length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimbLaw {
    /// l_i = L - (f_i/m)/(k/m): compression shortens. This is what (3), (4), (5) and (6) demand together.
    #[default]
    CompressionShortens,
    /// l_i = L + (f_i/m)/(k/m), as printed. Kept to show what the printed sign does; see the claims ledger.
    AsPrinted,
}

/// What the channels say of a constant load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StaticResponse {
    /// The zero drift was taken at rest under gravity: the signal is the change of force since then. What a piezo
    /// with a long time constant shows, and the paper's case.
    #[default]
    Tared,
    /// The signal is the whole limb force, gravity's share included: an ideal force cell.
    Full,
}

/// How to decouple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Integration of eq. (8).
    pub scheme: Scheme,
    /// Sign of eq. (2).
    pub limb_law: LimbLaw,
    /// What the channels say of a constant load.
    pub static_response: StaticResponse,
    /// Stiffness of each limb over the mean one's. By it the limbs share what statics leave open: the forces of excluded limbs, and those
    /// at rest that a tared signal hides. Nine forces add up whatever it is.
    pub stiffness_ratio: [f64; LIMBS],
    /// Half a limb's mass over the seismic mass. What limbs show of the square of the rate is taken off by it; what they show of force and
    /// torque [`CrossTalk`](crate::CrossTalk) takes off before. The plain decoder ([`crate::paper`]) knows limbs without mass only.
    pub rod_mass: f64,
    /// g in ground axes, m/s^2, pointing down. Zero neglects gravity, as eq. (12) does.
    pub gravity_ground_m_s2: DVec3,
    /// R at the first decoupled sample: shell axes to ground axes. A tared signal counts from this attitude.
    pub initial_attitude: DQuat,
    /// w* at the first decoupled sample, shell axes, rad/s.
    pub initial_rate_shell_rad_s: DVec3,
}

impl Settings {
    /// At rest at first, ground axes along the shell's, Heun, tared, without gravity.
    #[must_use]
    pub const fn new(sample_rate_hz: f64) -> Self {
        Self {
            sample_rate_hz,
            scheme: Scheme::Heun,
            limb_law: LimbLaw::CompressionShortens,
            static_response: StaticResponse::Tared,
            stiffness_ratio: [1.0; LIMBS],
            rod_mass: 0.0,
            gravity_ground_m_s2: DVec3::ZERO,
            initial_attitude: DQuat::IDENTITY,
            initial_rate_shell_rad_s: DVec3::ZERO,
        }
    }

    /// g in shell axes at the first sample, m/s^2.
    #[must_use]
    pub fn gravity_shell_m_s2(&self) -> DVec3 {
        self.initial_attitude.inverse() * self.gravity_ground_m_s2
    }

    pub(crate) fn validate(&self) -> Result<()> {
        let rate = self.sample_rate_hz;
        // Differences are divided by the square of the step.
        require(
            rate > 0.0 && (rate * rate).is_normal(),
            "sample_rate_hz",
            rate,
            "positive and finite, and its square, too",
        )?;
        for ratio in self.stiffness_ratio {
            let sound = ratio.is_finite() && ratio > 0.0;
            require(sound, "stiffness ratio", ratio, "positive and finite")?;
        }
        require_not_negative("rod_mass", self.rod_mass)?;
        for (name, vector) in [
            ("gravity_ground_m_s2", self.gravity_ground_m_s2),
            ("initial_rate_shell_rad_s", self.initial_rate_shell_rad_s),
        ] {
            let length = vector.length();
            require(
                length.is_finite(),
                name,
                length,
                "finite, and its square, too",
            )?;
        }
        require(
            self.initial_attitude.is_normalized(),
            "initial_attitude",
            self.initial_attitude.length(),
            "a unit quaternion",
        )
    }
}
