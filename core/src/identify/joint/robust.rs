//! The joint fit with Huber's loss, which outliers bend little.
//!
//! A residual r of deviation sigma counts as r^2 up to `limit` sigma and as a straight line beyond. Its minimum is found with
//! least squares alone (Huber's pseudo-values): every sample is replaced by the model's value plus its residual, cut off at
//! `limit` sigma, and the fit repeated until it stands still. Sigma is the residuals' median absolute deviation, which only
//! outliers in half of the samples would carry away. Of a cut-off sample only the sign counts: where a share w of the samples is left whole, the estimate's variance is that of the cut residuals over w^2. The squares of cut residuals over that are w^2 for
//! each degree of freedom; they are returned over w^2, so that a misfit of 1 is a fit here, too.

use alloc::vec::Vec;

use nalgebra::DVector;

use super::estimate::JointEstimate;
use super::harmonics::{Projection, project, project_stepped};
use super::trial::Trial;
use super::unknowns::Unknowns;
use super::{Joint, Record, WHAT, solve};
use crate::dsp::outlier::{SIGMA_PER_MAD, median};
use crate::error::{Error, Result, require};
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;
use crate::model::Parameters;

/// Cut-off, in deviations, at which normal noise costs 5 % of the variance.
pub const USUAL_LIMIT: f64 = 1.345;
/// Share of a record's variance that is noise when every wild value is cut off, at least: values a million deviations off.
const LEAST_SHARE: f64 = 1e-12;
/// Least cut-off: a share of 0.68 of normal residuals is left whole there, so that a repetition takes two thirds of what is left
/// of the way.
const LEAST_LIMIT: f64 = 1.0;
/// Repetitions at most; with a thousandth of outliers it takes five.
const ROUNDS: usize = 40;
/// Change of every unknown, in its standard deviations, at which the fit stands still.
const STILL: f64 = 0.01;

impl Joint {
    /// As [`Joint::fit`], with every residual beyond `limit` deviations cut off there. `records` are those that were added, in
    /// their order.
    ///
    /// # Errors
    /// Those of [`Joint::fit`]; [`Error::OutOfRange`] for a limit below 1, [`Error::LengthMismatch`] for records
    /// that are not those of the trials.
    pub fn fit_robust(
        &self,
        start: &Parameters,
        records: &[Record],
        limit: f64,
    ) -> Result<JointEstimate> {
        require(
            limit >= LEAST_LIMIT && limit.is_finite(),
            "limit",
            limit,
            "at least 1 and finite",
        )?;
        let mismatch = |expected, got| {
            Err(Error::LengthMismatch {
                what: "records of the joint estimator",
                expected,
                got,
            })
        };
        if records.len() != self.trials.len() {
            return mismatch(self.trials.len(), records.len());
        }
        for (trial, record) in self.trials.iter().zip(records) {
            let samples = trial.grid.samples;
            if record.voltage_v.len() != samples || record.standard.len() != samples {
                return mismatch(samples, record.voltage_v.len().min(record.standard.len()));
            }
        }
        let (mut estimate, mut fitted) = self.fit_trials(start)?;
        for _ in 0..ROUNDS {
            let mut expected = 0.0;
            for (trial, record) in fitted.iter_mut().zip(records) {
                let share;
                (trial.data, share) =
                    cut_off(trial, record, &estimate.unknowns, &self.shares, limit);
                expected += share / records.len() as f64;
            }
            let unknowns = estimate.unknowns.clone();
            let (mut next, next_fitted) = solve::refit(self, fitted, unknowns, estimate.spreads)?;
            next.squares /= expected;
            let still = (0..next.unknowns.len()).all(|u| {
                let change = next.unknowns.values[u] - estimate.unknowns.values[u];
                change * change <= STILL * STILL * next.covariance[(u, u)]
            });
            (estimate, fitted) = (next, next_fitted);
            if still {
                return Ok(estimate);
            }
        }
        Err(Error::NotConverged {
            what: WHAT,
            iterations: ROUNDS,
        })
    }
}

/// The record's projection with its residuals cut off, and the mean of w^2 over its channels.
fn cut_off(
    trial: &Trial,
    record: &Record,
    unknowns: &Unknowns,
    shares: &StaticLoadSharing,
    limit: f64,
) -> (Projection<{ LIMBS + 1 }>, f64) {
    let Some(parts) = trial.parts(unknowns, shares) else {
        // No fit ends with stiffnesses that do not hold the mass.
        return (trial.data.clone(), 1.0);
    };
    let mut whole = [0.0; LIMBS + 1];
    let values: [Vec<f64>; LIMBS + 1] = core::array::from_fn(|channel| {
        let coordinates: DVector<f64> = if channel < LIMBS {
            let prediction = trial.prediction(unknowns, &parts, channel);
            match unknowns.delay(channel) {
                None => prediction,
                Some(delay) => trial.sooner(&prediction, -unknowns.values[delay]),
            }
        } else {
            trial.standard_prediction(unknowns)
        };
        // What a step has above the last harmonic is no residual.
        let mut values = match trial.elsewhere {
            None => trial.grid.samples_of(&coordinates),
            Some(ends) => trial
                .grid
                .samples_of_stepped(coordinates, ends.step[channel]),
        };
        let mut residuals: Vec<f64> = values
            .iter()
            .enumerate()
            .map(|(n, model)| at(record, channel, n) - model)
            .collect();
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        let bound = limit * SIGMA_PER_MAD * median(&mut sizes);
        let mut uncut = 0_usize;
        for r in &mut residuals {
            if r.abs() <= bound {
                uncut += 1;
            } else {
                *r = r.clamp(-bound, bound);
            }
        }
        whole[channel] = uncut as f64 / residuals.len() as f64;
        for (value, residual) in values.iter_mut().zip(residuals) {
            *value += residual;
        }
        values
    });
    let cut = |n: usize| core::array::from_fn(|c| values[c][n]);
    let mut data = match trial.elsewhere {
        None => project(&trial.grid, cut),
        Some(ends) => project_stepped(&trial.grid, &ends.step, cut),
    };
    for ((variance, before), whole) in data
        .variance
        .iter_mut()
        .zip(&trial.data.variance)
        .zip(whole)
    {
        // At a limit of 1 or more, half of the samples are left whole at least: the median's own half. A record without noise
        // keeps the floor it was given.
        *variance = if whole >= 0.5 {
            (*variance / (whole * whole)).max(LEAST_SHARE * before)
        } else {
            *before
        };
    }
    let expected = whole.iter().map(|w| w * w).sum::<f64>() / whole.len() as f64;
    (data, expected)
}

fn at(record: &Record, channel: usize, n: usize) -> f64 {
    match channel {
        LIMBS => record.standard[n],
        limb => record.voltage_v[n][limb],
    }
}
