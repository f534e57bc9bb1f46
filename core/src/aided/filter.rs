//! The covariance of the errors, and what a measurement takes off them.

use core::ops::Range;

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SMatrix};

use super::aid::Measurement;
use super::bending::{self, BENT_BY, Bending};
use super::block::Block;
use super::correction::{Correction, Update};
use super::deviations::{Deviations, TURN_RAD, accelerations, across};
use super::model::{
    ATTITUDE, DYNAMIC, Dynamics, ERRORS, ErrorModel, PARAMETRIC, RATE, Transition, VELOCITY, times,
};
use crate::columns::matrix;
use crate::decouple::uncertainty::zero_wander::{Stretch, ZeroWander};
use crate::decouple::uncertainty::{ChannelNoise, Covariance};
use crate::error::{Result, require_not_negative};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::{Parameters, Sensor, Settings};
use crate::parameter::{DRIFT, SCALE};
use crate::six_axis::SixAxis;

/// Those that a measurement corrects: the dynamic ones, zero drifts and scale factors.
pub(super) const CORRECTED: usize = DYNAMIC + SCALE.end;
/// Place of the first zero's error; those of all follow upon the dynamic ones.
pub(super) const ZEROS: usize = DYNAMIC + DRIFT.start;
/// Innovations squared over their covariance that one of a thousand measurements of three numbers has.
pub(super) const ONE_OF_A_THOUSAND: f64 = 16.27;
/// Deviation of the attitude beyond which nothing of first order is to be believed, rad.
pub(super) const FIRST_ORDER_RAD: f64 = 1.0;
/// Times that a correction is held against what it bends, which converges by the error in rad.
const BENDINGS: usize = 3;
/// Covariance of the errors.
pub type ErrorCovariance = SMatrix<f64, ERRORS, ERRORS>;

/// The covariance of errors that have dynamics by others.
pub(super) fn change(covariance: &mut ErrorCovariance, by: &Dynamics) {
    let rows = times(by, &covariance.fixed_rows::<DYNAMIC>(0).into());
    covariance.fixed_rows_mut::<DYNAMIC>(0).copy_from(&rows);
    let columns = times(
        &covariance.fixed_columns::<DYNAMIC>(0).into(),
        &by.transpose(),
    );
    covariance
        .fixed_columns_mut::<DYNAMIC>(0)
        .copy_from(&columns);
}

/// What zeros that have wandered over a block add to the covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wandered {
    /// V^2.
    pub(super) variance_v2: [f64; LIMBS],
    /// Of the dynamic errors with theirs.
    pub(super) shared: SMatrix<f64, DYNAMIC, LIMBS>,
}

impl Wandered {
    fn add_to(&self, covariance: &mut ErrorCovariance) {
        let mut crossed = covariance.fixed_view_mut::<DYNAMIC, LIMBS>(0, ZEROS);
        crossed += self.shared;
        let mut crossed = covariance.fixed_view_mut::<LIMBS, DYNAMIC>(ZEROS, 0);
        crossed += self.shared.transpose();
        for (limb, variance) in self.variance_v2.iter().enumerate() {
            covariance[(ZEROS + limb, ZEROS + limb)] += variance;
        }
    }
}

/// The square of an innovation, by the inverse of its covariance.
fn size(measurement: &Measurement, weight: &Matrix3<f64>) -> f64 {
    let innovation = measurement.decoded_less_measured;
    (innovation.transpose() * weight * innovation)[(0, 0)]
}

/// An error-state Kalman filter without the errors themselves: they are taken off the decoupler as soon as they are known.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorFilter {
    model: ErrorModel,
    pub(super) covariance: ErrorCovariance,
    pub(super) bending: Bending,
    /// Whether the attitude has been beyond first order since something told it: what the covariance says of it is not to be believed.
    lost: bool,
    /// How the zeros wander, and since when, s.
    wander: Option<(ZeroWander, f64)>,
}

impl ErrorFilter {
    /// Beside a decoupler of the same sensor, parameters and settings.
    ///
    /// `covariance` is that of the parameters, in the order of [`crate::parameter`]. At the first sample the heading is known by
    /// definition, and down within `down_deviation_rad` in each of two directions.
    ///
    /// # Errors
    /// Those of [`ErrorModel::new`]; [`crate::Error::OutOfRange`] for variances or deviations that are negative or not finite.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        covariance: &Covariance,
        noise: &ChannelNoise,
        down_deviation_rad: f64,
    ) -> Result<Self> {
        let diagonal = (0..PARAMETRIC).map(|i| covariance[(i, i)]);
        for value in diagonal.chain(noise.white_v).chain([down_deviation_rad]) {
            require_not_negative("variance of a parameter or a channel", value)?;
        }
        let model = ErrorModel::new(sensor, parameters, settings, noise)?;
        let mut all = ErrorCovariance::zeros();
        all.fixed_view_mut::<PARAMETRIC, PARAMETRIC>(DYNAMIC, DYNAMIC)
            .copy_from(&covariance.fixed_view::<PARAMETRIC, PARAMETRIC>(0, 0));
        let mut filter = Self {
            model,
            covariance: all,
            bending: Bending::none(),
            lost: false,
            wander: None,
        };
        filter.open_down(settings, down_deviation_rad);
        Ok(filter)
    }

    /// A start whose down is not quite where it is said to be. The channels are tared there: what they show later is wrong by the same
    /// error of gravity, as if zero drifts were, so that nothing shows as long as the sensor does not turn.
    fn open_down(&mut self, settings: &Settings, deviation_rad: f64) {
        let g = settings.gravity_ground_m_s2;
        let down = g.normalize_or_zero();
        let across = SMatrix::<f64, 3, 3>::from_fn(|i, j| {
            let one = if i == j { 1.0 } else { 0.0 };
            one - down[i] * down[j]
        });
        if down == DVec3::ZERO || deviation_rad == 0.0 {
            return;
        }
        let psi = across * (deviation_rad * deviation_rad);
        // f = -R^T g: decoded less true is R^T (psi x g), to first order, in shell axes.
        let turned = SMatrix::<f64, 3, 3>::from_fn(|i, j| DVec3::AXES[j].cross(g)[i]);
        let to_shell = matrix(glam::DMat3::from_quat(settings.initial_attitude.inverse()));
        let by_psi = self.model.drift_of_force() * to_shell * turned;
        let mut causes = SMatrix::<f64, ERRORS, 3>::zeros();
        causes
            .fixed_view_mut::<3, 3>(ATTITUDE, 0)
            .fill_with_identity();
        causes
            .fixed_view_mut::<LIMBS, 3>(DYNAMIC, 0)
            .copy_from(&by_psi);
        self.covariance += causes * psi * causes.transpose();
    }

    /// From here on without the channels of some limbs, as a decoupler is that excludes them: errors beyond then are as those of the others
    /// make them.
    ///
    /// # Errors
    /// Those of [`ErrorModel::set_excluded`].
    pub fn set_excluded(&mut self, limbs: LimbSet) -> Result<()> {
        self.model.set_excluded(limbs)
    }

    /// From here on zeros wander, as those of a recording of which this is the first sample.
    pub fn set_zero_wander(&mut self, wander: ZeroWander) {
        self.wander = Some((wander, 0.0));
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &ErrorModel {
        &self.model
    }

    /// Carries the covariance over a block.
    pub fn advance(&mut self, block: &Block) {
        let transition = self.transition(block);
        self.advance_by(block, &transition);
    }

    /// The same where the block's transition is wanted besides.
    pub(super) fn advance_by(
        &mut self,
        block: &Block,
        transition: &Transition,
    ) -> Option<Wandered> {
        let Transition { by_errors, noise } = transition;
        let [force, _] = self.model.turned(block);
        let to_ground = DMat3::from_quat(block.attitude);
        let half_s = 0.5 * block.duration_s;
        self.bending.grow(to_ground, force, half_s);
        let p = &mut self.covariance;
        let carried = times(by_errors, p);
        let own = times(&carried, &by_errors.transpose()) + noise;
        let crossed = carried.fixed_columns::<PARAMETRIC>(DYNAMIC);
        p.fixed_view_mut::<DYNAMIC, PARAMETRIC>(0, DYNAMIC)
            .copy_from(&crossed);
        p.fixed_view_mut::<PARAMETRIC, DYNAMIC>(DYNAMIC, 0)
            .tr_copy_from(&crossed);
        p.fixed_view_mut::<DYNAMIC, DYNAMIC>(0, 0)
            .copy_from(&((own + own.transpose()) * 0.5));
        let with_before = carried.fixed_view::<BENT_BY, BENT_BY>(0, 0).into_owned();
        self.bending.carry(&with_before, &bending::covariance(p));
        self.bending.grow(to_ground, force, half_s);
        let sound = |variance: &f64| variance.is_finite() && *variance >= 0.0;
        if !self.covariance.diagonal().iter().all(sound) {
            self.forget();
            self.lost = true;
        }
        let attitude = self.covariance.fixed_view::<3, 3>(ATTITUDE, ATTITUDE);
        let unknown_rad = sqrt(attitude.trace().max(0.0));
        self.lost |= unknown_rad > FIRST_ORDER_RAD;
        if unknown_rad > TURN_RAD {
            self.bound_unknown_turns();
        }
        let stretch = self.stretch(block)?;
        let noise = self.model.noise_v2_s;
        let wandered = Wandered {
            variance_v2: core::array::from_fn(|limb| stretch.walk_per_s[limb] * noise[limb]),
            shared: self.model.shared(block, &stretch.shared),
        };
        wandered.add_to(&mut self.covariance);
        if let Some((_, since_s)) = &mut self.wander {
            *since_s += block.duration_s;
        }
        Some(wandered)
    }

    /// What a block does to the errors.
    pub(super) fn transition(&self, block: &Block) -> Transition {
        match self.stretch(block) {
            Some(stretch) if stretch.bridge_s.iter().any(|more_s| *more_s > 0.0) => {
                self.model.transition_with(block, &stretch.bridge_s)
            }
            _ => self.model.transition(block),
        }
    }

    /// How the zeros wander over the next block.
    fn stretch(&self, block: &Block) -> Option<Stretch> {
        let (wander, from_s) = self.wander.as_ref()?;
        Some(wander.stretch(*from_s, from_s + block.duration_s))
    }

    /// The square of a measurement's innovation over its covariance: chi square with three degrees of freedom where all is as stated. None
    /// where nothing that the covariance says of the attitude is to be believed, or the innovation has no covariance.
    #[must_use]
    pub fn departure(&self, measurement: &Measurement) -> Option<f64> {
        let (_, scatter) = self.scatter(measurement);
        let weight = scatter.try_inverse().filter(|_| !self.lost)?;
        Some(size(measurement, &weight))
    }

    /// Covariance of a measurement, with what errors have bent, and that of its innovation.
    fn scatter(&self, measurement: &Measurement) -> (Matrix3<f64>, Matrix3<f64>) {
        let p = &self.covariance;
        let mut measured = measurement.covariance;
        if measurement.place == VELOCITY {
            let bent = self.bending.variance_m2_s2(&bending::covariance(p));
            measured += Matrix3::identity() * bent;
        }
        let place = measurement.place;
        let known = p.fixed_view::<3, 3>(place, place).into_owned();
        (measured, known + measured)
    }

    /// Takes a measurement, or none: one whose innovation happens once in a thousand times or less contradicts what was known. Unless it
    /// insists it is not used; if it does, it counts as if it were so much less certain that it would just not contradict.
    pub fn take(&mut self, measurement: &Measurement) -> Option<Correction> {
        self.update(measurement).map(|update| update.correction())
    }

    pub(super) fn update(&mut self, measurement: &Measurement) -> Option<Update> {
        if self.lost && measurement.place == ATTITUDE {
            self.forget_attitude();
            self.lost = false;
        }
        let p = &self.covariance;
        let shows = p.fixed_rows::<3>(measurement.place).into_owned();
        let (mut measured, scatter) = self.scatter(measurement);
        let mut weight = scatter.try_inverse()?;
        let innovation = measurement.decoded_less_measured;
        let size = size(measurement, &weight);
        let contradicts = size > ONE_OF_A_THOUSAND;
        if !size.is_finite() || (contradicts && !measurement.insists) {
            return None;
        }
        if contradicts {
            let stretch = size / ONE_OF_A_THOUSAND;
            weight /= stretch;
            measured += scatter * (stretch - 1.0);
        }
        let mut gain = times(&shows.transpose(), &weight);
        gain.fixed_rows_mut::<{ ERRORS - CORRECTED }>(CORRECTED)
            .fill(0.0);
        // A velocity that is taken for zero, and is not, goes with the motion, as errors of scale factors do, which would be corrected until
        // there is no motion; at a rest, what attitudes have bent in second order goes with gravity.
        if measurement.place == VELOCITY {
            gain.fixed_rows_mut::<LIMBS>(DYNAMIC + SCALE.start)
                .fill(0.0);
        }
        if let Some(down) = measurement.blind_about {
            let along = SMatrix::<f64, 3, 1>::new(down.x, down.y, down.z);
            let mut attitude = gain.fixed_rows_mut::<3>(ATTITUDE);
            let off = along * (along.transpose() * &attitude);
            attitude -= off;
        }
        let mut found = times(&gain, &innovation);
        for _ in 0..BENDINGS {
            let bent = self.bending.of(&bending::errors(&found));
            let shown = bent.fixed_rows::<3>(measurement.place);
            found = times(&gain, &(innovation - shown));
        }
        // (1 - K H) P (1 - K H)^T + K R K^T, which is right for any gain, one side after the other: little is left of what the first
        // takes off, and the second takes its part of what is left.
        let kept = p - times(&gain, &shows);
        let seen = kept.fixed_columns::<3>(measurement.place).into_owned();
        let lost = times(&(times(&gain, &measured) - seen), &gain.transpose());
        let next = kept + lost;
        self.covariance = (next + next.transpose()) * 0.5;
        let bent = self.bending.of(&bending::errors(&found));
        let about = self.bending.about(&bending::errors(&found));
        change(&mut self.covariance, &about);
        self.bending.measured(measurement.place);
        Some(Update {
            place: measurement.place,
            gain,
            noise: measured,
            found,
            bent,
            about,
            contradicts,
        })
    }

    /// Doubles the standard deviations of attitude, rate and velocity: what was measured several times contradicts them.
    pub fn doubt(&mut self) {
        self.scale(0..DYNAMIC, 2.0);
    }

    /// Standard deviations of some errors larger or smaller by a factor, their correlations as they are.
    pub(super) fn scale(&mut self, errors: Range<usize>, factor: f64) {
        for i in errors {
            self.covariance.row_mut(i).scale_mut(factor);
            self.covariance.column_mut(i).scale_mut(factor);
        }
    }

    /// Standard deviations now. Where the attitude's has been beyond first order, nothing is known of it until something tells it.
    #[must_use]
    pub fn deviations(&self) -> Deviations {
        let found = Deviations::of(&self.covariance);
        if self.lost { found.lost() } else { found }
    }

    /// Standard deviation of the direction of gravity in the sensor, rad: of the attitude but for turns about a unit vector down.
    #[must_use]
    pub fn tilt_rad(&self, down_ground: DVec3) -> f64 {
        across(&self.covariance, ATTITUDE, down_ground)
    }

    /// Of the rate but for its part along a unit vector, rad/s.
    #[must_use]
    pub fn rate_across_rad_s(&self, along_shell: DVec3) -> f64 {
        across(&self.covariance, RATE, along_shell)
    }

    /// Standard deviations of a sample's a and w' in ground axes, m/s^2 and rad/s^2, but for its own noise. A mean over samples says too
    /// little of those that are far from it.
    #[must_use]
    pub fn accelerations(&self, voltage_v: &[f64; LIMBS], sample: &SixAxis) -> [f64; 6] {
        let variance = self.deviations().attitude_ground_rad.length_squared();
        accelerations(&self.model, &self.covariance, variance, voltage_v, sample)
    }

    /// Whether the attitude is beyond first order: what the covariance says of it is not to be believed.
    #[cfg(feature = "alloc")]
    pub(super) fn is_lost(&self) -> bool {
        self.lost
    }

    /// The whole covariance, in the order that the [module](super) states.
    #[must_use]
    pub fn covariance(&self) -> &ErrorCovariance {
        &self.covariance
    }
}
