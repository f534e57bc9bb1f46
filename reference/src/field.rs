//! A sensor tumbled in the field: turned and shaken about all axes, by nobody's standard, and what its limbs feel.
//!
//! Closed form: the mass hangs where the load of each instant would hold it at rest. That leaves out its own motion against the
//! shell, 1e-5 of a force at 5 Hz, and keeps what the parity rows live on, the geometry of the displaced limbs, to all orders.

use core::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use nalgebra::{SMatrix, Vector6};
use rand::{Rng, RngExt};
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::{Geometry, LIMBS, Parameters};

use crate::mjcf::limb_jacobian;
use crate::recording::TrueMotion;
use crate::rigid::RigidSensor;
use crate::simulation::Motion;
use crate::tumble::{Sine, Tumble};

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
    /// As one plays with it: some 50 rad/s^2.
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

/// What an instant asks of the limbs, shell axes: acceleration less gravity, m/s^2, and torque over mass, m^2/s^2.
pub type Load = (DVec3, DVec3);

impl Field {
    /// A tumble by hand.
    #[must_use]
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
    #[must_use]
    pub fn play(&self, parameters: &Parameters) -> (Vec<Load>, Vec<TrueMotion>) {
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
                let torque = euler_torque(&parameters.inertia_per_mass, rate, angular);
                let truth = TrueMotion {
                    linear_ground_m_s2: linear,
                    angular_ground_rad_s2: here * angular,
                    rate_shell_rad_s: rate,
                    attitude: here,
                };
                ((specific, torque), truth)
            })
            .unzip()
    }
}

/// Limb forces per mass, m/s^2, of equally stiff limbs at the pose that some loads hold the mass in. None for a geometry whose
/// limbs do not hold it.
#[must_use]
pub fn compliant_forces_m_s2(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    loads: &[Load],
) -> Option<Vec<[f64; LIMBS]>> {
    let jacobian = limb_jacobian(geometry);
    let compliance: SMatrix<f64, 6, 6> =
        (jacobian.transpose() * jacobian * stiffness_per_mass_per_s2).try_inverse()?;
    let forces = loads.iter().map(|(a, m)| {
        // Compression pushes along e, so the mass gives way against the load.
        let moved = -(compliance * Vector6::new(a.x, a.y, a.z, m.x, m.y, m.z));
        let pose = Pose {
            position_shell_m: DVec3::new(moved[0], moved[1], moved[2]),
            rotation_rad: DVec3::new(moved[3], moved[4], moved[5]),
        };
        pose.elongations_m(geometry)
            .map(|elongation_m| -stiffness_per_mass_per_s2 * elongation_m)
    });
    Some(forces.collect())
}

/// The same of limbs whose stiffnesses stand in some ratio, to first order.
#[must_use]
pub fn unequal_forces_m_s2(sensor: &RigidSensor, loads: &[Load]) -> Vec<[f64; LIMBS]> {
    loads
        .iter()
        .map(|(acceleration, torque)| sensor.forces_m_s2(*acceleration, *torque))
        .collect()
}
