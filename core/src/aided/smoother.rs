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
//! and what is left, (1 - D) e - n, has the covariance (1 - D) P (1 - D)^T + N, whatever the gains. Behind an update, errors
//! are T e of those before it, about what was found, which has bent attitude and velocity less ([`super::bending`]): they go back by T^-1 e, D by T^-1 D T and N by T^-1 N T^-T.
//!
//! Phi turns rates by the filter's attitude. Where that is less certain than first order bears, or would be better known without what came
//! later, or where velocities are counted anew, nothing goes back: what was before is known by what came until then.
//!
//! A recording's states are too many for the memory, 9 kB each. What goes back is kept from segment to segment, and a segment's states are
//! made when they are wanted.

use alloc::vec::Vec;

use glam::{DQuat, DVec3};
use nalgebra::{SMatrix, SVector};

use super::channels::Channels;
use super::correction::{Correction, Update};
use super::deviations::{Deviations, across};
use super::filter::{ErrorCovariance, Wandered, change};
use super::gain;
use super::history::{Event, History, Segment};
use super::model::{ATTITUDE, DYNAMIC, Dynamics, ERRORS, PARAMETRIC, Transition, times};
use crate::model::Parameters;
use crate::six_axis::SixAxis;

/// Deviation of the filter's attitude up to which errors are taken back, rad. Half its square is what second order makes of it, and a
/// smoothed attitude is known better than that of the filter.
const FIRST_ORDER_RAD: f64 = 0.05;

/// What is known of the end of a block when all is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The block's last sample; of the beginning, the first one.
    pub sample: u64,
    /// R.
    pub attitude: DQuat,
    /// w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Of the errors, in the order that the [module](super) states.
    pub covariance: ErrorCovariance,
    pub(super) channels: Channels,
    lost: bool,
}

impl Smoothed {
    /// The parameters, with zero drifts and scale factors as they turned out to be.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.channels.parameters()
    }

    /// Standard deviation of the direction of gravity in the sensor, rad: of the attitude but for turns about a unit vector down.
    #[must_use]
    pub fn tilt_rad(&self, down_ground: DVec3) -> f64 {
        across(&self.covariance, ATTITUDE, down_ground)
    }

    /// Standard deviations of attitude, rate and velocity.
    #[must_use]
    pub fn deviations(&self) -> Deviations {
        let found = Deviations::of(&self.covariance);
        if self.lost { found.lost() } else { found }
    }
}

/// One block of a segment, carried over once more.
struct Step {
    transition: Transition,
    predicted: ErrorCovariance,
    wandered: Option<Wandered>,
    updates: Vec<Update>,
    filtered: ErrorCovariance,
    channels: Channels,
    /// Velocities are counted from here: those of later have nothing to do with what was before.
    tared: bool,
    lost: bool,
}

/// An estimate of the errors by what came later.
#[derive(Debug, Clone, PartialEq)]
struct Backwards {
    found: SVector<f64, ERRORS>,
    share: SMatrix<f64, ERRORS, ERRORS>,
    noise: ErrorCovariance,
}

/// A recording's past, and what its end says of each segment's end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smoother {
    history: History,
    /// What later segments say of each one's end.
    later: Vec<Backwards>,
    /// The same of the first sample.
    begin: Backwards,
}

impl Smoother {
    /// Goes back over a recording.
    pub(super) fn new(history: History) -> Self {
        let mut back = Backwards::nothing();
        let mut later = Vec::with_capacity(history.segments());
        for segment in (0..history.segments())
            .rev()
            .filter_map(|number| history.segment(number))
        {
            later.push(back.clone());
            for step in carried(&segment).iter().rev() {
                back.reach(step);
                back.cross(step);
            }
        }
        later.reverse();
        Self {
            history,
            later,
            begin: back,
        }
    }

    /// What is known of the first sample, which was decoded as this one.
    pub(super) fn begin(&self, decoded: &SixAxis) -> Option<Smoothed> {
        let (filter, channels) = self.history.begin()?;
        Some(
            self.begin
                .state(decoded, filter.covariance(), channels, false),
        )
    }

    /// Ends of a segment's blocks, from the first to the last; none beyond the last segment.
    pub(super) fn ends(&self, number: usize) -> Vec<Smoothed> {
        let (Some(segment), Some(later)) = (self.history.segment(number), self.later.get(number))
        else {
            return Vec::new();
        };
        let mut back = later.clone();
        let mut states = Vec::with_capacity(segment.blocks.len());
        for (passed, step) in segment.blocks.iter().zip(&carried(&segment)).rev() {
            back.reach(step);
            states.push(back.state(&passed.corrected, &step.filtered, &step.channels, step.lost));
            back.cross(step);
        }
        states.reverse();
        states
    }
}

/// A segment's blocks from its first filter on: the same bits as the first time.
fn carried(segment: &Segment<'_>) -> Vec<Step> {
    let (mut filter, mut channels) = segment.before.clone();
    let mut events = segment.events.iter().peekable();
    let mut steps = Vec::with_capacity(segment.blocks.len());
    for (number, passed) in segment.blocks.iter().enumerate() {
        let transition = filter.transition(&passed.block);
        let wandered = filter.advance_by(&passed.block, &transition);
        let predicted = *filter.covariance();
        let mut updates = Vec::new();
        let mut tared = false;
        while let Some((_, event)) = events.next_if(|(block, _)| *block == segment.first + number) {
            match event {
                Event::Measured(measurement) => {
                    let update = filter.update(measurement);
                    if let Some(update) = &update {
                        channels.take(&update.correction());
                    }
                    updates.extend(update);
                }
                Event::Doubted => filter.doubt(),
                Event::Tared(deviation_m_s) => {
                    filter.tare_velocity(*deviation_m_s);
                    tared = true;
                }
            }
        }
        steps.push(Step {
            transition,
            predicted,
            wandered,
            updates,
            filtered: *filter.covariance(),
            channels,
            tared,
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
        }
    }

    /// At a block's end. The gain is right for a filter whose gains are, and this one's are not: where the filter alone knows the attitude
    /// better, what came later is left.
    fn reach(&mut self, step: &Step) {
        let mut left = SMatrix::<f64, 3, ERRORS>::zeros();
        left.fixed_columns_mut::<3>(ATTITUDE).fill_with_identity();
        left -= self.share.fixed_rows::<3>(ATTITUDE);
        let smoothed = times(&times(&left, &step.filtered), &left.transpose()).trace()
            + attitude_variance(&self.noise);
        let better = smoothed <= attitude_variance(&step.filtered);
        if step.lost || !better {
            *self = Self::nothing();
        }
    }

    /// From a block's end to its beginning.
    fn cross(&mut self, step: &Step) {
        for update in step.updates.iter().rev() {
            self.take_back(update);
        }
        if step.tared || attitude_variance(&step.predicted) > FIRST_ORDER_RAD * FIRST_ORDER_RAD {
            *self = Self::nothing();
        } else {
            self.carry(step);
        }
    }

    fn take_back(&mut self, update: &Update) {
        self.change_back(&update.about);
        let left = update.gain - times(&self.share, &update.gain);
        let mut shown = self.share.fixed_columns_mut::<3>(update.place);
        shown += left;
        self.noise += times(&times(&left, &update.noise), &left.transpose());
        self.found += update.found;
    }

    /// From errors about what was found to those about what was decoded.
    fn change_back(&mut self, about: &Dynamics) {
        let Some(back) = about.try_inverse() else {
            *self = Self::nothing();
            return;
        };
        let found = times(&back, &self.found.fixed_rows::<DYNAMIC>(0).into_owned());
        self.found.fixed_rows_mut::<DYNAMIC>(0).copy_from(&found);
        let rows = times(&back, &self.share.fixed_rows::<DYNAMIC>(0).into_owned());
        self.share.fixed_rows_mut::<DYNAMIC>(0).copy_from(&rows);
        let columns = times(&self.share.fixed_columns::<DYNAMIC>(0).into_owned(), about);
        self.share
            .fixed_columns_mut::<DYNAMIC>(0)
            .copy_from(&columns);
        change(&mut self.noise, &back);
    }

    fn carry(&mut self, step: &Step) {
        let Transition { by_errors, noise } = &step.transition;
        match &step.wandered {
            None => self.before_noise(&gain::of_dynamic(&step.predicted, by_errors, noise), noise),
            Some(wandered) => {
                let all = gain::noise_where_zeros_wander(noise, wandered);
                let gain = gain::where_zeros_wander(&step.predicted, by_errors, &all);
                self.before_noise(&gain, &all);
            }
        }
        let driven = self.share.fixed_columns::<DYNAMIC>(0).into_owned();
        let mut shares = times(&driven, by_errors);
        let kept = self.share.fixed_columns::<PARAMETRIC>(DYNAMIC);
        let mut parametric = shares.fixed_columns_mut::<PARAMETRIC>(DYNAMIC);
        parametric += kept;
        self.share = shares;
    }

    /// From a block's end to its beginning, but that the shares are still of errors at its end, by the gain's rows of the errors that have had
    /// noise of this covariance meanwhile. The others go back as they are.
    fn before_noise<const ROWS: usize>(
        &mut self,
        gain: &SMatrix<f64, ROWS, ERRORS>,
        noise: &SMatrix<f64, ROWS, ROWS>,
    ) {
        let back = times(gain, &self.found);
        self.found.fixed_rows_mut::<ROWS>(0).copy_from(&back);
        // Shares of these errors, and what noise they have had.
        let driven = self.share.fixed_columns::<ROWS>(0).into_owned();
        let all = self.noise + times(&times(&driven, noise), &driven.transpose());
        let crossed = times(gain, &all);
        let own = times(&crossed, &gain.transpose());
        self.noise = all;
        self.noise.fixed_rows_mut::<ROWS>(0).copy_from(&crossed);
        let columns = crossed.transpose();
        self.noise.fixed_columns_mut::<ROWS>(0).copy_from(&columns);
        self.noise
            .fixed_view_mut::<ROWS, ROWS>(0, 0)
            .copy_from(&((own + own.transpose()) * 0.5));
        let rows = times(gain, &self.share);
        self.share.fixed_rows_mut::<ROWS>(0).copy_from(&rows);
    }

    /// Of a sample that was decoded so, with the filter's covariance and the channels as they were corrected by then.
    fn state(
        &self,
        decoded: &SixAxis,
        filtered: &ErrorCovariance,
        channels: &Channels,
        lost: bool,
    ) -> Smoothed {
        let left = SMatrix::<f64, ERRORS, ERRORS>::identity() - self.share;
        let covariance = times(&times(&left, filtered), &left.transpose()) + self.noise;
        let found = Correction::of(&self.found, false);
        let off = DQuat::from_scaled_axis(-found.attitude_ground_rad);
        let mut channels = *channels;
        channels.take(&found);
        Smoothed {
            sample: decoded.sample,
            attitude: (off * decoded.attitude).normalize(),
            rate_shell_rad_s: decoded.rate_shell_rad_s - found.rate_shell_rad_s,
            covariance,
            channels,
            lost,
        }
    }
}

fn attitude_variance(covariance: &ErrorCovariance) -> f64 {
    covariance.fixed_view::<3, 3>(ATTITUDE, ATTITUDE).trace()
}
