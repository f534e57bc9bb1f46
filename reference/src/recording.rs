//! What a laboratory would have on disk, and, kept apart from it, what the simulator knows.

use glam::{DQuat, DVec3};
use serde::Serialize;
use sixaxis_calibration::trial::Trial;
use sixaxis_core::{Gains, Geometry, LIMBS, Scheme, Sensor, Settings};
use sixaxis_recordings::session::Role;

use crate::mjcf::SensorModel;
use crate::rig::Run;
use crate::simulation::{Motion, Simulation, SimulationError};

/// What an algorithm may see of one run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recording {
    /// Samples per second, all channels on one clock.
    pub sample_rate_hz: f64,
    /// c_i of the amplifier range in use.
    pub gains: Gains,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard accelerometer on the slider, along the travel, m/s^2.
    pub accelerometer_m_s2: Vec<f64>,
    /// Standard gyroscope about the pinion's axis, rad/s.
    pub gyroscope_rad_s: Vec<f64>,
    /// Travel and axis in the sensor's axes at rest: read off the wedge.
    pub direction_ground: DVec3,
    /// Gravity in the sensor's axes at rest, m/s^2: read off the mounting.
    pub gravity_ground_m_s2: DVec3,
    /// Crank frequency, Hz: read off the motor's drive.
    pub frequency_hz: f64,
}

impl Recording {
    /// What a laboratory knows of the sensor behind this recording: the paper's drawing, this amplifier range.
    #[must_use]
    pub fn sensor(&self) -> Sensor {
        Sensor {
            geometry: Geometry::PAPER,
            gains: self.gains,
        }
    }

    /// Decoupler settings that go with this recording: from rest, tared, with its gravity.
    #[must_use]
    pub fn settings(&self, scheme: Scheme) -> Settings {
        Settings {
            scheme,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            ..Settings::new(self.sample_rate_hz)
        }
    }

    /// As a trial of a session.
    #[must_use]
    pub fn trial(&self, role: Role) -> Trial {
        Trial {
            name: String::new(),
            role,
            sample_rate_hz: self.sample_rate_hz,
            gains: self.gains,
            full_scale_v: self.full_scale_v,
            voltage_v: self.voltage_v.clone(),
            accelerometer_m_s2: self.accelerometer_m_s2.clone(),
            gyroscope_rad_s: self.gyroscope_rad_s.clone(),
            direction_ground: self.direction_ground,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            frequency_hz: self.frequency_hz,
        }
    }
}

/// One sample of the shell's true motion, from the simulator's state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueMotion {
    /// a, ground axes, m/s^2.
    pub linear_ground_m_s2: DVec3,
    /// w', ground axes, rad/s^2.
    pub angular_ground_rad_s2: DVec3,
    /// w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Shell axes to ground axes.
    pub attitude: DQuat,
}

/// One run as the simulator saw it: limb forces and true motion at the sampling instants.
#[derive(Debug, Clone)]
pub struct SimulatedRun {
    /// What the rig did.
    pub run: Run,
    /// Gravity, ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whole limb forces per mass, gravity's share included, m/s^2.
    pub limb_force_per_mass_m_s2: Vec<[f64; LIMBS]>,
    /// True motion.
    pub truth: Vec<TrueMotion>,
}

/// Any motion as the simulator saw it: limb forces and true motion at the sampling instants.
#[derive(Debug, Clone)]
pub struct SimulatedMotion {
    /// Gravity, ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whole limb forces per mass, gravity's share included, m/s^2.
    pub limb_force_per_mass_m_s2: Vec<[f64; LIMBS]>,
    /// True motion.
    pub truth: Vec<TrueMotion>,
}

impl SimulatedMotion {
    /// Simulates `duration_s` of a motion with `steps_per_sample` Runge-Kutta steps from sample to sample.
    ///
    /// # Errors
    /// Those of [`Simulation`].
    pub fn simulate(
        model: &SensorModel,
        motion: &impl Motion,
        duration_s: f64,
        sample_rate_hz: f64,
        steps_per_sample: usize,
    ) -> Result<Self, SimulationError> {
        let step_s = 1.0 / (sample_rate_hz * steps_per_sample as f64);
        let samples = (duration_s * sample_rate_hz).floor() as usize + 1;
        let mut simulation = Simulation::new(model, step_s)?;
        let mut result = Self {
            gravity_ground_m_s2: model.gravity_ground_m_s2,
            sample_rate_hz,
            limb_force_per_mass_m_s2: Vec::with_capacity(samples),
            truth: Vec::with_capacity(samples),
        };
        for sample in 0..samples {
            for substep in 0..steps_per_sample {
                let step = sample * steps_per_sample + substep;
                // Counting steps keeps time exact; adding steps up would not.
                simulation.set_time_s(step as f64 * step_s);
                let now = simulation.step(motion)?;
                if substep == 0 {
                    let attitude = now.shell.attitude;
                    result
                        .limb_force_per_mass_m_s2
                        .push(now.limb_force_per_mass_m_s2);
                    result.truth.push(TrueMotion {
                        linear_ground_m_s2: now.shell_acceleration_ground_m_s2,
                        angular_ground_rad_s2: attitude
                            * now.shell_angular_acceleration_shell_rad_s2,
                        rate_shell_rad_s: now.shell.rate_body_rad_s,
                        attitude,
                    });
                }
            }
        }
        Ok(result)
    }
}

impl SimulatedRun {
    /// Simulates one run with `steps_per_sample` Runge-Kutta steps from sample to sample.
    ///
    /// # Errors
    /// Those of [`Simulation`].
    pub fn simulate(
        model: &SensorModel,
        run: &Run,
        sample_rate_hz: f64,
        steps_per_sample: usize,
    ) -> Result<Self, SimulationError> {
        let motion = SimulatedMotion::simulate(
            model,
            run,
            run.duration_s(),
            sample_rate_hz,
            steps_per_sample,
        )?;
        Ok(Self {
            run: *run,
            gravity_ground_m_s2: motion.gravity_ground_m_s2,
            sample_rate_hz: motion.sample_rate_hz,
            limb_force_per_mass_m_s2: motion.limb_force_per_mass_m_s2,
            truth: motion.truth,
        })
    }

    /// Every `factor`-th sample.
    #[must_use]
    pub fn decimated(&self, factor: usize) -> Self {
        Self {
            sample_rate_hz: self.sample_rate_hz / factor as f64,
            limb_force_per_mass_m_s2: self
                .limb_force_per_mass_m_s2
                .iter()
                .copied()
                .step_by(factor)
                .collect(),
            truth: self.truth.iter().copied().step_by(factor).collect(),
            ..self.clone()
        }
    }

    /// Length of the run, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.truth.len() as f64 / self.sample_rate_hz
    }
}
