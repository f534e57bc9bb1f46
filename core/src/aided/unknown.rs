//! What is known no longer: errors of which nothing is known, or nothing by what was before.

use nalgebra::SMatrix;

use super::bending::Bending;
use super::deviations::TURN_RAD;
use super::filter::{ErrorCovariance, ErrorFilter};
use super::model::{ATTITUDE, DYNAMIC, RATE, VELOCITY, times};
use crate::float::sqrt;

/// Deviation of a rate of which nothing is known, rad/s, and of a velocity, m/s.
pub(super) const UNKNOWN_RATE_RAD_S: f64 = 10.0;
const UNKNOWN_VELOCITY_M_S: f64 = 1e3;

/// Deviation of a dynamic error of which nothing is known.
fn unknown(place: usize) -> f64 {
    match place {
        ATTITUDE..RATE => TURN_RAD,
        RATE..VELOCITY => UNKNOWN_RATE_RAD_S,
        _ => UNKNOWN_VELOCITY_M_S,
    }
}

impl ErrorFilter {
    /// Beyond a turn nothing more is unknown, and sums of first order would grow without end: directions of which less is known, as the
    /// heading without a fix, are taken to be known so far, and the others as they are.
    pub(super) fn bound_unknown_turns(&mut self) {
        let attitude = self.covariance.fixed_view::<3, 3>(ATTITUDE, ATTITUDE);
        let found = attitude.into_owned().symmetric_eigen();
        let mut bound = SMatrix::<f64, 3, 3>::identity();
        for (direction, variance) in found.eigenvectors.column_iter().zip(&found.eigenvalues) {
            let deviation = sqrt(variance.max(0.0));
            if deviation > TURN_RAD {
                bound -= direction * direction.transpose() * (1.0 - TURN_RAD / deviation);
            }
        }
        let rows = times(&bound, &self.covariance.fixed_rows::<3>(ATTITUDE).into());
        self.covariance
            .fixed_rows_mut::<3>(ATTITUDE)
            .copy_from(&rows);
        let columns = times(&self.covariance.fixed_columns::<3>(ATTITUDE).into(), &bound);
        self.covariance
            .fixed_columns_mut::<3>(ATTITUDE)
            .copy_from(&columns);
    }

    /// Velocities are counted from here, where the sensor neither accelerates nor, as is known, stands still: they have nothing to do with
    /// what was before.
    pub(super) fn tare_velocity(&mut self, deviation_m_s: f64) {
        for place in VELOCITY..DYNAMIC {
            self.forget_correlations(place, deviation_m_s);
        }
        self.bending.measured(VELOCITY);
    }

    fn forget_correlations(&mut self, place: usize, deviation: f64) {
        self.covariance.row_mut(place).fill(0.0);
        self.covariance.column_mut(place).fill(0.0);
        self.covariance[(place, place)] = deviation * deviation;
    }

    /// A motion that nothing held for long leaves an attitude, and a velocity, of which nothing is known. Rate and parameters are as before: the
    /// rate's equation has no attitude in it. Taken for unknown as well it would turn the sensor by a radian from one attitude to the next,
    /// which then tells nothing of it.
    pub(super) fn forget_attitude(&mut self) {
        self.bending = Bending::none();
        for place in (ATTITUDE..RATE).chain(VELOCITY..DYNAMIC) {
            self.forget_correlations(place, unknown(place));
        }
        for place in RATE..VELOCITY {
            let deviation = sqrt(self.covariance[(place, place)]);
            if deviation > UNKNOWN_RATE_RAD_S {
                self.scale(place..place + 1, UNKNOWN_RATE_RAD_S / deviation);
            }
        }
    }

    /// A covariance that none can be means nothing: attitude, rate and velocity are unknown, and parameters as uncertain as before, each by
    /// itself.
    pub(super) fn forget(&mut self) {
        self.bending = Bending::none();
        let variances = self.covariance.diagonal();
        let sound = |variance: f64| variance.is_finite() && variance >= 0.0;
        self.covariance = ErrorCovariance::from_diagonal(&SMatrix::from_fn(|place, _| {
            if place < DYNAMIC {
                unknown(place) * unknown(place)
            } else if sound(variances[place]) {
                variances[place]
            } else {
                0.0
            }
        }));
    }
}
