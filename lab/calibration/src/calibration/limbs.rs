//! Limbs and channels as the joint fit found them, beside the 25 parameters.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::{CrossTalk, LIMBS, Parameters, Sensor};

/// Standard deviation of the limbs' stiffnesses about their mean, relative, where no fit has determined them: an ordinary
/// laboratory's.
pub(crate) const STIFFNESS_SD: f64 = 0.005;

/// Nine rows of nine numbers.
pub type Square = [[f64; LIMBS]; LIMBS];

/// What the 25 leave out: the limbs' stiffnesses and mass, the mass's centre, cross-talk, and how well strains are known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibratedLimbs {
    /// Stiffness of each limb over the mean of the nine.
    pub stiffness_ratio: [f64; LIMBS],
    /// From the cube's centre to that of its mass, sensor axes, m.
    #[serde(default)]
    pub mass_centre_m: [f64; 3],
    /// Half a limb's mass over the seismic mass.
    #[serde(default)]
    pub rod_mass: f64,
    /// Share of each limb's force (column) that each channel (row) shows beside its own.
    pub cross_talk: Square,
    /// Root mean square of their standard deviations, of channels side by side and apart.
    pub cross_talk_spread: f64,
    /// Covariance of the relative errors of the strains per volt, (s_i/m)/(k_i/k), the accelerometer's gain left out, which is
    /// the same for all; with what a channel's sensitivity changes by over the day.
    pub strain_covariance: Square,
}

impl CalibratedLimbs {
    /// Of limbs that are equally stiff and channels that show nothing of each other, their parameters known exactly.
    pub const EXACT: Self = Self {
        stiffness_ratio: [1.0; LIMBS],
        mass_centre_m: [0.0; 3],
        rod_mass: 0.0,
        cross_talk: [[0.0; LIMBS]; LIMBS],
        cross_talk_spread: 0.0,
        strain_covariance: [[0.0; LIMBS]; LIMBS],
    };

    /// Where nothing is known but the scale factors, to these relative standard deviations: limbs as an ordinary laboratory has them.
    pub fn ordinary(scale_sd: [f64; LIMBS]) -> Self {
        let mut limbs = Self::EXACT;
        for (limb, sd) in scale_sd.into_iter().enumerate() {
            limbs.loosen(limb, sd.hypot(STIFFNESS_SD));
        }
        limbs
    }

    /// What undoes their cross-talk, the torque of a mass off the middle and the limbs' own mass, in a recording of the sensor with its gains.
    ///
    /// # Errors
    /// Those of [`CrossTalk::new`].
    pub fn undone(
        &self,
        sensor: &Sensor,
        parameters: &Parameters,
    ) -> sixaxis_core::Result<CrossTalk> {
        let Self {
            cross_talk,
            mass_centre_m,
            rod_mass,
            ..
        } = self;
        CrossTalk::new(sensor, parameters, cross_talk, *mass_centre_m, *rod_mass)
    }

    /// Takes note that a limb's strain per volt is less certain by a relative standard deviation of its own.
    pub fn loosen(&mut self, limb: usize, sd: f64) {
        self.strain_covariance[limb][limb] += sd * sd;
    }
}
