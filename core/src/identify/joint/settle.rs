//! The spreads of a room: those that maximise the marginal likelihood of the problem as it is linearised at a point.
//!
//! A step costs what it takes to price the own unknowns of all trials anew, and no second look at what the channels show. With
//! the spreads settled, Gauss-Newton goes on from there; two or three rounds of both suffice.

use alloc::vec::Vec;

use super::own::Kind;
use super::room::{Spreads, found};
use super::solve::{Campaign, Point, UNDETERMINED, normal};
use super::trial::Trial;
use super::unknowns::{CROSS_TALK, STIFFNESS, Unknowns};
use crate::error::Result;

/// Steps at most; what creeps on after them is a spread that the trials say next to nothing of.
const STEPS: usize = 200;
/// Relative change of a spread that moves no interval that anybody reads.
pub(super) const SPREAD_SETTLED: f64 = 0.02;

/// What a sequence has still to go whose last two steps are these: steps that shrink by a constant ratio add up to a geometric series. A
/// spread that few unknowns determine comes down slowly, and a short step is no sign that it has arrived.
fn to_come(before: f64, change: f64) -> f64 {
    match change {
        0.0 => 0.0,
        change if change < before => change * before / (before - change),
        _ => f64::INFINITY,
    }
}

impl Campaign<'_> {
    /// Trials take the spread of their sensitivities from here.
    pub(super) fn spread(&self, trials: &mut [Trial]) {
        for own in trials.iter_mut().flat_map(|trial| &mut trial.own) {
            if matches!(own.kind, Kind::Sensitivity(_)) {
                own.deviation = self.spreads.sensitivity;
            }
        }
    }

    /// A point that was linearised with other spreads.
    fn repriced(&self, at: Point) -> Result<Point> {
        let Point {
            unknowns,
            mut trials,
            normal: before,
        } = at;
        self.spread(&mut trials);
        let contributions = before
            .contributions
            .into_iter()
            .zip(&trials)
            .map(|(part, trial)| part.repriced(&trial.own).ok_or(UNDETERMINED))
            .collect::<Result<_>>()?;
        let normal = normal(contributions, &unknowns, &self.priors)?;
        Ok(Point {
            unknowns,
            trials,
            normal,
        })
    }

    /// The spreads that maximise the marginal likelihood of the problem as it is linearised at a point, and the point with these.
    pub(super) fn settle(mut self, mut at: Point) -> Result<(Self, Point)> {
        let mut before = None;
        for _ in 0..STEPS {
            let next = self.next_spreads(&at)?;
            let change = self.spreads.change(&next);
            if before.is_some_and(|before| to_come(before, change) < SPREAD_SETTLED) {
                break;
            }
            before = Some(change);
            self = Self::new(self.joint, next);
            at = self.repriced(at)?;
        }
        Ok((self, at))
    }

    /// Spreads from what the linearised problem says of the unknowns that have them.
    fn next_spreads(&self, at: &Point) -> Result<Spreads> {
        let normal = &at.normal;
        let covariance = normal.full(&normal.covariance()?);
        let step = &covariance * &normal.descent;
        let values = &at.unknowns.values + &step;
        let variances = covariance.diagonal();
        let mut sensitivities = Vec::new();
        for (trial, part) in at.trials.iter().zip(&normal.contributions) {
            let variances = part.own_variances(&covariance);
            let changes = part.own_step(&step);
            for (own, (variance, change)) in trial
                .own
                .iter()
                .zip(variances.iter().zip(changes.iter().flat_map(|c| c.iter())))
            {
                if matches!(own.kind, Kind::Sensitivity(_)) {
                    sensitivities.push((own.value + change, *variance));
                }
            }
        }
        let room = &self.joint.certificates.room;
        let now = &self.spreads;
        let shares = |beside| Unknowns::shares_of(beside);
        Ok(Spreads {
            stiffness: (room.stiffness).next(
                now.stiffness,
                found(STIFFNESS..CROSS_TALK, &values, &variances),
            ),
            cross_talk_beside: (room.cross_talk_beside).next(
                now.cross_talk_beside,
                found(shares(true), &values, &variances),
            ),
            cross_talk_apart: (room.cross_talk_apart).next(
                now.cross_talk_apart,
                found(shares(false), &values, &variances),
            ),
            sensitivity: (room.sensitivity).next(now.sensitivity, sensitivities.into_iter()),
            wedge_rad: self.joint.wedge_spread().next(
                now.wedge_rad,
                found(self.joint.wedge_angles(), &values, &variances),
            ),
        })
    }
}
