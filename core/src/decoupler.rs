//! Nine voltages in, six accelerations out: the whole of the paper's section 2.1 as a stream.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::attitude;
use crate::dynamics::{Instant, LimbWrench, MassInertia};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, LIMBS};
use crate::integrator::{Integrator, Scheme, Settled, SettledPair};
use crate::limbs::LimbStream;
use crate::parameters::Parameters;
use crate::pose::{LimbLaw, RelativeMotion};
use crate::signal::Gains;

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

    pub(crate) fn validate(&self) -> Result<()> {
        let out_of_range = |name, value, requirement| {
            Err(Error::OutOfRange {
                name,
                value,
                requirement,
            })
        };
        let rate = self.sample_rate_hz;
        // Differences are divided by the square of the step.
        if !(rate > 0.0 && (rate * rate).is_normal()) {
            return out_of_range(
                "sample_rate_hz",
                rate,
                "positive and finite, and its square, too",
            );
        }
        for (name, vector) in [
            ("gravity_ground_m_s2", self.gravity_ground_m_s2),
            ("initial_rate_shell_rad_s", self.initial_rate_shell_rad_s),
        ] {
            if !vector.length().is_finite() {
                return out_of_range(name, vector.length(), "finite, and its square, too");
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
/// A sample is decoupled when its successor arrives; the first and the last sample of a stream yield nothing (see
/// [`crate::limbs`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Decoupler {
    limbs: LimbStream,
    inertia: MassInertia,
    integrator: Integrator,
    gravity_ground_m_s2: DVec3,
    initial_attitude: DQuat,
    step_s: f64,
    last: Option<Output>,
}

/// A decoupled sample with its angular acceleration in shell axes, from which the next attitude follows.
type Output = (SixAxis, DVec3);

impl Decoupler {
    /// Prepares a decoupler.
    ///
    /// # Errors
    /// Those of [`LimbStream::new`], which checks every argument.
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        let limbs = LimbStream::new(sensor, parameters, settings)?;
        let step_s = 1.0 / settings.sample_rate_hz;
        Ok(Self {
            limbs,
            inertia: MassInertia::new(&parameters.inertia_per_mass),
            integrator: Integrator::new(settings.scheme, step_s, settings.initial_rate_shell_rad_s),
            gravity_ground_m_s2: settings.gravity_ground_m_s2,
            initial_attitude: settings.initial_attitude,
            step_s,
            last: None,
        })
    }

    /// Takes the next nine voltages and returns the samples that they complete.
    ///
    /// # Errors
    /// Those of [`LimbStream::push`]; [`Error::Overflow`] if the sample would make an answer that no f64 holds. The
    /// decoupler is unchanged by a refused sample: a rate that has run away is refused for good.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Decoupled> {
        let (entry, sample) = self.limbs.look(voltage_v)?;
        let Some(now) = sample else {
            self.limbs.accept(entry);
            return Ok([None, None]);
        };
        let pose = &now.relative.pose;
        let wrench = LimbWrench::at_pose(self.limbs.geometry(), pose, &now.force_per_mass_m_s2);
        let instant = Instant::new(now.relative, wrench, &self.inertia);
        let settled = self.integrator.settle(&instant);
        let outputs = self.decouple_pair(&settled);
        // A sample that a pairwise scheme holds back must be sound if the stream ends here.
        let held = self.integrator.held(&instant, &settled);
        let held = held.map(|settled| self.decouple(self.last.as_ref(), &settled));
        if !outputs.iter().flatten().chain(&held).all(is_finite) {
            return Err(Error::Overflow {
                what: "decoupling",
                channel: 0,
                sample: self.limbs.awaited(),
            });
        }
        self.limbs.accept(entry);
        self.integrator.accept(instant, &settled);
        let [first, second] = outputs;
        self.last = second.or(first).or(self.last);
        Ok(outputs.map(|output| output.map(|(sample, _)| sample)))
    }

    /// Ends the stream and returns the sample that a pairwise scheme may still hold.
    pub fn finish(mut self) -> Option<SixAxis> {
        let settled = self.integrator.finish()?;
        Some(self.decouple(self.last.as_ref(), &settled).0)
    }

    #[inline]
    fn decouple_pair(&self, settled: &SettledPair) -> [Option<Output>; 2] {
        let [first, second] = settled;
        let first = first.map(|s| self.decouple(self.last.as_ref(), &s));
        let second = second.map(|s| self.decouple(first.as_ref(), &s));
        [first, second]
    }

    #[inline]
    fn decouple(&self, last: Option<&Output>, settled: &Settled) -> Output {
        let rate = settled.rate_shell_rad_s;
        let angular_shell = settled.angular_acceleration_shell_rad_s2;
        let (sample, attitude) = match last {
            None => (1, self.initial_attitude),
            Some((last, last_angular_shell)) => (
                last.sample + 1,
                attitude::advance(
                    last.attitude,
                    [last.rate_shell_rad_s, rate],
                    [*last_angular_shell, angular_shell],
                    self.step_s,
                ),
            ),
        };
        let specific_force = settled
            .instant
            .specific_force_shell_m_s2(rate, angular_shell);
        let output = SixAxis {
            sample,
            linear_ground_m_s2: attitude * specific_force + self.gravity_ground_m_s2,
            angular_ground_rad_s2: attitude * angular_shell,
            rate_shell_rad_s: rate,
            attitude,
            relative: settled.instant.relative,
        };
        (output, angular_shell)
    }
}

fn is_finite((sample, angular_shell): &Output) -> bool {
    sample.linear_ground_m_s2.is_finite()
        && sample.angular_ground_rad_s2.is_finite()
        && sample.rate_shell_rad_s.is_finite()
        && sample.attitude.is_finite()
        && angular_shell.is_finite()
}
