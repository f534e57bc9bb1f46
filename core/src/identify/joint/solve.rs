//! Gauss-Newton over all trials: common unknowns first, each trial's motion after them.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::estimate::JointEstimate;
use super::normal::Contribution;
use super::trial::Trial;
use super::unknowns::{ACCELEROMETER_GAIN, COMPLIANCE, Unknowns};
use super::{Known, WHAT};
use crate::error::{Error, Result};
use crate::float::sqrt;
use crate::identify::least_squares::gauss_newton::{Limits, Nonlinear, Outcome, iterate};
use crate::identify::static_load_sharing::StaticLoadSharing;

/// Steps at most; a campaign takes four.
const STEPS: usize = 30;
/// A step whose square, measured in the estimate's own covariance, is below this changes nothing that could be told: a
/// thousandth of a standard deviation.
const SETTLED: f64 = 1e-6;
/// Shares of a step that are tried: a whole one, a half ...
const SHARES: usize = 7;
/// Standard deviation of the accelerometer's gain below which the trials have told it.
const GAIN_TOLD: f64 = 0.05;
/// Condition of the normal matrix, scaled to a unit diagonal, at which a direction is lost to rounding.
const CONDITION_LIMIT: f64 = 1e13;

/// The free unknowns' normal equations.
struct Normal {
    free: Vec<usize>,
    /// Whole information, free or not.
    information: DMatrix<f64>,
    descent: DVector<f64>,
    squares: f64,
    contributions: Vec<Contribution>,
}

fn normal(
    shares: &StaticLoadSharing,
    trials: &[Trial],
    unknowns: &Unknowns,
    priors: &[(usize, Known)],
) -> Result<Normal> {
    let common = unknowns.len();
    let mut information = DMatrix::zeros(common, common);
    let mut descent = DVector::zeros(common);
    let mut squares = 0.0;
    let mut held = vec![false; common];
    held[ACCELEROMETER_GAIN] = true;
    let mut contributions = Vec::with_capacity(trials.len());
    for trial in trials {
        let part = trial
            .contribution(unknowns, shares)
            .ok_or(Error::NotConverged {
                what: WHAT,
                iterations: 0,
            })?;
        information += &part.information;
        descent += &part.descent;
        squares += part.squares;
        contributions.push(part);
    }
    for (unknown, known) in priors {
        if known.deviation > 0.0 {
            let weight = 1.0 / (known.deviation * known.deviation);
            let residual = known.value - unknowns.values[*unknown];
            information[(*unknown, *unknown)] += weight;
            descent[*unknown] += weight * residual;
            squares += weight * residual * residual;
        } else {
            held[*unknown] = true;
        }
    }
    if !squares.is_finite() || !information.iter().all(|x| x.is_finite()) {
        return Err(Error::Overflow {
            what: WHAT,
            channel: 0,
            sample: 0,
        });
    }
    Ok(Normal {
        free: (0..common).filter(|u| !held[*u]).collect(),
        information,
        descent,
        squares,
        contributions,
    })
}

impl Normal {
    /// Inverse of the free unknowns' information.
    fn covariance(&self) -> Result<DMatrix<f64>> {
        let n = self.free.len();
        let scale: Vec<f64> = self
            .free
            .iter()
            .map(|u| 1.0 / sqrt(self.information[(*u, *u)]))
            .collect();
        if let Some(open) = scale.iter().position(|s| !s.is_finite()) {
            return Err(self.indeterminate(open, f64::INFINITY));
        }
        let scaled = DMatrix::from_fn(n, n, |a, b| {
            self.information[(self.free[a], self.free[b])] * scale[a] * scale[b]
        });
        let eigen = SymmetricEigen::new(scaled.clone());
        let (mut low, mut high) = (0, 0);
        for i in 1..n {
            if eigen.eigenvalues[i] < eigen.eigenvalues[low] {
                low = i;
            }
            if eigen.eigenvalues[i] > eigen.eigenvalues[high] {
                high = i;
            }
        }
        let condition = eigen.eigenvalues[high] / eigen.eigenvalues[low];
        let factor = (condition > 0.0 && condition < CONDITION_LIMIT)
            .then(|| Cholesky::new(scaled))
            .flatten();
        let Some(factor) = factor else {
            let direction = eigen.eigenvectors.column(low);
            let open = (0..n)
                .max_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs()))
                .unwrap_or(0);
            return Err(self.indeterminate(open, condition.abs()));
        };
        let inverse = factor.inverse();
        Ok(DMatrix::from_fn(n, n, |a, b| {
            inverse[(a, b)] * scale[a] * scale[b]
        }))
    }

    fn indeterminate(&self, free: usize, condition: f64) -> Error {
        Error::Indeterminate {
            what: WHAT,
            unknown: self.free[free] + 1,
            condition,
        }
    }

    fn free_descent(&self) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|u| self.descent[*u]))
    }

    /// A vector of all unknowns from one of the free ones.
    fn whole(&self, part: &DVector<f64>) -> DVector<f64> {
        let mut whole = DVector::zeros(self.descent.len());
        for (value, unknown) in part.iter().zip(&self.free) {
            whole[*unknown] = *value;
        }
        whole
    }
}

pub(super) fn fit(
    shares: &StaticLoadSharing,
    trials: &[Trial],
    start: Unknowns,
    priors: &[(usize, Known)],
) -> Result<(JointEstimate, Vec<Trial>)> {
    if trials.is_empty() {
        return Err(Error::TooFewSamples {
            what: WHAT,
            needed: 1,
            got: 0,
        });
    }
    let mut trials = trials.to_vec();
    for trial in &mut trials {
        trial.start(&start);
    }
    refit(shares, trials, start, priors)
}

/// As [`fit`], with the trials' motions as they stand.
pub(super) fn refit(
    shares: &StaticLoadSharing,
    trials: Vec<Trial>,
    start: Unknowns,
    priors: &[(usize, Known)],
) -> Result<(JointEstimate, Vec<Trial>)> {
    let campaign = Campaign { shares, priors };
    let mut at = campaign.point(start, trials)?;
    let mut steps = 0;
    loop {
        let limits = Limits {
            steps: STEPS - steps,
            shares: SHARES,
        };
        let end = iterate(&campaign, at, limits)?;
        steps += end.steps;
        let not_converged = Error::NotConverged {
            what: WHAT,
            iterations: steps,
        };
        if end.outcome != Outcome::Converged {
            return Err(not_converged);
        }
        // The last step is negligible, and free.
        let last = campaign.moved(&end.at, &end.step, 1.0)?;
        let estimate = finish(
            &last.trials,
            last.unknowns.clone(),
            &last.normal,
            priors,
            steps,
        )?;
        // Where gravity turns in the sensor the trials know the accelerometer's gain, and the fit has to be made at it.
        let held = last.unknowns.values[ACCELEROMETER_GAIN];
        let information = estimate.accelerometer_gain_information;
        let change = estimate.accelerometer_gain_seen - held;
        if information * GAIN_TOLD * GAIN_TOLD < 1.0 || information * change * change < SETTLED {
            return Ok((estimate, last.trials));
        }
        if steps >= STEPS {
            return Err(not_converged);
        }
        let mut unknowns = last.unknowns;
        unknowns.values[ACCELEROMETER_GAIN] = estimate.accelerometer_gain_seen;
        at = campaign.point(unknowns, last.trials)?;
    }
}

/// The fit over all trials with the accelerometer's gain held.
struct Campaign<'a> {
    shares: &'a StaticLoadSharing,
    priors: &'a [(usize, Known)],
}

/// Common unknowns, trials with their own, and the normal equations there.
struct Point {
    unknowns: Unknowns,
    trials: Vec<Trial>,
    normal: Normal,
}

/// A step of the common unknowns, and its square in the estimate's own covariance.
struct Step {
    whole: DVector<f64>,
    size: f64,
}

impl Campaign<'_> {
    fn point(&self, unknowns: Unknowns, trials: Vec<Trial>) -> Result<Point> {
        let normal = normal(self.shares, &trials, &unknowns, self.priors)?;
        Ok(Point {
            unknowns,
            trials,
            normal,
        })
    }
}

impl Nonlinear for Campaign<'_> {
    type Point = Point;
    type Step = Step;

    fn step(&self, from: &Point) -> Result<Step> {
        let toward = from.normal.free_descent();
        let step = from.normal.covariance()? * &toward;
        Ok(Step {
            size: toward.dot(&step),
            whole: from.normal.whole(&step),
        })
    }

    fn is_negligible(&self, step: &Step) -> bool {
        step.size < SETTLED
    }

    fn moved(&self, from: &Point, step: &Step, share: f64) -> Result<Point> {
        let mut unknowns = from.unknowns.clone();
        unknowns.values.axpy(share, &step.whole, 1.0);
        let mut trials = from.trials.clone();
        for (trial, part) in trials.iter_mut().zip(&from.normal.contributions) {
            trial.follow(part, &step.whole, share);
        }
        self.point(unknowns, trials)
    }

    fn is_better(&self, next: &Point, than: &Point) -> bool {
        next.normal.squares <= than.normal.squares
    }
}

fn finish(
    trials: &[Trial],
    unknowns: Unknowns,
    normal: &Normal,
    priors: &[(usize, Known)],
    iterations: usize,
) -> Result<JointEstimate> {
    let covariance = normal.covariance()?;
    let gain = ACCELEROMETER_GAIN;
    let across = DVector::from_iterator(
        normal.free.len(),
        normal.free.iter().map(|u| normal.information[(*u, gain)]),
    );
    let by_gain = -(&covariance * &across);
    let whole_information = normal.information[(gain, gain)];
    let own = whole_information + across.dot(&by_gain);
    // Below rounding of the difference there is nothing.
    let gain_information = if own > 1e-9 * whole_information {
        own
    } else {
        0.0
    };
    let held = unknowns.values[gain];
    let gain_seen = if gain_information > 0.0 {
        held + normal.descent[gain] / gain_information
    } else {
        held
    };
    let mut full = DMatrix::zeros(unknowns.len(), unknowns.len());
    for (a, row) in normal.free.iter().enumerate() {
        for (b, column) in normal.free.iter().enumerate() {
            full[(*row, *column)] = covariance[(a, b)];
        }
    }
    let measured: usize = trials
        .iter()
        .map(|t| 10 * t.grid.coordinates() - 1)
        .sum::<usize>()
        + priors.iter().filter(|p| p.1.deviation > 0.0).count();
    let fitted: usize = normal.free.len()
        + trials
            .iter()
            .map(|t| t.latent.len() + if t.amplifier { t.transient.len() } else { 0 })
            .sum::<usize>();
    Ok(JointEstimate {
        compliance_from_elsewhere: priors.iter().any(|p| p.0 == COMPLIANCE),
        by_accelerometer_gain: normal.whole(&by_gain),
        accelerometer_gain_seen: gain_seen,
        accelerometer_gain_information: gain_information,
        covariance: full,
        squares: normal.squares,
        degrees_of_freedom: measured.saturating_sub(fitted),
        iterations,
        unknowns,
    })
}
