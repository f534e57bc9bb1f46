//! Errors of one estimate over many cases, against what the estimate said of itself.

use serde::{Deserialize, Serialize};
use sixaxis_core::significance::NORMAL_95;

use super::share::Share;

/// One estimator of one parameter. Errors are estimate less truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimator {
    /// Cases that have an estimate.
    pub cases: u64,
    /// Cases that have none.
    pub failures: u64,
    /// Mean error, in the parameter's unit.
    pub bias: Option<f64>,
    /// Mean error over the errors' standard deviation; of an estimate without bias it scatters about 0 by 1/root(cases).
    pub bias_in_sd: Option<f64>,
    /// Standard deviation of the errors about their mean, in the parameter's unit.
    pub attained_sd: Option<f64>,
    /// Root mean square of the standard errors that the estimates come with. Of sensors that differ, this is what the errors'
    /// root mean square should be.
    pub stated_sd: Option<f64>,
    /// `attained_sd` over `stated_sd`: 1 for an estimate that is as good as it says.
    pub attained_over_stated: Option<f64>,
    /// Mean of the squared errors, each over its own stated variance: what the ratio of variances is where sensors differ in how
    /// well they are known. Of normal errors it scatters by root(2/cases).
    pub variance_over_stated: Option<f64>,
    /// Cases whose error lies within 1.96 standard errors: what the stated errors promise if they are normal. Of
    /// the four steps and of a fit told the gain that is noise; of the joint fit it has the certificate, whose even spread ends at 1.73
    /// standard deviations.
    pub within_noise_95: Option<Share>,
    /// Cases whose truth lies within the 95 % interval that is stated with the estimate: noise, differences between trials and
    /// certificates.
    pub within_stated_95: Option<Share>,
}

/// Count and sum of squares of something stated with an estimate.
#[derive(Debug, Clone, Copy, Default)]
struct Stated {
    cases: u64,
    squares: f64,
}

impl Stated {
    fn add(&mut self, value: f64) {
        self.cases += 1;
        self.squares += value * value;
    }

    fn mean_square(self) -> Option<f64> {
        (self.cases > 0).then(|| self.squares / self.cases as f64)
    }

    fn root_mean_square(self) -> Option<f64> {
        self.mean_square().map(f64::sqrt)
    }
}

/// Count and how many of them are inside.
#[derive(Debug, Clone, Copy, Default)]
struct Covered {
    cases: u64,
    inside: u64,
}

impl Covered {
    fn add(&mut self, inside: bool) {
        self.cases += 1;
        self.inside += u64::from(inside);
    }

    fn share(self) -> Option<Share> {
        Share::of(self.inside, self.cases)
    }
}

/// Mean and squares of the errors by Welford's recursion, which a million cases do not wear out, and what they are held against.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moments {
    cases: u64,
    mean: f64,
    squares: f64,
    standard_error: Stated,
    standardised: Stated,
    within_noise: Covered,
    within_stated: Covered,
}

impl Moments {
    pub const fn cases(&self) -> u64 {
        self.cases
    }

    /// Adds a case.
    pub fn add(&mut self, error: f64, standard_error: Option<f64>, inside_stated_95: Option<bool>) {
        self.cases += 1;
        let from_mean = error - self.mean;
        self.mean += from_mean / self.cases as f64;
        self.squares += from_mean * (error - self.mean);
        if let Some(stated) = standard_error {
            self.standard_error.add(stated);
            if stated > 0.0 {
                self.standardised.add(error / stated);
            }
            self.within_noise.add(error.abs() <= NORMAL_95 * stated);
        }
        if let Some(inside) = inside_stated_95 {
            self.within_stated.add(inside);
        }
    }

    /// What they say, of so many cases in all.
    pub fn summary(&self, of: u64) -> Estimator {
        let attained = (self.cases > 1).then(|| (self.squares / (self.cases - 1) as f64).sqrt());
        let over = |other: Option<f64>| Some(attained? / other.filter(|sd| *sd > 0.0)?);
        Estimator {
            cases: self.cases,
            failures: of - self.cases,
            bias: (self.cases > 0).then_some(self.mean),
            bias_in_sd: attained.filter(|sd| *sd > 0.0).map(|sd| self.mean / sd),
            attained_sd: attained,
            stated_sd: self.standard_error.root_mean_square(),
            attained_over_stated: over(self.standard_error.root_mean_square()),
            variance_over_stated: self.standardised.mean_square(),
            within_noise_95: self.within_noise.share(),
            within_stated_95: self.within_stated.share(),
        }
    }
}
