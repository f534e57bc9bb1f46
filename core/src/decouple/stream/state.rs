//! What a stream starts with and what it carries from sample to sample.

use glam::DVec3;

use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, Quaternion};
use crate::kernel::number::{Real, Scalar};
use crate::kernel::placement::LimbLoad;
use crate::kernel::rate::RateIntegrator;
use crate::kernel::shell::{RelativePose, ShellMotion};
use crate::kernel::vec3::{Vec3, vec3};
use crate::model::Settings;

/// What the first decoupled sample begins with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start<T: Real> {
    /// w*, shell axes, rad per sample.
    pub rate: Vec3<T>,
    pub attitude: Quaternion<T>,
}

impl<T: Scalar> Start<T> {
    pub fn new(settings: &Settings) -> Self {
        let numbers = |v: DVec3| vec3(T::from_f64(v.x), T::from_f64(v.y), T::from_f64(v.z));
        let q = settings.initial_attitude;
        Self {
            rate: numbers(settings.initial_rate_shell_rad_s / settings.sample_rate_hz),
            attitude: Quaternion {
                w: T::from_f64(q.w),
                v: numbers(q.xyz()),
            },
        }
    }
}

/// What is carried from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State<T: Real> {
    /// Samples taken so far.
    pub received: u64,
    /// Pose of the mass two samples ago.
    pub before: RelativePose<T>,
    /// The last sample, whose successor is to come.
    pub now: LimbLoad<T>,
    /// The mass's rate at the sample before the last, and what the scheme remembers.
    pub spin: RateIntegrator<T>,
    /// The shell's motion there.
    pub shell: ShellMotion<T>,
    /// Its attitude there.
    pub attitude: Quaternion<T>,
}

impl<T: Scalar> State<T> {
    /// Whether the shell turns further in a sample than the polynomials of the rotation hold for: the fast ways are of no use then.
    pub fn turns_far(&self) -> bool {
        let rate = self.shell.rate;
        // Half of it is the half angle of a step.
        rate.dot(rate) > T::from_f64(4.0 * HALF_ANGLE_SQUARED_LIMIT)
    }
}
