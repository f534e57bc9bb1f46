//! Nine constant channels: a rest, or a motion that goes on as it is.
//!
//! Constant channels show that nothing accelerates and, since gravity stays where it is in the sensor, that nothing turns but about the
//! plumb line. A rest says more: nothing turns about the plumb line either, and nothing moves on. Where it contradicts what is known in
//! just that, and agrees in all that the channels do show, it is none: a turntable, or a lift between two floors.

use glam::DVec3;
use nalgebra::{Matrix3, SMatrix, Vector3};

use super::aid::Measurement;
use super::block::Block;
use super::deviations::second_order;
use super::filter::{ErrorFilter, ONE_OF_A_THOUSAND};
use super::model::{ERRORS, VELOCITY, times};
use super::unknown::UNKNOWN_RATE_RAD_S;
use crate::columns::{column, matrix};
use crate::six_axis::SixAxis;

/// Innovations of a rest squared over their covariance, beyond which it may be none: seven deviations. After quick moves about the plumb line
/// what is neglected makes real rests contradict by up to six.
const BEYOND_A_REST: f64 = 49.0;

/// A motion that nine constant channels cannot tell from a rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Steady {
    /// Turns about the plumb line: what is measured is the rate across it, where that line is known well enough.
    Turn(Option<Measurement>),
    /// Moves on: velocities are counted from here.
    Cruise,
}

impl ErrorFilter {
    /// What the measurement of a rest is of, if it is none; `turned`, where nothing has changed since the measurement before, is whether that
    /// was of a turn: so is this one then, although the rate, as noise lets it walk, is hardly known any more, and no turn begins there.
    /// Nothing is told where the attitude is lost, or without gravity.
    pub(super) fn steady(
        &self,
        of_rest: &Measurement,
        block: &Block,
        sample: &SixAxis,
        gravity_ground_m_s2: DVec3,
        turned: Option<bool>,
    ) -> Option<Steady> {
        let agrees = |found: &Measurement| Some(self.departure(found)? < ONE_OF_A_THOUSAND);
        let down_ground = gravity_ground_m_s2.try_normalize()?;
        let is_beyond = self.departure(of_rest)? > BEYOND_A_REST;
        if of_rest.place == VELOCITY {
            let cruises = is_beyond && self.is_unaccelerated(block, gravity_ground_m_s2);
            return cruises.then_some(Steady::Cruise);
        }
        if !turned.unwrap_or(is_beyond) {
            return None;
        }
        let down = column(sample.attitude.inverse() * down_ground);
        // What of a turn about the plumb line seems to be across it where that is not quite known: the same from one look to the next.
        let tilted = sample.rate_shell_rad_s.length() * self.tilt_rad(down_ground);
        let across = Measurement {
            covariance: of_rest.covariance
                + Matrix3::identity() * (tilted * tilted)
                + down * down.transpose() * (UNKNOWN_RATE_RAD_S * UNKNOWN_RATE_RAD_S),
            ..*of_rest
        };
        let is_seen = tilted * tilted < of_rest.covariance[(0, 0)];
        agrees(&across)?.then_some(Steady::Turn(is_seen.then_some(across)))
    }

    /// Whether a block's mean acceleration is zero as far as is known.
    fn is_unaccelerated(&self, block: &Block, gravity_ground_m_s2: DVec3) -> bool {
        let model = self.model();
        let [force, _] = model.turned(block);
        let shown: SMatrix<f64, 3, ERRORS> = model.shown(block).fixed_rows::<3>(0).into();
        let known = times(&times(&shown, self.covariance()), &shown.transpose());
        let turned = matrix(glam::DMat3::from_quat(block.attitude));
        let density = model.density.fixed_view::<3, 3>(3, 3).into_owned();
        let noise = turned * density * turned.transpose() / block.duration_s;
        let bent = second_order(
            force,
            self.deviations().attitude_ground_rad.length_squared(),
        );
        let acceleration: Vector3<f64> = column(force + gravity_ground_m_s2);
        let scatter = known + noise + Matrix3::identity() * (bent * bent);
        scatter.try_inverse().is_some_and(|weight| {
            (acceleration.transpose() * weight * acceleration)[(0, 0)] < ONE_OF_A_THOUSAND
        })
    }
}
