//! The calibration rig: two crank-sliders coupled by rack and pinion, and wedges that tilt the sensor.
//!
//! A crank runs up from rest to its speed, turns evenly and runs down again, so that every run begins and ends at
//! rest where it began. With an endless connecting rod slider travel is A sin(phi); the crank angle phi(t) is a position law with
//! four continuous derivatives, because an acceleration that merely starts as a sine drifts away for ever. A real rig departs
//! from this in what a [`Run`] states besides: a rod of finite length, and a sensor whose centre is off the pinion's axis.

use core::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::motion::Motion;
use crate::smooth_step::smooth_step;

/// Slider amplitude that the paper's three printed maxima imply at 5 Hz, m: 9.36 g / (2 pi 5 Hz)^2.
pub const SLIDER_AMPLITUDE_M: f64 = 0.0930;

/// Rotation amplitude that they imply, rad: 3142.86 deg/s / (2 pi 5 Hz).
pub const ROTATION_AMPLITUDE_RAD: f64 = 100.04 * PI / 180.0;

/// The wedges: six directions that turn up in the paper's tables or are the sensor's own axes.
pub const WEDGES: [DVec3; 6] = [
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
    DVec3::new(1.0, 1.0, 2.0),
    DVec3::new(1.0, 2.0, 1.0),
    DVec3::new(2.0, 1.0, 1.0),
];

/// Which motor turns and whether the rack is engaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Rack disengaged, motor 1 turns: pure linear motion.
    Linear,
    /// Rack engaged, motor 1 braked, motor 2 turns: pure angular motion.
    Angular,
    /// Rack engaged, motor 1 turns, motor 2 braked: the pinion rolls along the rack.
    Compound,
    /// Both motors stand.
    Rest,
}

/// One run of the rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Run {
    /// What moves.
    pub mode: Mode,
    /// Crank frequency once up to speed, Hz.
    pub frequency_hz: f64,
    /// Unit vector of travel and of the pinion's axis in the sensor's axes at rest: what the wedge sets.
    ///
    /// One vector for both, as the targets of Tables 4 to 6 have it, although a pinion's axis is square to its travel.
    pub direction_ground: DVec3,
    /// Slider amplitude (half the stroke), m.
    pub slider_amplitude_m: f64,
    /// Rotation amplitude, rad.
    pub rotation_amplitude_rad: f64,
    /// Rest before the crank starts and after it stops, s.
    pub rest_s: f64,
    /// Run-up and run-down time in crank periods; each turns the crank by half of it.
    pub ramp_periods: f64,
    /// Turns at full speed. A run ends where it began if these and `ramp_periods` make whole turns.
    pub steady_periods: f64,
    /// Crank over connecting rod, 0 for an endless rod, below 1: travel then has a second harmonic.
    pub crank_over_rod: f64,
    /// From the pinion's axis to the sensor's centre, shell axes, m. What of it lies along the axis has no effect.
    pub centre_offset_shell_m: DVec3,
}

impl Run {
    /// A run at the rig's own amplitudes.
    pub fn new(mode: Mode, frequency_hz: f64, direction: DVec3) -> Self {
        Self {
            mode,
            frequency_hz,
            direction_ground: direction.normalize(),
            slider_amplitude_m: SLIDER_AMPLITUDE_M,
            rotation_amplitude_rad: ROTATION_AMPLITUDE_RAD,
            rest_s: 0.05,
            // A whole period to run up keeps the start's spectrum below the laboratory's low-pass; with half a turn in
            // each ramp the run makes two whole turns, and the slider ends where it began.
            ramp_periods: 1.0,
            steady_periods: 1.0,
            crank_over_rod: 0.0,
            centre_offset_shell_m: DVec3::ZERO,
        }
    }

    /// Start and end of the whole turns at full speed, s.
    pub fn steady_span_s(&self) -> (f64, f64) {
        let start = self.rest_s + self.ramp_periods / self.frequency_hz;
        (
            start,
            start + self.steady_periods.floor() / self.frequency_hz,
        )
    }

    /// Length of the whole run, s.
    pub fn duration_s(&self) -> f64 {
        2.0 * self.rest_s + (2.0 * self.ramp_periods + self.steady_periods) / self.frequency_hz
    }

    /// Place on the stroke, 2 from end to end and 0 at the start, and its first two derivatives: multiplied by the amplitudes, travel and angle.
    ///
    /// With c the crank over the rod, x = sin(phi) + (sqrt(1 - c^2 cos^2 phi) - sqrt(1 - c^2)) / c, which begins at 0, spans a
    /// stroke of 2 whatever the rod, and has a second harmonic of c/4 + c^3/16 + ... of the crank.
    pub fn stroke_share(&self, time_s: f64) -> [f64; 3] {
        let [phase, rate, slope] = self.crank(time_s);
        let (sin, cos) = phase.sin_cos();
        let c = self.crank_over_rod;
        // The rod's shadow on the travel over its length.
        let shadow = (1.0 - (c * cos).powi(2)).sqrt();
        // As a difference of roots divided by c this would have no digits for a long rod.
        let place = sin + c * sin * sin / (shadow + (1.0 - c * c).sqrt());
        let by_phase = cos + c * sin * cos / shadow;
        let by_phase_twice = -sin + c * (2.0 * cos * cos - 1.0) / shadow
            - c.powi(3) * (sin * cos).powi(2) / shadow.powi(3);
        [
            place,
            rate * by_phase,
            slope * by_phase + rate * rate * by_phase_twice,
        ]
    }

    /// Amplitudes that the mode makes use of: travel, m, and rotation, rad.
    pub fn amplitudes(&self) -> (f64, f64) {
        let (travel, rotation) = (self.slider_amplitude_m, self.rotation_amplitude_rad);
        match self.mode {
            Mode::Linear => (travel, 0.0),
            Mode::Angular => (0.0, rotation),
            Mode::Compound => (travel, rotation),
            Mode::Rest => (0.0, 0.0),
        }
    }

    /// Crank angle, rad, and its first two derivatives.
    fn crank(&self, time_s: f64) -> [f64; 3] {
        let rate = TAU * self.frequency_hz;
        let ramp = self.ramp_periods / self.frequency_hz;
        let steady = self.steady_periods / self.frequency_hz;
        let t = time_s - self.rest_s;
        let total = 2.0 * ramp + steady;
        if t <= 0.0 {
            [0.0; 3]
        } else if t < ramp {
            let [integral, value, slope, _] = smooth_step(t / ramp);
            [rate * ramp * integral, rate * value, rate * slope / ramp]
        } else if t <= ramp + steady {
            [rate * (0.5 * ramp + (t - ramp)), rate, 0.0]
        } else if t < total {
            let [integral, value, slope, _] = smooth_step((total - t) / ramp);
            let whole = rate * (ramp + steady);
            [
                whole - rate * ramp * integral,
                rate * value,
                -rate * slope / ramp,
            ]
        } else {
            [rate * (ramp + steady), 0.0, 0.0]
        }
    }
}

impl Motion for Run {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let [place, speed, acceleration] = self.stroke_share(time_s);
        let (travel, rotation) = self.amplitudes();
        // The pinion turns about a fixed direction, which is the same in shell and ground axes.
        let axis = self.direction_ground;
        let (rate, angular) = (axis * (rotation * speed), axis * (rotation * acceleration));
        let arm = DQuat::from_axis_angle(axis, rotation * place) * self.centre_offset_shell_m;
        // The centre swings about the axis: tangential and centripetal acceleration.
        let swing = angular.cross(arm) + rate.cross(rate.cross(arm));
        (axis * (travel * acceleration) + swing, angular)
    }
}

/// Gravity in the sensor's axes at rest for a wedge that sets `direction`, m/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mounting {
    /// The pinion's axis is vertical: gravity stays constant in the shell. The only mounting for which the paper's
    /// equations, which have no gravity after the drift is taken off, hold in all three modes.
    #[default]
    AxisVertical,
    /// The pinion's axis is level: gravity turns in the shell and is sensed.
    AxisLevel,
}

impl Mounting {
    /// g for a wedge with the given direction, m/s^2.
    pub fn gravity_ground_m_s2(self, direction: DVec3) -> DVec3 {
        let direction = direction.normalize();
        let down = match self {
            Self::AxisVertical => -direction,
            // Square to the axis, as near to the sensor's own -z as that allows.
            Self::AxisLevel => {
                let level = DVec3::NEG_Z - direction * DVec3::NEG_Z.dot(direction);
                if level.length() > 1e-6 {
                    level.normalize()
                } else {
                    DVec3::NEG_X
                }
            }
        };
        down * crate::paper::GRAVITY_M_S2
    }
}
