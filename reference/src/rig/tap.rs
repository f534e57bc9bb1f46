//! A tap on the shell: it jerks and stands still again, and the mass rings in it.
//!
//! The rig holds the shell, so that what a hammer does to it is over when the contact is: a bump of velocity and, about
//! any axis, of rate, from rest to rest, as smooth as its third derivative. Nothing of the mass's motion is prescribed.

use core::f64::consts::PI;

use glam::DVec3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, UnitSphere};

use crate::motion::Motion;

/// Samples per second of a tap's recording.
pub const SAMPLE_RATE_HZ: f64 = 50_000.0;
/// Runge-Kutta steps from sample to sample: as in a ring-down 2 us, whose phase error (w h)^4/120 is 1 ppm of k/m (3 of random sensors).
pub const STEPS_PER_SAMPLE: usize = 10;
/// Length of the recording, s.
pub const DURATION_S: f64 = 0.03;

/// Rest before the tap, from and to, s: a pre-trigger.
const REST_S: (f64, f64) = (1e-3, 3e-3);
/// Length of the contact, from and to, s: half of it each way.
const CONTACT_S: (f64, f64) = (0.1e-3, 0.25e-3);
/// Peak velocity of the shell, from and to, m/s: limb forces of 50 to 600 m/s^2 over the mass.
const SPEED_M_S: (f64, f64) = (5e-3, 30e-3);
/// Arm of the tap about the shell's centre, from and to, m: a shell is some centimetres large.
const ARM_M: (f64, f64) = (10e-3, 30e-3);

/// One tap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tap {
    /// When it begins, s.
    pub start_s: f64,
    /// From rest to rest, s.
    pub contact_s: f64,
    /// Peak velocity of the shell, ground axes, m/s.
    pub velocity_ground_m_s: DVec3,
    /// Peak rate of the shell, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
}

impl Tap {
    /// A tap of any direction off the centre, as a hand gives it.
    pub fn random(rng: &mut impl Rng) -> Self {
        let mut direction = || DVec3::from_array(UnitSphere.sample(rng));
        let (along, about) = (direction(), direction());
        let mut within = |(from, to): (f64, f64)| rng.random_range(from..to);
        let speed = within(SPEED_M_S);
        Self {
            start_s: within(REST_S),
            contact_s: within(CONTACT_S),
            velocity_ground_m_s: along * speed,
            rate_shell_rad_s: about * (speed / within(ARM_M)),
        }
    }
}

impl Motion for Tap {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let x = (time_s - self.start_s) / self.contact_s;
        if !(0.0..=1.0).contains(&x) {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        // The velocity is sin^4: nothing in it jumps that a step of Runge and Kutta would notice.
        let (sin, cos) = (PI * x).sin_cos();
        let slope = 4.0 * PI * sin * sin * sin * cos / self.contact_s;
        (
            self.velocity_ground_m_s * slope,
            self.rate_shell_rad_s * slope,
        )
    }
}
