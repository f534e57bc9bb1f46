//! A motion of the shell, prescribed, and what a simulation makes of it: limb forces and true motion, sample by sample.

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::geometry::LIMBS;
use crate::rig::run::Run;

/// Position law of the shell: acceleration as a function of time, from rest at the origin with axes along the ground's.
pub trait Motion: Sync {
    /// Linear acceleration of the shell, ground axes, m/s^2, and angular acceleration, shell axes, rad/s^2.
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3);
}

/// One sample of the shell's true motion, from the simulator's state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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

impl TrueMotion {
    /// Held still, turned so.
    pub const fn at_rest(attitude: DQuat) -> Self {
        Self {
            linear_ground_m_s2: DVec3::ZERO,
            angular_ground_rad_s2: DVec3::ZERO,
            rate_shell_rad_s: DVec3::ZERO,
            attitude,
        }
    }

    /// Acceleration less gravity, shell axes, m/s^2.
    pub fn specific_force_shell_m_s2(&self, gravity_ground_m_s2: DVec3) -> DVec3 {
        self.attitude.inverse() * (self.linear_ground_m_s2 - gravity_ground_m_s2)
    }

    /// What a point of the shell, m from its centre, is accelerated by beside that centre, shell axes, m/s^2.
    pub fn carried_m_s2(&self, point_m: DVec3) -> DVec3 {
        let rate = self.rate_shell_rad_s;
        let angular = self.attitude.inverse() * self.angular_ground_rad_s2;
        angular.cross(point_m) + rate.cross(rate.cross(point_m))
    }
}

/// A motion as a simulator saw it: limb forces and true motion at the sampling instants.
#[derive(Debug, Clone)]
pub struct SimulatedMotion<M> {
    /// The motion that was prescribed.
    pub motion: M,
    /// Gravity, ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whole limb forces per mass, gravity's share included, m/s^2.
    pub limb_force_per_mass_m_s2: Vec<[f64; LIMBS]>,
    /// True motion.
    pub truth: Vec<TrueMotion>,
}

/// A simulated run of the rig.
pub type SimulatedRun = SimulatedMotion<Run>;

impl<M: Clone> SimulatedMotion<M> {
    /// Every `factor`-th sample.
    pub fn decimated(&self, factor: usize) -> Self {
        let forces = &self.limb_force_per_mass_m_s2;
        Self {
            motion: self.motion.clone(),
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            sample_rate_hz: self.sample_rate_hz / factor as f64,
            limb_force_per_mass_m_s2: forces.iter().copied().step_by(factor).collect(),
            truth: self.truth.iter().copied().step_by(factor).collect(),
        }
    }
}
