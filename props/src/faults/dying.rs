//! A limb that dies in mid-motion, played in MuJoCo: the decoupler that watches against one that does not and one that has
//! nothing to watch.

use crate::truth;
use glam::{DQuat, DVec3};
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use sixaxis_core::redundancy::fault::Watch;
use sixaxis_core::{Geometry, LIMBS, Parameters, Sensor, Settings, StaticResponse};
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::mujoco::simulation::SimulationError;
use sixaxis_reference::rig::tumble::{SINES, Sine, Tumble};

use super::{FALSE_ALARMS_PER_HOUR, SAMPLE_RATE_HZ};
use crate::statistics::normal;

/// Length of the motion, and when the limb dies, s.
pub const DURATION_S: f64 = 1.2;
/// See [`DURATION_S`].
pub const DIES_AT_S: f64 = 0.7;
/// Highest frequency, Hz; amplitudes of a sine, m and rad/s; rise from rest, s.
const HIGHEST_HZ: f64 = 5.0;
const TRAVEL_M: f64 = 0.02;
const RATE_RAD_S: f64 = 4.0;
const RISE_S: f64 = 0.3;
/// Runge-Kutta steps from sample to sample.
const STEPS: usize = 4;
const STREAM: u128 = 76;

/// A recorded motion and its truth.
#[derive(Debug, Clone)]
pub struct Played {
    /// Geometry and ranges.
    pub sensor: Sensor,
    /// True parameters.
    pub parameters: Parameters,
    /// Gravity and start.
    pub settings: Settings,
    /// Noise of one sample, V.
    pub noise_v: [f64; LIMBS],
    /// What a sound sensor records.
    pub sound_v: Vec<[f64; LIMBS]>,
    /// What is recorded with the limb that dies.
    pub failed_v: Vec<[f64; LIMBS]>,
    /// First sample of the failure.
    pub onset: u64,
    /// True motion.
    pub truth: Vec<TrueMotion>,
}

impl Played {
    /// Draws a sensor and a motion and plays them; `limb` (from 0) falls to its zero, with its noise.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn random(seed: u64, limb: usize) -> Result<Self, SimulationError> {
        let mut rng = Pcg64::new(u128::from(seed), STREAM);
        let parameters = truth::random_parameters(&mut rng);
        let mut sine = |k: usize, amplitude: f64| {
            let mut uniform = || -> f64 { StandardUniform.sample(&mut rng) };
            let mut axis =
                |size: f64| DVec3::from_array([0; 3].map(|_| size * (2.0 * uniform() - 1.0)));
            Sine {
                amplitude: axis(amplitude),
                frequency_hz: HIGHEST_HZ * (k + 1) as f64 / SINES as f64,
                phase_rad: axis(core::f64::consts::PI),
            }
        };
        let motion = Tumble {
            position_ground_m: core::array::from_fn(|k| sine(k, TRAVEL_M)),
            rate_shell_rad_s: core::array::from_fn(|k| sine(k, RATE_RAD_S)),
            rise_s: RISE_S,
        };
        // Without gravity, tared and whole signals are one, and the sensor is at rest in no direction of its own.
        let model = truth::model(&parameters, DVec3::ZERO);
        let run = sixaxis_reference::mujoco::simulate(
            &model,
            &motion,
            DURATION_S,
            SAMPLE_RATE_HZ,
            STEPS,
        )?;
        let chain = Chain::laboratory();
        let forces = &run.limb_force_per_mass_m_s2;
        let gains = truth::amplifier_ranges(forces, &parameters);
        let signal = truth::sensor(&parameters);
        let noise = chain.noise_v();
        let sound_v: Vec<[f64; LIMBS]> = forces
            .iter()
            .map(|force| {
                let unit: [[f64; 3]; 3] = [(); 3].map(|()| normal(&mut rng).to_array());
                let u = signal.voltage_v(force, &gains.gain_n_per_v);
                core::array::from_fn(|i| u[i] + noise * unit.as_flattened()[i])
            })
            .collect();
        let onset = (DIES_AT_S * SAMPLE_RATE_HZ) as u64;
        let mut failed_v = sound_v.clone();
        for row in failed_v.iter_mut().skip(onset as usize) {
            row[limb] = parameters.zero_drift_v[limb] + noise * normal(&mut rng).x;
        }
        Ok(Self {
            sensor: Sensor {
                geometry: Geometry::PAPER,
                gains,
            },
            parameters,
            settings: Settings {
                static_response: StaticResponse::Full,
                ..Settings::new(SAMPLE_RATE_HZ)
            },
            noise_v: [noise; LIMBS],
            sound_v,
            failed_v,
            onset,
            truth: run.truth,
        })
    }

    /// What the monitor is told.
    pub fn watch(&self) -> Watch {
        Watch::exact(FALSE_ALARMS_PER_HOUR, self.noise_v)
    }
}

/// Angle of the rotation between two attitudes, rad.
pub fn angle_rad(a: DQuat, b: DQuat) -> f64 {
    let q = a.inverse() * b;
    2.0 * q.xyz().length().atan2(q.w.abs())
}
