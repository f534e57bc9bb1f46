//! The headline of the accuracy report, over many laboratories.

use serde::{Deserialize, Serialize};

use crate::evidence::Quantiles;

/// The largest of the 18 errors of Tables 4 to 6, seed by seed, over the peak of its axis.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Laboratories {
    /// First of the seeds; the others follow.
    pub first_seed: u64,
    /// Decoupled with the design's parameters.
    pub design: Treated,
    /// Decoupled with what the four steps found.
    pub identified: Treated,
    /// Decoupled with the true parameters: what noise and instruments alone do.
    pub with_truth: Treated,
}

/// The same voltages, treated in two ways.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Treated {
    /// Integrated as they are, as in the paper.
    pub open_loop: Against,
    /// Six numbers taken off each run, so that it ends at rest where it began.
    pub corrected: Against,
}

/// Errors against both standards, one a seed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Against {
    /// The standard instruments, as in the paper.
    pub instruments: Vec<f64>,
    /// The simulator's state.
    pub truth: Vec<f64>,
}

impl Laboratories {
    /// Every way of decoupling, by name.
    pub fn ways(&self) -> [(&'static str, &Against); 6] {
        [
            ("before identification, open loop", &self.design.open_loop),
            ("before identification, corrected", &self.design.corrected),
            ("identified, open loop", &self.identified.open_loop),
            ("identified, corrected", &self.identified.corrected),
            ("true parameters, open loop", &self.with_truth.open_loop),
            ("true parameters, corrected", &self.with_truth.corrected),
        ]
    }

    /// How one list of errors is distributed over the seeds.
    pub fn quantiles(errors: &[f64]) -> Option<Quantiles> {
        Quantiles::of(errors.iter().copied())
    }
}
