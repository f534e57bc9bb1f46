//! Means of consecutive samples.

use glam::{DQuat, DVec3};

use crate::geometry::LIMBS;
use crate::six_axis::SixAxis;

/// Rotation after which a block ends, rad: over it, what turns with the shell is taken at the block's middle.
const LARGEST_TURN_RAD: f64 = 0.2;

/// What the filter needs to know of consecutive samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Its length, s.
    pub duration_s: f64,
    /// Mean voltages.
    pub voltage_v: [f64; LIMBS],
    /// Mean of w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Mean of w', ground axes, rad/s^2.
    pub angular_ground_rad_s2: DVec3,
    /// R at its last sample.
    pub attitude: DQuat,
}

impl Block {
    /// One decoupled sample with its voltages: what an error does there.
    #[must_use]
    pub const fn of_sample(voltage_v: &[f64; LIMBS], sample: &SixAxis) -> Self {
        Self {
            duration_s: 0.0,
            voltage_v: *voltage_v,
            rate_shell_rad_s: sample.rate_shell_rad_s,
            angular_ground_rad_s2: sample.angular_ground_rad_s2,
            attitude: sample.attitude,
        }
    }
}

/// Adds up samples until a block is full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gathering {
    step_s: f64,
    longest: u32,
    samples: u32,
    voltage_v: [f64; LIMBS],
    rate: DVec3,
    angular: DVec3,
}

impl Gathering {
    /// Blocks of `longest_s`, of one sample at least.
    #[must_use]
    pub fn new(sample_rate_hz: f64, longest_s: f64) -> Self {
        Self {
            step_s: 1.0 / sample_rate_hz,
            longest: (longest_s * sample_rate_hz) as u32,
            samples: 0,
            voltage_v: [0.0; LIMBS],
            rate: DVec3::ZERO,
            angular: DVec3::ZERO,
        }
    }

    /// Takes a decoupled sample with the voltages of that same sample; returns the block that it completes.
    #[inline]
    pub fn push(&mut self, voltage_v: &[f64; LIMBS], sample: &SixAxis) -> Option<Block> {
        for (sum, v) in self.voltage_v.iter_mut().zip(voltage_v) {
            *sum += v;
        }
        self.rate += sample.rate_shell_rad_s;
        self.angular += sample.angular_ground_rad_s2;
        self.samples += 1;
        let turned = self.rate.length_squared() * self.step_s * self.step_s;
        if self.samples < self.longest && turned < LARGEST_TURN_RAD * LARGEST_TURN_RAD {
            return None;
        }
        let share = 1.0 / f64::from(self.samples);
        let block = Block {
            duration_s: f64::from(self.samples) * self.step_s,
            voltage_v: self.voltage_v.map(|sum| sum * share),
            rate_shell_rad_s: self.rate * share,
            angular_ground_rad_s2: self.angular * share,
            attitude: sample.attitude,
        };
        self.samples = 0;
        self.voltage_v = [0.0; LIMBS];
        self.rate = DVec3::ZERO;
        self.angular = DVec3::ZERO;
        Some(block)
    }
}
