//! The one problem library: sensors, what they are fed, and how they are read, for tests, benches and the report's study.
//!
//! [`Problem`] is any stream with everything that a decoupler needs. [`rig`] plays short runs of the calibration rig in
//! MuJoCo, [`recorded`] the noise-free recordings that benches time. Manufactured motions, which have a closed form, are in
//! [`crate::manufactured`].

pub mod recorded;
pub mod rig;

use glam::{DQuat, DVec3};
use sixaxis_core::six_axis::Accelerations;
use sixaxis_core::{
    Decoupler, Gains, LIMBS, Parameters, Scheme, Sensor, Settings, SixAxis, StaticResponse,
};
use sixaxis_reference::laboratory::recording::SimulatedRecording;

use crate::manufactured::motion::Manufactured;
use crate::truth::InCore;

/// Gains of unequal size and sign, N/V: no channel passes for another.
pub const UNEQUAL_GAINS: Gains = Gains {
    gain_n_per_v: [0.5, -2.0, 1.0, 10.0, 0.2, 5.0, -0.1, 1.0, 20.0],
};

/// A sensor, its parameters and settings, and its voltages.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Drawing and amplifiers.
    pub sensor: Sensor,
    /// True parameters.
    pub parameters: Parameters,
    /// How the voltages are to be read.
    pub settings: Settings,
    /// Nine voltages a row, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
}

impl Problem {
    /// A manufactured motion from its start, with the shell taken to be at rest at first.
    pub fn manufactured(
        motion: &Manufactured,
        gains: Gains,
        sample_rate_hz: f64,
        samples: usize,
        scheme: Scheme,
    ) -> Self {
        let voltage = |i: usize| {
            let moment = motion.at(i as f64 / sample_rate_hz);
            motion.voltage_v(&gains.gain_n_per_v, &moment)
        };
        Self {
            sensor: Sensor {
                geometry: motion.geometry,
                gains,
            },
            parameters: motion.parameters,
            settings: Settings {
                scheme,
                static_response: StaticResponse::Full,
                gravity_ground_m_s2: motion.gravity_ground_m_s2,
                ..Settings::new(sample_rate_hz)
            },
            voltage_v: (0..samples).map(voltage).collect(),
        }
    }

    /// A recording read with the given parameters.
    pub fn recorded(
        recording: &SimulatedRecording,
        parameters: &Parameters,
        scheme: Scheme,
    ) -> Self {
        Self {
            sensor: recording.sensor(),
            parameters: *parameters,
            settings: recording.settings(scheme),
            voltage_v: recording.voltage_v.clone(),
        }
    }

    /// The same with attitude and rate (shell axes, rad/s) of the shell at the first sample that is decoupled.
    #[must_use]
    pub fn starting(mut self, attitude: DQuat, rate_shell_rad_s: DVec3) -> Self {
        self.settings.initial_attitude = attitude;
        self.settings.initial_rate_shell_rad_s = rate_shell_rad_s;
        self
    }

    /// A decoupler ready for the first sample.
    ///
    /// # Panics
    /// If the core refuses the sensor.
    pub fn decoupler(&self) -> Decoupler {
        Decoupler::new(&self.sensor, &self.parameters, &self.settings).expect("a sound sensor")
    }

    /// All decoupled samples, one by one.
    ///
    /// # Panics
    /// If the core refuses the sensor or a sample.
    pub fn decouple(&self) -> Vec<SixAxis> {
        let mut answers = Vec::with_capacity(self.voltage_v.len());
        self.decoupler()
            .push_all(&self.voltage_v, |sample| answers.push(*sample))
            .expect("sound samples");
        answers
    }
}

/// Linear, m/s^2, and angular accelerations, rad/s^2.
pub fn accelerations<'a>(samples: impl IntoIterator<Item = &'a SixAxis>) -> Vec<Accelerations> {
    samples.into_iter().map(SixAxis::accelerations).collect()
}
