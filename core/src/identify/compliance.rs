//! What steps 2 and 3 neglect, kept: the motion of the mass in the shell.
//!
//! The paper's steps take the limbs as rigid, (12) and (15), which costs 1.5e-6 of s/m at 2 Hz. Once k/m is known
//! roughly, each sample's relative motion follows from its own forces, and the *full* equations (3) and (8) are as
//! linear in the unknowns as the short ones. Repeating steps 2 to 4 with them removes the neglect.

use glam::DVec3;

use super::inertia::InertiaIdentification;
use super::scale::ScaleIdentification;
use crate::decoupler::{Sensor, Settings, StaticResponse};
use crate::dynamics::limb_directions;
use crate::error::{Error, Result};
use crate::geometry::{LIMBS, LIMBS_PER_NODE};
use crate::parameters::Parameters;
use crate::pose::{Pose, RelativeMotion};
use crate::preload::static_preload_m_s2;
use crate::signal::SignalChain;

/// Turns a recording, sample by sample, into rows of the full equations.
#[derive(Debug, Clone, PartialEq)]
pub struct CompliantRows {
    sensor: Sensor,
    chain: SignalChain,
    parameters: Parameters,
    settings: Settings,
    preload_m_s2: [f64; LIMBS],
    window: [(Pose, [f64; LIMBS]); 2],
    received: usize,
}

/// One sample with its relative motion, ready to be pushed into either step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompliantSample {
    /// Index of the voltage sample.
    pub sample: usize,
    /// f~_i, N.
    measured_force_n: [f64; LIMBS],
    /// Whole force per mass with the parameters so far, m/s^2.
    force_per_mass_m_s2: [f64; LIMBS],
    preload_m_s2: [f64; LIMBS],
    relative: RelativeMotion,
}

impl CompliantRows {
    /// Starts on one recording with the parameters found so far.
    ///
    /// # Errors
    /// Those of validation and of the static equilibrium.
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        sensor.geometry.validate()?;
        sensor.gains.validate()?;
        parameters.validate()?;
        let preload_m_s2 = match settings.static_response {
            StaticResponse::Full => [0.0; LIMBS],
            StaticResponse::Tared => static_preload_m_s2(
                &sensor.geometry,
                parameters.stiffness_per_mass_per_s2,
                settings.initial_attitude.inverse() * settings.gravity_ground_m_s2,
            )?,
        };
        Ok(Self {
            sensor: *sensor,
            chain: SignalChain::new(&sensor.gains, parameters),
            parameters: *parameters,
            settings: *settings,
            preload_m_s2,
            window: [(Pose::default(), [0.0; LIMBS]); 2],
            received: 0,
        })
    }

    /// Takes the next voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::LimbsDoNotMeet`].
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<CompliantSample>> {
        for (channel, &value) in voltage_v.iter().enumerate() {
            if !value.is_finite() {
                return Err(Error::NotFinite {
                    channel: channel + 1,
                    sample: self.received,
                    value,
                });
            }
        }
        let dynamic = self.chain.force_per_mass_m_s2(voltage_v);
        let force: [f64; LIMBS] = core::array::from_fn(|i| dynamic[i] + self.preload_m_s2[i]);
        let elongation = self
            .settings
            .limb_law
            .elongations_m(&force, self.parameters.stiffness_per_mass_per_s2);
        let pose = Pose::from_elongations(&self.sensor.geometry, &elongation)?;
        let measured = self
            .sensor
            .gains
            .measured_force_n(voltage_v, &self.parameters.zero_drift_v);
        let [(before, _), (now, now_measured)] = self.window;
        self.window = [self.window[1], (pose, measured)];
        self.received += 1;
        if self.received < 3 {
            return Ok(None);
        }
        Ok(Some(CompliantSample {
            sample: self.received - 2,
            measured_force_n: now_measured,
            force_per_mass_m_s2: core::array::from_fn(|i| {
                self.parameters.scale_per_mass_per_kg[i] * now_measured[i] + self.preload_m_s2[i]
            }),
            preload_m_s2: self.preload_m_s2,
            relative: RelativeMotion::from_poses(
                &before,
                &now,
                &pose,
                1.0 / self.settings.sample_rate_hz,
            ),
        }))
    }

    /// Adds the three rows of (3) for pure linear motion: sum (s_i/m) f~_i e_i = a + a_r - g - sum preload_i e_i.
    ///
    /// `acceleration_shell_m_s2` is the reference acceleration at that sample.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn push_scale(
        &self,
        step: &mut ScaleIdentification,
        sample: &CompliantSample,
        acceleration_shell_m_s2: DVec3,
    ) -> Result<()> {
        let directions = limb_directions(&self.sensor.geometry, &sample.relative.pose);
        let gravity = self.settings.initial_attitude.inverse() * self.settings.gravity_ground_m_s2;
        let mut right = acceleration_shell_m_s2 + sample.relative.acceleration_shell_m_s2 - gravity;
        for (direction, preload) in directions.iter().zip(sample.preload_m_s2) {
            right -= *direction * preload;
        }
        step.push_along(&sample.measured_force_n, &directions, right)
    }

    /// Adds the three rows of (8) for pure angular motion, as Euler's equation of the *mass* in its own axes:
    /// (I/m) W' + W x (I/m) W = R_r^T sum (f_i/m) t_i x e_i with W = R_r^T (w* + w_r),
    /// W' = R_r^T (w*' + eps + w* x w_r).
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn push_inertia(
        &self,
        step: &mut InertiaIdentification,
        sample: &CompliantSample,
        rate_shell_rad_s: DVec3,
        rate_derivative_shell_rad_s2: DVec3,
    ) -> Result<()> {
        let relative = &sample.relative;
        let back = relative.pose.rotation_matrix().transpose();
        let rate = rate_shell_rad_s + relative.rate_shell_rad_s;
        let derivative = rate_derivative_shell_rad_s2
            + relative.angular_acceleration_shell_rad_s2
            + rate_shell_rad_s.cross(relative.rate_shell_rad_s);
        let directions = limb_directions(&self.sensor.geometry, &relative.pose);
        let mut torque_mass = DVec3::ZERO;
        for (limb, direction) in directions.iter().enumerate() {
            let arm = self.sensor.geometry.node_mass_m(limb / LIMBS_PER_NODE);
            torque_mass += arm.cross(back * *direction) * sample.force_per_mass_m_s2[limb];
        }
        step.push_torque(torque_mass, back * rate, back * derivative)
    }
}
