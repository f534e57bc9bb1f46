//! What a whole recording says of the errors at each of its times: a fixed-interval smoother.
//!
//! The filter goes forward, and what a later measurement tells of earlier errors is carried back to them. With e the error after block k,
//! e+ = Phi e + w that after the next one, P the filter's covariance and P+ its prediction, the estimate goes back by Rauch, Tung
//! and Striebel's gain
//!
//! ```text
//! C = P Phi^T (P+)^-1 = Phi^-1 (1 - Q (P+)^-1).
//! ```
//!
//! Their covariance would be right for optimal gains only, and the filter's are not: it leaves errors alone that it considers, and makes measurements that
//! contradict count less. So the estimate is followed as what it is, a share D of the error and a part n of covariance N that has
//! nothing to do with it. A transition and an update by gain K, rows H and covariance R, taken back, make of them
//!
//! ```text
//! D' = C D Phi              N' = C (N + D Q D^T) C^T
//! D' = D + (1 - D) K H      N' = N + (1 - D) K R K^T (1 - D)^T,
//! ```
//!
//! and what is left, (1 - D) e - n, has the covariance (1 - D) P (1 - D)^T + N, whatever the gains.
//!
//! Phi turns rates by the filter's attitude. Where that is less certain than first order bears, nothing goes back: of the time before
//! that, nothing is said.

use alloc::vec::Vec;

use glam::{DQuat, DVec3};
use nalgebra::{Cholesky, Matrix3, SMatrix, SVector};

use super::filter::{CORRECTED, ErrorCovariance, ErrorFilter, Update};
use super::history::{Event, History, Passed, SEGMENT};
use super::model::{
    ATTITUDE, DYNAMIC, ERRORS, PARAMETRIC, RATE, Transition, VELOCITY, times, vector,
};
use crate::float::sqrt;

/// Added to the correlation of each error with itself: some are known by others, drifts by down at the first sample.
const JITTER: f64 = 1e-12;
/// Deviation of the filter's attitude up to which errors are taken back, rad.
const FIRST_ORDER_RAD: f64 = 0.2;
/// Attitude and rate, the errors before that of the velocity.
const WANTED: usize = VELOCITY;

/// What is known of the end of a block when all is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed {
    /// The block's last sample.
    pub sample: u64,
    /// R.
    pub attitude: DQuat,
    /// w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Covariance of the attitude's error, ground axes, rad^2; nothing where it is, or later is, beyond first order.
    pub attitude_covariance: Option<Matrix3<f64>>,
    /// Of the rate's, shell axes, rad^2/s^2.
    pub rate_covariance: Matrix3<f64>,
}

impl Smoothed {
    /// Standard deviation of the attitude about all axes together, rad.
    #[must_use]
    pub fn attitude_rad(&self) -> f64 {
        self.attitude_covariance
            .map_or(f64::INFINITY, |covariance| {
                sqrt(covariance.trace().max(0.0))
            })
    }
}

/// One block of a segment, carried over once more.
struct Step {
    transition: Transition,
    predicted: ErrorCovariance,
    updates: Vec<Update>,
    filtered: ErrorCovariance,
    lost: bool,
}

/// An estimate of the errors by what came later.
struct Backwards {
    found: SVector<f64, ERRORS>,
    share: SMatrix<f64, ERRORS, ERRORS>,
    noise: ErrorCovariance,
    /// Whether the attitude has been beyond first order at a later time.
    cut: bool,
}

/// Goes back over a recording: the ends of its blocks, from the last one to the first.
pub(super) fn smooth(history: &History) -> Vec<Smoothed> {
    let mut states = Vec::with_capacity(history.blocks.len());
    let mut back = Backwards::nothing();
    let mut events = &history.events[..];
    let segments = history.blocks.chunks(SEGMENT).zip(&history.filters);
    for (number, (blocks, before)) in segments.enumerate().rev() {
        let first = number * SEGMENT;
        let (earlier, own) = events.split_at(events.partition_point(|(block, _)| *block < first));
        events = earlier;
        let steps = carried(first, blocks, own, before.clone());
        for (passed, step) in blocks.iter().zip(&steps).rev() {
            if step.lost {
                back = Backwards::cut();
            }
            states.push(back.state(passed, &step.filtered));
            for update in step.updates.iter().rev() {
                back.take_back(update);
            }
            if attitude_variance(&step.predicted) > FIRST_ORDER_RAD * FIRST_ORDER_RAD {
                back = Backwards::cut();
            }
            back.carry(step);
        }
    }
    states
}

/// A segment's blocks from its first filter on: the same bits as the first time.
fn carried(
    first: usize,
    blocks: &[Passed],
    events: &[(usize, Event)],
    mut filter: ErrorFilter,
) -> Vec<Step> {
    let mut events = events.iter().peekable();
    let mut steps = Vec::with_capacity(blocks.len());
    for (number, passed) in blocks.iter().enumerate() {
        let transition = filter.model().transition(&passed.block);
        filter.advance_by(&passed.block, &transition);
        let predicted = *filter.covariance();
        let mut updates = Vec::new();
        while let Some((_, event)) = events.next_if(|(block, _)| *block == first + number) {
            match event {
                Event::Measured(measurement) => updates.extend(filter.update(measurement)),
                Event::Doubted => filter.doubt(),
            }
        }
        steps.push(Step {
            transition,
            predicted,
            updates,
            filtered: *filter.covariance(),
            lost: filter.is_lost(),
        });
    }
    steps
}

impl Backwards {
    fn nothing() -> Self {
        Self {
            found: SVector::zeros(),
            share: SMatrix::zeros(),
            noise: ErrorCovariance::zeros(),
            cut: false,
        }
    }

    fn cut() -> Self {
        Self {
            cut: true,
            ..Self::nothing()
        }
    }

    fn attitude(&self) -> DVec3 {
        vector(self.found.fixed_rows::<3>(ATTITUDE).into_owned())
    }

    fn take_back(&mut self, update: &Update) {
        let left = update.gain - times(&self.share, &update.gain);
        let mut shown = self.share.fixed_columns_mut::<3>(update.place);
        shown += left;
        self.noise += times(&times(&left, &update.noise), &left.transpose());
        self.found += update.found;
    }

    fn carry(&mut self, step: &Step) {
        let Transition { by_errors, noise } = &step.transition;
        let gain = gain(step);
        let back = times(&gain, &self.found);
        self.found.fixed_rows_mut::<DYNAMIC>(0).copy_from(&back);
        // Shares of errors that have dynamics, and what noise these have had meanwhile.
        let driven = self.share.fixed_columns::<DYNAMIC>(0).into_owned();
        let all = self.noise + times(&times(&driven, noise), &driven.transpose());
        let crossed = times(&gain, &all);
        let own = times(&crossed, &gain.transpose());
        self.noise = all;
        self.noise.fixed_rows_mut::<DYNAMIC>(0).copy_from(&crossed);
        let columns = crossed.transpose();
        self.noise
            .fixed_columns_mut::<DYNAMIC>(0)
            .copy_from(&columns);
        self.noise
            .fixed_view_mut::<DYNAMIC, DYNAMIC>(0, 0)
            .copy_from(&((own + own.transpose()) * 0.5));
        let rows = times(&gain, &self.share);
        self.share.fixed_rows_mut::<DYNAMIC>(0).copy_from(&rows);
        let driven = self.share.fixed_columns::<DYNAMIC>(0).into_owned();
        let mut shares = times(&driven, by_errors);
        let kept = self.share.fixed_columns::<PARAMETRIC>(DYNAMIC);
        let mut parametric = shares.fixed_columns_mut::<PARAMETRIC>(DYNAMIC);
        parametric += kept;
        self.share = shares;
    }

    fn state(&self, passed: &Passed, filtered: &ErrorCovariance) -> Smoothed {
        let corrected = &passed.corrected;
        let mut left = SMatrix::<f64, WANTED, ERRORS>::identity();
        left -= self.share.fixed_rows::<WANTED>(0);
        let covariance = times(&times(&left, filtered), &left.transpose())
            + self.noise.fixed_view::<WANTED, WANTED>(0, 0);
        let three = |at: usize| covariance.fixed_view::<3, 3>(at, at).into_owned();
        let rate = vector(self.found.fixed_rows::<3>(RATE).into_owned());
        let off = DQuat::from_scaled_axis(-self.attitude());
        Smoothed {
            sample: corrected.sample,
            attitude: (off * corrected.attitude).normalize(),
            rate_shell_rad_s: corrected.rate_shell_rad_s - rate,
            attitude_covariance: (!self.cut).then(|| three(ATTITUDE)),
            rate_covariance: three(RATE),
        }
    }
}

fn attitude_variance(covariance: &ErrorCovariance) -> f64 {
    covariance.fixed_view::<3, 3>(ATTITUDE, ATTITUDE).trace()
}

/// Rows of C of the errors that have dynamics; the others go back as they are.
fn gain(step: &Step) -> SMatrix<f64, DYNAMIC, ERRORS> {
    let Transition { by_errors, noise } = &step.transition;
    let by_dynamic = by_errors.fixed_columns::<DYNAMIC>(0).into_owned();
    let (Some(inverse), Some(weight)) = (by_dynamic.try_inverse(), weight(&step.predicted)) else {
        return SMatrix::zeros();
    };
    let mut left = times(noise, &weight) * -1.0;
    let mut own = left.fixed_columns_mut::<DYNAMIC>(0);
    own += SMatrix::<f64, DYNAMIC, DYNAMIC>::identity();
    let mut parametric = left.fixed_columns_mut::<PARAMETRIC>(DYNAMIC);
    parametric -= by_errors.fixed_columns::<PARAMETRIC>(DYNAMIC);
    times(&inverse, &left)
}

/// Rows of the inverse of a covariance of the errors that are corrected: those that have dynamics.
fn weight(covariance: &ErrorCovariance) -> Option<SMatrix<f64, DYNAMIC, ERRORS>> {
    let over_deviation = SVector::<f64, CORRECTED>::from_fn(|i, _| {
        let variance = covariance[(i, i)];
        if variance > 0.0 {
            1.0 / sqrt(variance)
        } else {
            0.0
        }
    });
    let correlation = SMatrix::<f64, CORRECTED, CORRECTED>::from_fn(|i, j| {
        if i == j {
            1.0 + JITTER
        } else {
            covariance[(i, j)] * over_deviation[i] * over_deviation[j]
        }
    });
    let mut solved =
        SMatrix::<f64, CORRECTED, DYNAMIC>::from_fn(
            |i, j| {
                if i == j { over_deviation[i] } else { 0.0 }
            },
        );
    Cholesky::new(correlation)?.solve_mut(&mut solved);
    let mut weight = SMatrix::<f64, DYNAMIC, ERRORS>::zeros();
    weight.fixed_columns_mut::<CORRECTED>(0).copy_from(
        &SMatrix::<f64, DYNAMIC, CORRECTED>::from_fn(|i, j| solved[(j, i)] * over_deviation[j]),
    );
    Some(weight)
}
