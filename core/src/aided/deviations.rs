//! What a covariance of the errors says of attitude, rate, velocity and of a sample's accelerations.

use glam::DVec3;

use super::block::Block;
use super::filter::ErrorCovariance;
use super::model::{ATTITUDE, ErrorModel, RATE, VELOCITY, times};
use crate::columns::column;
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::six_axis::SixAxis;

/// Deviation of an attitude of which nothing is known, rad.
pub(super) const TURN_RAD: f64 = core::f64::consts::TAU;

/// Standard deviations of the errors that are not parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviations {
    /// Of the attitude, about the ground's axes, rad.
    pub attitude_ground_rad: DVec3,
    /// Of w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Of the velocity, ground axes, m/s.
    pub velocity_ground_m_s: DVec3,
}

impl Deviations {
    pub(super) fn of(covariance: &ErrorCovariance) -> Self {
        let three = |at: usize| {
            let one = |i: usize| sqrt(covariance[(at + i, at + i)].max(0.0));
            DVec3::new(one(0), one(1), one(2))
        };
        Self {
            attitude_ground_rad: three(ATTITUDE),
            rate_shell_rad_s: three(RATE),
            velocity_ground_m_s: three(VELOCITY),
        }
    }

    /// The same, but that nothing is known of the attitude.
    pub(super) fn lost(self) -> Self {
        Self {
            attitude_ground_rad: DVec3::splat(TURN_RAD / sqrt(3.0)),
            ..self
        }
    }

    /// Of the attitude about any axis: root of the sum of the three variances, rad.
    #[must_use]
    pub fn attitude_rad(&self) -> f64 {
        self.attitude_ground_rad.length()
    }
}

/// Standard deviation of three errors, from this place on, but for their part along a unit vector.
pub(super) fn across(covariance: &ErrorCovariance, place: usize, along: DVec3) -> f64 {
    let all = covariance.fixed_view::<3, 3>(place, place);
    let along = column(along);
    sqrt((all.trace() - (along.transpose() * all * along)[(0, 0)]).max(0.0))
}

/// Standard deviations of a sample's a and w' in ground axes, m/s^2 and rad/s^2, but for its own noise, the attitude's
/// variance about all axes together being this, rad^2.
pub(super) fn accelerations(
    model: &ErrorModel,
    covariance: &ErrorCovariance,
    attitude_variance: f64,
    voltage_v: &[f64; LIMBS],
    sample: &SixAxis,
) -> [f64; 6] {
    let block = &Block::of_sample(voltage_v, sample);
    let shown = model.shown(block);
    let variances = times(&shown, covariance).component_mul(&shown).column_sum();
    let [linear, angular] = model
        .turned(block)
        .map(|v| second_order(v, attitude_variance));
    core::array::from_fn(|i| {
        let second = if i < 3 { linear } else { angular };
        sqrt(variances[i].max(0.0) + second * second)
    })
}

/// Half of psi x (psi x v), root of the mean square at most, by the variance of psi: along v, where nothing is of first order, it is all
/// there is. An error about one axis across v alone has most of it, three quarters of v^2 times the square of its variance.
pub(super) fn second_order(v: DVec3, variance: f64) -> f64 {
    sqrt(0.75) * v.length() * variance
}
