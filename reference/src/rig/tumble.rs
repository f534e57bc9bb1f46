//! Motions beyond the rig: all six axes at once, about an axis that turns, as fast as one likes.
//!
//! A rig run has one fixed direction. It never shows whether rotations are composed in the right order, whether the
//! attitude follows an axis that turns (coning), or whether w x I w couples the axes as it should; a tumble does.

use core::f64::consts::TAU;

use glam::DVec3;

use crate::motion::Motion;
use crate::smooth_step::smooth_step;

/// Sines along each axis.
pub const SINES: usize = 3;

/// One sine: amplitude in the unit of what it is part of, frequency, phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    /// Amplitude along each axis.
    pub amplitude: DVec3,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase along each axis, rad.
    pub phase_rad: DVec3,
}

impl Sine {
    /// Value and first two derivatives.
    pub(super) fn at(&self, time_s: f64) -> [DVec3; 3] {
        let omega = TAU * self.frequency_hz;
        let phase = (self.phase_rad + DVec3::splat(omega * time_s)).to_array();
        let sin = DVec3::from_array(phase.map(f64::sin)) * self.amplitude;
        let cos = DVec3::from_array(phase.map(f64::cos)) * self.amplitude;
        [sin, omega * cos, -(omega * omega) * sin]
    }
}

/// Position and rate as sums of sines, let in smoothly from rest.
///
/// The shell's position is a window times a sum of sines, and so is its rate in shell axes: positions stay bounded, the
/// attitude goes where the rate takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tumble {
    /// Position of the shell, ground axes, m.
    pub position_ground_m: [Sine; SINES],
    /// Rate of the shell, shell axes, rad/s.
    pub rate_shell_rad_s: [Sine; SINES],
    /// Time over which the window rises from 0 to 1, s.
    pub rise_s: f64,
}

impl Tumble {
    /// Rate of the shell, shell axes, rad/s.
    pub fn rate_shell_at_rad_s(&self, time_s: f64) -> DVec3 {
        smooth_step(time_s / self.rise_s)[1] * sum(&self.rate_shell_rad_s, time_s)[0]
    }

    /// Highest frequency in it, Hz.
    pub fn highest_frequency_hz(&self) -> f64 {
        self.position_ground_m
            .iter()
            .chain(&self.rate_shell_rad_s)
            .map(|sine| sine.frequency_hz)
            .fold(0.0, f64::max)
    }
}

/// Value and first two derivatives of a sum of sines.
pub(super) fn sum(sines: &[Sine; SINES], time_s: f64) -> [DVec3; 3] {
    sines
        .iter()
        .map(|sine| sine.at(time_s))
        .fold([DVec3::ZERO; 3], |a, b| {
            core::array::from_fn(|i| a[i] + b[i])
        })
}

impl Motion for Tumble {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let [_, w, dw, ddw] = smooth_step(time_s / self.rise_s);
        let (dw, ddw) = (dw / self.rise_s, ddw / (self.rise_s * self.rise_s));
        let [p, dp, ddp] = sum(&self.position_ground_m, time_s);
        let [r, dr, _] = sum(&self.rate_shell_rad_s, time_s);
        (ddw * p + 2.0 * dw * dp + w * ddp, dw * r + w * dr)
    }
}
