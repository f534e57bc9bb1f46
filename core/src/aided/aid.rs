//! What is known of a motion beside the limbs' word.

use glam::{DQuat, DVec3};
use nalgebra::{Matrix3, Vector3};

use super::model::{ATTITUDE, RATE, VELOCITY};
use crate::columns::column;
use crate::six_axis::SixAxis;

/// Something known of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aid {
    /// The sensor neither turns nor moves.
    Rest {
        /// Standard deviation of each component of the rate, rad/s.
        deviation_rad_s: f64,
        /// Of each component of the velocity, m/s.
        deviation_m_s: f64,
        /// Whether nothing has changed since the rest before.
        continues: bool,
    },
    /// The velocity is zero but for what the motion has of it at any time.
    Velocity {
        /// Standard deviation of each component, m/s, independent from one such measurement to the next.
        deviation_m_s: f64,
    },
    /// Something else tells the attitude.
    Attitude {
        /// Shell axes to ground axes.
        attitude: DQuat,
        /// Standard deviation about each axis, rad.
        deviation_rad: f64,
    },
}

/// What became of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// It was used.
    Used,
    /// It contradicts what was known, or cannot be used now. A velocity is not used; a rest or an attitude counts little.
    Refused,
    /// A rest that is a steady turn about the plumb line: at most the rate across it was used.
    Turn,
    /// A rest that is a motion at constant velocity: that nothing turns was used, and velocities are counted from here.
    Cruise,
}

/// Three numbers that the decoupler has, too, and by how much it has them differently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Place of the first of the three errors that it shows.
    pub place: usize,
    /// Decoded less measured.
    pub decoded_less_measured: Vector3<f64>,
    /// The measurement's own covariance.
    pub covariance: Matrix3<f64>,
    /// A direction, ground axes, rotations about which the measurement cannot tell: to first order it seems to, once errors are large.
    pub blind_about: Option<DVec3>,
    /// Whether it counts, little, even if it contradicts what was known.
    pub insists: bool,
}

impl Aid {
    /// Against a decoded sample and the velocity that the decoded accelerations add up to, m/s, ground axes: one measurement, or the
    /// two of a rest, of the rate first.
    #[must_use]
    pub fn against(
        &self,
        sample: &SixAxis,
        velocity_ground_m_s: DVec3,
        down: DVec3,
    ) -> [Option<Measurement>; 2] {
        // A bound on the velocity may fail for a minute; a rest or an attitude is more often right than the filter is.
        let insists = !matches!(self, Self::Velocity { .. });
        let of = |place: usize, difference: DVec3, deviation: f64, blind_about| {
            Some(Measurement {
                insists,
                place,
                decoded_less_measured: column(difference),
                covariance: Matrix3::identity() * (deviation * deviation),
                blind_about,
            })
        };
        let velocity = |deviation| of(VELOCITY, velocity_ground_m_s, deviation, Some(down));
        match *self {
            Self::Rest {
                deviation_rad_s,
                deviation_m_s,
                ..
            } => [
                of(RATE, sample.rate_shell_rad_s, deviation_rad_s, Some(down)),
                velocity(deviation_m_s),
            ],
            Self::Velocity { deviation_m_s } => [velocity(deviation_m_s), None],
            Self::Attitude {
                attitude,
                deviation_rad,
            } => {
                let off = (sample.attitude * attitude.inverse()).normalize();
                // A quaternion and its negative are one attitude: the way round that is shorter.
                let off = if off.w < 0.0 { -off } else { off };
                [
                    of(ATTITUDE, off.to_scaled_axis(), deviation_rad, None),
                    None,
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quaternion_and_its_negative_are_one_attitude() {
        let of = |attitude| {
            let aid = Aid::Attitude {
                attitude,
                deviation_rad: 0.01,
            };
            let sample = SixAxis::still(DQuat::from_scaled_axis(DVec3::new(1.0, -2.0, 0.5)));
            let [measured, _] = aid.against(&sample, DVec3::ZERO, DVec3::NEG_Z);
            measured.map(|of| of.decoded_less_measured)
        };
        let attitude = DQuat::from_scaled_axis(DVec3::new(1.05, -2.0, 0.5));
        let off = of(attitude).expect("a measurement");
        assert_eq!(of(-attitude), Some(off));
        assert!(off.norm() < 0.06, "{off}");
    }
}
