//! A sensor tumbled in the field: turned and shaken about all axes, by nobody's standard, and what its limbs feel.
//!
//! Closed form: the mass hangs where the load of each instant would hold it at rest. That leaves out its own motion against the
//! shell, 1e-5 of a force at 5 Hz, and keeps what the parity rows live on, the geometry of the displaced limbs, to all orders.

use core::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use rand::{Rng, RngExt};

use super::tumble::{Sine, Tumble};
use crate::motion::{Motion, TrueMotion};
use crate::rigid::{Load, torque_per_mass};
use crate::sensor::TrueSensor;

/// Frequencies at which a sensor is turned and shaken by hand, from and to, Hz.
const BY_HAND_HZ: (f64, f64) = (0.3, 3.0);
/// The same of the acceleration, m/s^2.
const ACCELERATION_M_S2: (f64, f64) = (0.5, 3.0);
/// Time in which it is let in, s.
const RISE_S: f64 = 0.5;

/// How a sensor is turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// As one looks at a thing from all sides: angular accelerations of some 15 rad/s^2.
    Calm,
    /// As one shakes a box to hear what is in it: some 50 rad/s^2.
    Brisk,
    /// As one shakes it, to and fro by half a turn: some 150 rad/s^2.
    Shaken,
}

impl Pace {
    /// Amplitude of each sine of the rate along each axis, from and to, rad/s.
    const fn rate_rad_s(self) -> (f64, f64) {
        match self {
            Self::Calm => (0.7, 2.0),
            Self::Brisk => (2.0, 6.0),
            Self::Shaken => (6.0, 18.0),
        }
    }
}

/// A tumble under gravity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Motion of the shell.
    pub motion: Tumble,
    /// g, ground axes, which are the sensor's at the start, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Field {
    /// A tumble by hand.
    pub fn by_hand(rng: &mut impl Rng, pace: Pace, duration_s: f64, sample_rate_hz: f64) -> Self {
        let mut sine = |(low, high): (f64, f64), over: fn(f64) -> f64| {
            let frequency_hz = rng.random_range(BY_HAND_HZ.0..BY_HAND_HZ.1);
            let size = over(TAU * frequency_hz);
            let mut three = |low: f64, high: f64| {
                DVec3::from_array(core::array::from_fn(|_| rng.random_range(low..high)))
            };
            Sine {
                amplitude: three(low, high) * size,
                frequency_hz,
                phase_rad: three(-PI, PI),
            }
        };
        Self {
            motion: Tumble {
                position_ground_m: core::array::from_fn(|_| {
                    sine(ACCELERATION_M_S2, |rate| 1.0 / (rate * rate))
                }),
                rate_shell_rad_s: core::array::from_fn(|_| sine(pace.rate_rad_s(), |_| 1.0)),
                rise_s: RISE_S,
            },
            gravity_ground_m_s2: DVec3::new(0.0, 0.0, -crate::paper::GRAVITY_M_S2),
            sample_rate_hz,
            samples: (duration_s * sample_rate_hz) as usize,
        }
    }

    /// The loads of all samples and the motion behind them.
    pub fn simulate(&self, sensor: &TrueSensor) -> (Vec<Load>, Vec<TrueMotion>) {
        let step_s = 1.0 / self.sample_rate_hz;
        let mut attitude = DQuat::IDENTITY;
        (0..self.samples)
            .map(|sample| {
                let time_s = sample as f64 * step_s;
                let (linear, angular) = self.motion.acceleration(time_s);
                let rate = self.motion.rate_shell_at_rad_s(time_s);
                let here = attitude;
                let halfway = self.motion.rate_shell_at_rad_s(time_s + 0.5 * step_s);
                attitude = (attitude * DQuat::from_scaled_axis(halfway * step_s)).normalize();
                let specific = here.inverse() * (linear - self.gravity_ground_m_s2);
                let torque = torque_per_mass(&sensor.inertia_per_mass, rate, angular);
                let truth = TrueMotion {
                    linear_ground_m_s2: linear,
                    angular_ground_rad_s2: here * angular,
                    rate_shell_rad_s: rate,
                    attitude: here,
                };
                let centre_m = DVec3::from_array(sensor.mass_centre_m);
                let load = Load {
                    specific_force_m_s2: specific + truth.carried_m_s2(centre_m),
                    torque_m2_s2: torque,
                };
                (load, truth)
            })
            .unzip()
    }
}
