//! Which columns of the answer are written, in which axes.

use glam::DVec3;
use sixaxis_core::SixAxis;
use sixaxis_core::six_axis::SixAxisColumns;
use sixaxis_recordings::motion::{MOTION_CHANNELS, SENSOR_CHANNELS};
use sixaxis_recordings::{Channel, Layout};

/// Axes in which accelerations are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// Those of the ground: linear and angular acceleration, as far as the attitude is known.
    Ground,
    /// Those of the sensor: specific force and angular acceleration, which need no attitude.
    Sensor,
    /// Both.
    #[default]
    Both,
}

/// Which columns are wanted beside the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Columns {
    /// Axes of the accelerations.
    pub frame: Frame,
    /// Without rates and attitude.
    pub accelerations_only: bool,
}

/// Numbers of a motion: see [`MOTION_CHANNELS`].
const MOTION: usize = MOTION_CHANNELS.len();
/// Accelerations in either axes.
const ACCELERATIONS: usize = SENSOR_CHANNELS.len();
/// Places of the rates, which are in shell axes.
const RATES: core::ops::Range<usize> = 6..9;

impl Columns {
    /// Accelerations in ground axes, rates and attitude: a motion, as `compare` reads it.
    pub const MOTION: Self = Self {
        frame: Frame::Ground,
        accelerations_only: false,
    };
    /// The six accelerations in ground axes.
    pub const ACCELERATIONS: Self = Self {
        frame: Frame::Ground,
        accelerations_only: true,
    };

    /// Places in a motion that are written.
    const fn motion(self) -> core::ops::Range<usize> {
        let first = match self.frame {
            Frame::Sensor => ACCELERATIONS,
            Frame::Ground | Frame::Both => 0,
        };
        let end = match self.accelerations_only {
            true => ACCELERATIONS,
            false => MOTION,
        };
        first..end
    }

    /// Whether accelerations in sensor axes are written.
    pub const fn in_sensor_axes(self) -> bool {
        !matches!(self.frame, Frame::Ground)
    }

    /// Whether accelerations in ground axes are written, which come first then.
    pub const fn in_ground_axes(self) -> bool {
        !matches!(self.frame, Frame::Sensor)
    }

    /// What of them needs an attitude that is known, in words, and where else to look; none where nothing does.
    pub(super) const fn needing_attitude(self) -> Option<&'static str> {
        match (self.frame, self.accelerations_only) {
            (Frame::Ground, false) => Some(
                "columns in ground axes and the quaternion are NaN; specific force in sensor axes (--frame sensor or both) needs no attitude",
            ),
            (Frame::Ground, true) => Some(
                "columns in ground axes are NaN; specific force in sensor axes (--frame sensor or both) needs no attitude",
            ),
            (Frame::Both, false) => Some(
                "columns in ground axes and the quaternion are NaN; those in sensor axes need no attitude",
            ),
            (Frame::Both, true) => {
                Some("columns in ground axes are NaN; those in sensor axes need no attitude")
            }
            (Frame::Sensor, false) => Some("the quaternion is NaN"),
            (Frame::Sensor, true) => None,
        }
    }

    /// Their number, without the time.
    pub fn count(self) -> usize {
        self.names().count()
    }

    /// What of a motion, then accelerations in sensor axes.
    fn names(self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let sensor = self.in_sensor_axes().then_some(SENSOR_CHANNELS);
        let motion = MOTION_CHANNELS[self.motion()].iter().copied();
        motion.chain(sensor.into_iter().flatten())
    }

    /// The layout of the answer: time, then what is wanted of accelerations in ground axes, rates in shell axes, attitude and
    /// accelerations in sensor axes.
    pub fn layout(self, sample_rate_hz: f64) -> Layout {
        let channels = [("time", "s")]
            .into_iter()
            .chain(self.names())
            .map(|(name, unit)| Channel {
                sample_rate_hz: Some(sample_rate_hz),
                ..Channel::new(name, Some(unit))
            })
            .collect();
        Layout {
            channels,
            time: Some(0),
            ..Layout::default()
        }
    }

    /// Appends an answer under gravity in ground axes, m/s^2, to the columns; NaN in ground axes where its attitude is not known.
    #[inline]
    pub fn push(self, answer: &SixAxis, known: bool, gravity: DVec3, into: &mut [Vec<f64>]) {
        let places = self.motion();
        let (motion, sensor) = into.split_at_mut(places.len());
        let numbers = answer.numbers();
        for (column, place) in motion.iter_mut().zip(places) {
            let given = known || RATES.contains(&place);
            column.push(if given { numbers[place] } else { f64::NAN });
        }
        if self.in_sensor_axes() {
            for (column, number) in sensor.iter_mut().zip(in_sensor_axes(answer, gravity)) {
                column.push(number);
            }
        }
    }

    /// Appends consecutive answers whose attitude nobody follows, in ground axes only: column by column.
    pub fn extend(self, answers: SixAxisColumns, into: &mut [Vec<f64>]) {
        for (column, numbers) in into.iter_mut().zip(&answers.columns()[self.motion()]) {
            column.extend_from_slice(numbers);
        }
    }
}

/// Specific force, m/s^2, and angular acceleration, rad/s^2, in sensor axes: what the attitude turned is turned back by the same.
fn in_sensor_axes(answer: &SixAxis, gravity_ground_m_s2: DVec3) -> [f64; ACCELERATIONS] {
    let back = answer.attitude.inverse();
    let force = back * (answer.linear_ground_m_s2 - gravity_ground_m_s2);
    let angular = back * answer.angular_ground_rad_s2;
    [force.x, force.y, force.z, angular.x, angular.y, angular.z]
}

/// Columns that say how well accelerations in ground axes and attitude are known, with their units: one standard deviation each.
pub const DEVIATIONS: [(&str, &str); 7] = [
    ("sd_ax", "m/s^2"),
    ("sd_ay", "m/s^2"),
    ("sd_az", "m/s^2"),
    ("sd_alpha_x", "rad/s^2"),
    ("sd_alpha_y", "rad/s^2"),
    ("sd_alpha_z", "rad/s^2"),
    ("sd_attitude", "rad"),
];
