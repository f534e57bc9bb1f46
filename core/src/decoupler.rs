//! Nine voltages in, six accelerations out: the whole of the paper's section 2.1 as a stream.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::attitude;
use crate::dynamics::{Instant, LimbWrench, MassInertia};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, LIMBS};
use crate::integrator::{Integrator, Scheme, Settled};
use crate::parameters::Parameters;
use crate::pose::{LimbLaw, Pose, RelativeMotion};
use crate::preload::static_preload_m_s2;
use crate::signal::{Gains, SignalChain};

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

/// What is known of the sensor without identification.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Lengths from the drawing.
    pub geometry: Geometry,
    /// c_i of the amplifier setting in use.
    pub gains: Gains,
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
            gravity_ground_m_s2: DVec3::ZERO,
            initial_attitude: DQuat::IDENTITY,
            initial_rate_shell_rad_s: DVec3::ZERO,
        }
    }

    fn validate(&self) -> Result<()> {
        let out_of_range = |name, value, requirement| {
            Err(Error::OutOfRange {
                name,
                value,
                requirement,
            })
        };
        let rate = self.sample_rate_hz;
        if !(rate.is_finite() && rate > 0.0) {
            return out_of_range("sample_rate_hz", rate, "positive and finite");
        }
        for (name, vector) in [
            ("gravity_ground_m_s2", self.gravity_ground_m_s2),
            ("initial_rate_shell_rad_s", self.initial_rate_shell_rad_s),
        ] {
            if !vector.is_finite() {
                return out_of_range(name, vector.length(), "finite");
            }
        }
        if !self.initial_attitude.is_normalized() {
            return out_of_range(
                "initial_attitude",
                self.initial_attitude.length(),
                "a unit quaternion",
            );
        }
        Ok(())
    }
}

/// One decoupled sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SixAxis {
    /// Index of the voltage sample that this belongs to, from 0.
    pub sample: u64,
    /// a, linear acceleration of the shell, ground axes, m/s^2.
    pub linear_ground_m_s2: DVec3,
    /// w', angular acceleration of the shell, ground axes, rad/s^2.
    pub angular_ground_rad_s2: DVec3,
    /// w*, angular velocity of the shell, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// R, shell axes to ground axes.
    pub attitude: DQuat,
    /// Motion of the mass in the shell.
    pub relative: RelativeMotion,
}

/// Decoupled samples that one voltage sample completes: none, one or two, in order of time.
pub type Decoupled = [Option<SixAxis>; 2];

/// Streaming decoupler: no allocation, constant work per sample.
///
/// Rates and accelerations of the mass in the shell are central differences of its pose, so a sample is decoupled
/// when its successor arrives; the first and the last sample of a stream have no such neighbour and yield nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoupler {
    geometry: Geometry,
    chain: SignalChain,
    inertia: MassInertia,
    stiffness_per_mass_per_s2: f64,
    preload_m_s2: [f64; LIMBS],
    settings: Settings,
    step_s: f64,
    received: u64,
    /// Pose and force of the two samples before the newest, oldest first.
    window: [(Pose, [f64; LIMBS]); 2],
    integrator: Integrator,
    last: Option<SixAxis>,
    last_angular_shell: DVec3,
}

impl Decoupler {
    /// Prepares a decoupler; every argument is checked here so that the stream need not be.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::ImpossibleInertia`] for arguments that mean nothing,
    /// [`Error::NotConverged`] if gravity finds no equilibrium.
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        sensor.geometry.validate()?;
        sensor.gains.validate()?;
        parameters.validate()?;
        settings.validate()?;
        let preload_m_s2 = match settings.static_response {
            StaticResponse::Full => [0.0; LIMBS],
            StaticResponse::Tared => static_preload_m_s2(
                &sensor.geometry,
                parameters.stiffness_per_mass_per_s2,
                settings.initial_attitude.inverse() * settings.gravity_ground_m_s2,
            )?,
        };
        let step_s = 1.0 / settings.sample_rate_hz;
        Ok(Self {
            geometry: sensor.geometry,
            chain: SignalChain::new(&sensor.gains, parameters),
            inertia: MassInertia::new(&parameters.inertia_per_mass),
            stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
            preload_m_s2,
            settings: *settings,
            step_s,
            received: 0,
            window: [(Pose::default(), [0.0; LIMBS]); 2],
            integrator: Integrator::new(settings.scheme, step_s, settings.initial_rate_shell_rad_s),
            last: None,
            last_angular_shell: DVec3::ZERO,
        })
    }

    /// Takes the next nine voltages and returns the samples that they complete.
    ///
    /// # Errors
    /// [`Error::NotFinite`] names channel and sample; [`Error::LimbsDoNotMeet`] for forces that no assembled sensor
    /// can carry. The decoupler is unchanged by a refused sample.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Decoupled> {
        for (channel, &value) in voltage_v.iter().enumerate() {
            if !value.is_finite() {
                return Err(Error::NotFinite {
                    channel: channel + 1,
                    sample: self.received as usize,
                    value,
                });
            }
        }
        let dynamic = self.chain.force_per_mass_m_s2(voltage_v);
        let force: [f64; LIMBS] = core::array::from_fn(|i| dynamic[i] + self.preload_m_s2[i]);
        let elongation = self
            .settings
            .limb_law
            .elongations_m(&force, self.stiffness_per_mass_per_s2);
        let pose = Pose::from_elongations(&self.geometry, &elongation)?;

        let [(before, _), (now, now_force)] = self.window;
        self.window = [self.window[1], (pose, force)];
        self.received += 1;
        if self.received < 3 {
            return Ok([None, None]);
        }
        let relative = RelativeMotion::from_poses(&before, &now, &pose, self.step_s);
        let wrench = LimbWrench::at_pose(&self.geometry, &now, &now_force);
        let settled = self
            .integrator
            .push(Instant::new(relative, wrench, &self.inertia));
        Ok(settled.map(|settled| settled.map(|s| self.decouple(&s))))
    }

    /// Ends the stream and returns the sample that a pairwise scheme may still hold.
    pub fn finish(mut self) -> Option<SixAxis> {
        let settled = self.integrator.finish()?;
        Some(self.decouple(&settled))
    }

    fn decouple(&mut self, settled: &Settled) -> SixAxis {
        let rate = settled.rate_shell_rad_s;
        let angular_shell = settled.angular_acceleration_shell_rad_s2;
        let (sample, attitude) = match &self.last {
            None => (1, self.settings.initial_attitude),
            Some(last) => (
                last.sample + 1,
                attitude::advance(
                    last.attitude,
                    [last.rate_shell_rad_s, rate],
                    [self.last_angular_shell, angular_shell],
                    self.step_s,
                ),
            ),
        };
        let specific_force = settled
            .instant
            .specific_force_shell_m_s2(rate, angular_shell);
        let output = SixAxis {
            sample,
            linear_ground_m_s2: attitude * specific_force + self.settings.gravity_ground_m_s2,
            angular_ground_rad_s2: attitude * angular_shell,
            rate_shell_rad_s: rate,
            attitude,
            relative: settled.instant.relative,
        };
        self.last = Some(output);
        self.last_angular_shell = angular_shell;
        output
    }
}
