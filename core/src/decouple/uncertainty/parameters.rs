//! The chain 1 -> 2 -> 3 -> 4: each step's own error, and what the later steps make of it.
//!
//! Let e hold what each step would be off by if the earlier ones were exact, its *own* errors. A step then is off by
//! delta = e + N delta, where N says how a parameter answers to the earlier ones. N has nothing on or above its diagonal
//! blocks, four of them, so N^4 = 0 and delta = (1 + N + N^2 + N^3) e. Own errors of different steps come from different
//! recordings: their covariance is a block diagonal matrix, and all correlation between steps is the chain's.
//!
//! The last of the 25 is here the *compliance* per mass, s^2, in which the rates of step 4 are linear, not k/m.

use crate::parameter::{PARAMETERS, Parameter};
use core::ops::Range;

use nalgebra::{SMatrix, SVector};

use crate::float::sqrt;

/// Steps that there are, so that N has no further powers.
const STEPS: usize = 4;

/// Covariance of the 25, each entry in the product of two units.
pub type Covariance = SMatrix<f64, PARAMETERS, PARAMETERS>;
/// Errors of the 25.
pub type Errors = SVector<f64, PARAMETERS>;

/// Standard deviations of a covariance.
#[must_use]
pub fn standard_deviations(covariance: &Covariance) -> [f64; PARAMETERS] {
    core::array::from_fn(|i| sqrt(covariance[(i, i)].max(0.0)))
}

/// How the steps answer to earlier ones: N.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    answers: Covariance,
}

impl Default for Chain {
    /// Steps that know nothing of each other.
    fn default() -> Self {
        Self {
            answers: Covariance::zeros(),
        }
    }
}

impl Chain {
    /// Adds to the answer of later parameters, from `place` on, to the parameter `to`.
    ///
    /// An answer to a parameter of the same step or a later one is none, and is left out.
    pub fn add<const N: usize>(&mut self, place: usize, answer: &SVector<f64, N>, to: usize) {
        for (i, a) in answer.iter().enumerate() {
            let parameter = place + i;
            if step(parameter) > step(to) {
                self.answers[(parameter, to)] += a;
            }
        }
    }

    /// Adds all answers of another chain.
    pub fn append(&mut self, other: &Self) {
        self.answers += other.answers;
    }

    /// The chain without the answer of one range of parameters to another: a negative control.
    #[must_use]
    pub fn without(&self, parameters: &Range<usize>, to: &Range<usize>) -> Self {
        let mut chain = self.clone();
        for i in parameters.clone() {
            for j in to.clone() {
                chain.answers[(i, j)] = 0.0;
            }
        }
        chain
    }

    /// 1 + N + N^2 + N^3: errors of the parameters from the steps' own.
    #[must_use]
    pub fn total(&self) -> Covariance {
        let mut sum = Covariance::identity();
        for _ in 1..STEPS {
            sum = Covariance::identity() + self.answers * sum;
        }
        sum
    }

    /// Covariance of the parameters from that of the steps' own errors.
    #[must_use]
    pub fn covariance(&self, own: &Covariance) -> Covariance {
        let total = self.total();
        let covariance = total * own * total.transpose();
        // Symmetric to the last digit, which the product is not.
        (covariance + covariance.transpose()) * 0.5
    }
}

/// The step that determines the parameter at a place, from 1; 0 beyond the 25.
fn step(place: usize) -> usize {
    Parameter::at(place).map_or(0, Parameter::step)
}
