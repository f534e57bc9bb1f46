//! A recording decoupled once more, with all that its whole says.

use alloc::vec::{IntoIter, Vec};
use core::mem::replace;

use glam::{DQuat, DVec3};

use super::deviations::{Deviations, accelerations};
use super::history::History;
use super::model::ErrorModel;
use super::smoother::{Smoothed, Smoother};
use crate::decouple::stream::Decoupler;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::model::Settings;
use crate::six_axis::SixAxis;

/// Nine voltages in, six accelerations out, from attitude, rate and channels as they turned out to be: these are set anew where each of the
/// first pass's blocks ends.
#[derive(Debug, Clone)]
pub struct SmoothedDecoupler {
    decoupler: Decoupler,
    smoother: Smoother,
    model: ErrorModel,
    gravity_ground_m_s2: DVec3,
    /// As it was taken to be at the first sample.
    initial_attitude: DQuat,
    /// What samples go on from.
    now: Smoothed,
    /// The following ones, and the number of the segment after them.
    ahead: IntoIter<Smoothed>,
    next_segment: usize,
    /// The block end to come.
    next: Option<Smoothed>,
    /// The sample that was answered last, and its voltages; those of the one that is answered next.
    last: Option<SixAxis>,
    answered: [f64; LIMBS],
    before: [f64; LIMBS],
}

impl SmoothedDecoupler {
    pub(super) fn new(history: History, decoupler: Decoupler, settings: &Settings) -> Option<Self> {
        let model = history.model()?.clone();
        let smoother = Smoother::new(history);
        let begin = SixAxis::still(settings.initial_attitude);
        let now = smoother.begin(&begin)?;
        let mut new = Self {
            decoupler,
            smoother,
            model,
            gravity_ground_m_s2: settings.gravity_ground_m_s2,
            initial_attitude: settings.initial_attitude,
            now,
            ahead: Vec::new().into_iter(),
            next_segment: 0,
            next: None,
            last: None,
            answered: [0.0; LIMBS],
            before: [0.0; LIMBS],
        };
        new.advance();
        Some(new)
    }

    /// Takes the next nine voltages, the same as the first time, and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`].
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<SixAxis>> {
        if let (Some(last), Some(next)) = (self.last, &self.next)
            && last.sample == next.sample
        {
            let turn = last.attitude.inverse() * next.attitude;
            self.decoupler.steer(
                turn.to_scaled_axis(),
                next.rate_shell_rad_s - last.rate_shell_rad_s,
            );
            let before = self.now.channels;
            self.advance();
            self.decoupler.mend_recent(
                [&mut self.answered, &mut self.before],
                &self.now.channels,
                &before,
            )?;
        }
        let mended = self.now.channels.mended(voltage_v);
        let mut answer = self.decoupler.push(&mended)?;
        self.answered = replace(&mut self.before, mended);
        if let (Some(first), None) = (&mut answer, self.last) {
            self.begin(first);
        }
        self.last = answer.or(self.last);
        Ok(answer)
    }

    /// The first answer is that of another attitude and rate at the first sample.
    fn begin(&mut self, first: &mut SixAxis) {
        let gravity = self.gravity_ground_m_s2;
        let off = self.now.attitude * self.initial_attitude.inverse();
        let turn_shell = first.attitude.inverse() * off * first.attitude;
        self.decoupler
            .steer(turn_shell.to_scaled_axis(), self.now.rate_shell_rad_s);
        first.linear_ground_m_s2 = off * (first.linear_ground_m_s2 - gravity) + gravity;
        first.angular_ground_rad_s2 = off * first.angular_ground_rad_s2;
        first.attitude = (off * first.attitude).normalize();
        first.rate_shell_rad_s += self.now.rate_shell_rad_s;
    }

    /// Goes on from the block end that has been reached.
    fn advance(&mut self) {
        if let Some(next) = self.next.take() {
            self.now = next;
        }
        self.next = self.ahead.next();
        if self.next.is_none() {
            self.ahead = self.smoother.ends(self.next_segment).into_iter();
            self.next_segment += 1;
            self.next = self.ahead.next();
        }
    }

    /// How well rate, attitude and velocity are known where the last block ended.
    #[must_use]
    pub fn deviations(&self) -> Deviations {
        self.now.deviations()
    }

    /// Standard deviations of a and w' of the sample that was answered last, ground axes, m/s^2 and rad/s^2, but for its own noise.
    #[must_use]
    pub fn accelerations(&self, answered: &SixAxis) -> [f64; 6] {
        let variance = self.deviations().attitude_ground_rad.length_squared();
        let known = &self.now.covariance;
        accelerations(&self.model, known, variance, &self.answered, answered)
    }

    /// What samples go on from: the state where the last block ended.
    #[must_use]
    pub fn state(&self) -> &Smoothed {
        &self.now
    }
}
