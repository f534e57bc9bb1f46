//! Gauss-Newton over all trials: common unknowns first, each trial's motion after them.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::estimate::JointEstimate;
use super::normal::Contribution;
use super::room::Spreads;
use super::settle::SPREAD_SETTLED;
use super::trial::Trial;
use super::unknowns::{ACCELEROMETER_GAIN, COMPLIANCE, Unknowns};
use super::{Joint, Known, WHAT, colour};
use crate::error::{Error, Result, require_samples};
use crate::float::sqrt;
use crate::identify::least_squares::gauss_newton::{Limits, Nonlinear, Outcome, iterate};

/// For one set of spreads; a campaign takes four steps for the first. Of a step a whole one is tried, a half, ...
const LIMITS: Limits = Limits {
    steps: 30,
    shares: 7,
};
/// Steps after which a fit that is to account for anything is near its end: what creeps on does not get there.
const PATIENCE: usize = 12;
/// Squares per degree of freedom beyond which a fit accounts for nothing.
const HOPELESS: f64 = 10.0;
/// Steps after which a fit is given up that is still beyond it: one that accounts for its trials needs no more altogether.
const HOPE: usize = 8;
/// Sets of spreads at most.
const ROUNDS: usize = 20;
/// A step whose square in the estimate's own covariance is below this changes nothing that could be told: a thousandth of a deviation.
const SETTLED: f64 = 1e-6;
/// The same where nothing is accounted for: a tenth of the deviations that the squares make of the estimate's own.
const SETTLED_HOPELESS: f64 = 1e-2;
/// Standard deviation of the accelerometer's gain below which the trials have told it.
const GAIN_TOLD: f64 = 0.05;
/// Condition of the normal matrix, scaled to a unit diagonal, at which a direction is lost to rounding.
const CONDITION_LIMIT: f64 = 1e13;

/// The free unknowns' normal equations.
pub(super) struct Normal {
    free: Vec<usize>,
    /// Whole information, free or not.
    information: DMatrix<f64>,
    pub(super) descent: DVector<f64>,
    squares: f64,
    pub(super) contributions: Vec<Contribution>,
}

/// Some trial's motion is not determined, or limbs do not hold the mass.
pub(super) const UNDETERMINED: Error = Error::NotConverged {
    what: WHAT,
    iterations: 0,
};

pub(super) fn normal(
    contributions: Vec<Contribution>,
    unknowns: &Unknowns,
    priors: &[(usize, Known)],
) -> Result<Normal> {
    let common = unknowns.len();
    let mut information = DMatrix::zeros(common, common);
    let mut descent = DVector::zeros(common);
    let mut squares = 0.0;
    let mut held = vec![false; common];
    held[ACCELEROMETER_GAIN] = true;
    for part in &contributions {
        information += &part.information;
        descent += &part.descent;
        squares += part.squares;
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
        return Err(Error::overflow(WHAT, 0));
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
    pub(super) fn covariance(&self) -> Result<DMatrix<f64>> {
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
        // The smallest eigenvalue is at least one over the inverse's trace, the largest at most the number of unknowns: where that
        // bounds the condition, which is nearly always, the eigenvalues themselves are not needed.
        let inverse = Cholesky::new(scaled.clone())
            .map(|factor| factor.inverse())
            .filter(|inverse| inverse.trace() * (n as f64) < CONDITION_LIMIT);
        let inverse = match inverse {
            Some(inverse) => inverse,
            None => self.inverse_if_determined(scaled)?,
        };
        Ok(DMatrix::from_fn(n, n, |a, b| {
            inverse[(a, b)] * scale[a] * scale[b]
        }))
    }

    /// Inverse of the scaled information where its condition allows one; names the unknown that is most of the direction that is
    /// open where it does not.
    fn inverse_if_determined(&self, scaled: DMatrix<f64>) -> Result<DMatrix<f64>> {
        let n = self.free.len();
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
        factor.map(|factor| factor.inverse()).ok_or_else(|| {
            let direction = eigen.eigenvectors.column(low);
            let open = (0..n)
                .max_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs()))
                .unwrap_or(0);
            self.indeterminate(open, condition.abs())
        })
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

    /// A covariance of all unknowns from one of the free ones.
    pub(super) fn full(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let mut full = DMatrix::zeros(self.descent.len(), self.descent.len());
        for (a, row) in self.free.iter().enumerate() {
            for (b, column) in self.free.iter().enumerate() {
                full[(*row, *column)] = covariance[(a, b)];
            }
        }
        full
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

pub(super) fn fit(joint: &Joint, start: Unknowns) -> Result<(JointEstimate, Vec<Trial>)> {
    require_samples(WHAT, 1, joint.trials.len())?;
    let mut trials = joint.trials.clone();
    colour::settle(&mut trials);
    for trial in &mut trials {
        trial.start(&start);
    }
    refit(joint, trials, start, joint.first_spreads())
}

/// As [`fit`], with the trials' motions as they stand.
pub(super) fn refit(
    joint: &Joint,
    trials: Vec<Trial>,
    start: Unknowns,
    spreads: Spreads,
) -> Result<(JointEstimate, Vec<Trial>)> {
    let mut campaign = Campaign::new(joint, spreads);
    let (mut at, mut steps) = (campaign.point(start, trials)?, 0);
    for round in 0..ROUNDS {
        let end = iterate(&campaign, at, LIMITS)?;
        steps += end.steps;
        if end.outcome != Outcome::Converged {
            let left = campaign.squares_per_degree(&end.at);
            if left > HOPELESS {
                let degrees = campaign.degrees_of_freedom(&end.at);
                return Err(Error::unaccounted(WHAT, steps, sqrt(left), degrees));
            }
            break;
        }
        let before = campaign.spreads;
        let settled;
        (campaign, settled) = campaign.settle(end.at)?;
        if round + 1 < ROUNDS && before.change(&campaign.spreads) >= SPREAD_SETTLED {
            at = settled;
            continue;
        }
        // The last step is negligible, and free.
        let step = campaign.step(&settled)?;
        let last = campaign.moved(&settled, &step, 1.0)?;
        let estimate = finish(&last, &campaign, steps)?;
        // Where gravity turns in the sensor the trials know the accelerometer's gain, and the fit has to be made at it.
        let held = last.unknowns.values[ACCELEROMETER_GAIN];
        let information = estimate.accelerometer_gain_information;
        let change = estimate.accelerometer_gain_seen - held;
        let gain_settled =
            information * GAIN_TOLD * GAIN_TOLD < 1.0 || information * change * change < SETTLED;
        if gain_settled {
            return Ok((estimate, last.trials));
        }
        let mut unknowns = last.unknowns;
        unknowns.values[ACCELEROMETER_GAIN] = estimate.accelerometer_gain_seen;
        at = campaign.point(unknowns, last.trials)?;
    }
    Err(Error::NotConverged {
        what: WHAT,
        iterations: steps,
    })
}

/// The fit over all trials with the accelerometer's gain held.
pub(super) struct Campaign<'a> {
    pub(super) joint: &'a Joint,
    pub(super) spreads: Spreads,
    pub(super) priors: Vec<(usize, Known)>,
}

/// Common unknowns, trials with their own, and the normal equations there.
pub(super) struct Point {
    pub(super) unknowns: Unknowns,
    pub(super) trials: Vec<Trial>,
    pub(super) normal: Normal,
}

/// A step of the common unknowns, its square in the estimate's own covariance, and the square below which it is negligible.
pub(super) struct Step {
    whole: DVector<f64>,
    size: f64,
    settled: f64,
}

impl<'a> Campaign<'a> {
    pub(super) fn new(joint: &'a Joint, spreads: Spreads) -> Self {
        Self {
            joint,
            spreads,
            priors: joint.priors(&spreads),
        }
    }

    fn point(&self, unknowns: Unknowns, mut trials: Vec<Trial>) -> Result<Point> {
        self.spread(&mut trials);
        let contributions = trials
            .iter()
            .map(|trial| {
                let part = trial.contribution(&unknowns, &self.joint.shares);
                part.ok_or(UNDETERMINED)
            })
            .collect::<Result<_>>()?;
        let normal = normal(contributions, &unknowns, &self.priors)?;
        Ok(Point {
            unknowns,
            trials,
            normal,
        })
    }

    fn squares_per_degree(&self, at: &Point) -> f64 {
        at.normal.squares / self.degrees_of_freedom(at).max(1) as f64
    }

    /// What is measured, and known beforehand, less what is fitted.
    fn degrees_of_freedom(&self, at: &Point) -> usize {
        let known = self.priors.iter().filter(|p| p.1.deviation > 0.0).count();
        let measured = known + at.trials.iter().map(Trial::measured).sum::<usize>();
        let fitted = at.normal.free.len() + at.trials.iter().map(Trial::fitted).sum::<usize>();
        measured.saturating_sub(fitted)
    }
}

impl Nonlinear for Campaign<'_> {
    type Point = Point;
    type Step = Step;

    fn step(&self, from: &Point) -> Result<Step> {
        let toward = from.normal.free_descent();
        let step = from.normal.covariance()? * &toward;
        let per_degree = self.squares_per_degree(from);
        Ok(Step {
            size: toward.dot(&step),
            settled: match per_degree > HOPELESS {
                true => SETTLED_HOPELESS * per_degree,
                false => SETTLED,
            },
            whole: from.normal.whole(&step),
        })
    }

    fn is_negligible(&self, step: &Step) -> bool {
        step.size < step.settled
    }

    /// Where the trials are far from being accounted for, or where the next step is beyond the deviations that their squares make of the
    /// estimate's own.
    fn gives_up(&self, steps: usize, at: &Point, step: &Step) -> bool {
        let per_degree = || self.squares_per_degree(at);
        match steps {
            HOPE => per_degree() > HOPELESS,
            PATIENCE => step.size > per_degree().max(1.0),
            _ => false,
        }
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

fn finish(at: &Point, campaign: &Campaign<'_>, iterations: usize) -> Result<JointEstimate> {
    let Point {
        unknowns,
        trials,
        normal,
    } = at;
    let priors = &campaign.priors;
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
    let full = normal.full(&covariance);
    let own = trials
        .iter()
        .zip(&normal.contributions)
        .map(|(trial, part)| trial.estimate(&part.own_variances(&full), part.squares))
        .collect();
    Ok(JointEstimate {
        compliance_from_elsewhere: priors.iter().any(|p| p.0 == COMPLIANCE),
        by_accelerometer_gain: normal.whole(&by_gain),
        accelerometer_gain_seen: gain_seen,
        accelerometer_gain_information: gain_information,
        covariance: full,
        squares: normal.squares,
        degrees_of_freedom: campaign.degrees_of_freedom(at),
        iterations,
        spreads: campaign.spreads,
        trials: own,
        unknowns: unknowns.clone(),
    })
}
