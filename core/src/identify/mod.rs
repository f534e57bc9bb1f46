//! The four steps: 9 zero drifts, 9 scale/mass, 6 inertia/mass, 1 stiffness/mass.
//!
//! Each step streams its samples into constant memory and returns an estimate together with what is needed to judge
//! it: residual, condition number, covariance, and a verdict when the data cannot determine it. Later steps use the
//! results of earlier ones. The paper's band does not determine k/m; `tap` (feature `alloc`) is where it shows.

pub mod bias;
pub mod compliance;
pub mod compliance_fit;
pub mod inertia;
#[cfg(feature = "alloc")]
pub mod joint;
pub mod least_squares;
pub mod scale;
pub mod static_load_sharing;
pub mod stiffness;
pub mod stiffness_bound;
#[cfg(feature = "alloc")]
pub mod stiffness_search;
#[cfg(feature = "alloc")]
pub mod tap;
pub mod zero_drift;

use serde::{Deserialize, Serialize};

/// Whether the data determine what was asked of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// They do.
    Determined,
    /// They do not.
    Undetermined {
        /// Why, in terms of the data.
        reason: Reason,
    },
}

/// Why data leave a parameter open.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The standard error of an unknown is as large as the unknown's scale allows.
    Noise {
        /// Unknown, from 1 in the paper's order.
        unknown: usize,
        /// Standard error over the size of the unknown (for I/m: of the largest entry); the largest f64 for an unknown
        /// without a size.
        relative_standard_error: f64,
    },
    /// The search ended at an end of the grid: the objective has no minimum inside.
    EdgeOfGrid,
    /// The objective changes less over the grid than its own floor.
    Flat {
        /// Floor of the objective over its largest value on the grid.
        floor_over_largest: f64,
    },
    /// What is left of a fit is neither small nor noise: the data are not what the model is of.
    Misfit {
        /// Root mean square of the residual over that of the signal, where the signal is strongest.
        residual_over_signal: f64,
        /// Correlation of neighbouring residuals.
        correlation: f64,
    },
}

impl Verdict {
    /// True for [`Verdict::Determined`].
    #[must_use]
    pub fn is_determined(&self) -> bool {
        matches!(self, Self::Determined)
    }
}

/// Standard error over size above which an unknown counts as not determined. Required, not derived: the paper's identification changes scale
/// factors by 5 to 41 %, k/m by 35 % and the largest inertia by 29 % of the design's, and a tenth tells most of such changes.
const RELATIVE_STANDARD_ERROR_LIMIT: f64 = 0.1;

/// Judges unknowns each against its own size.
fn noise_verdict<const N: usize>(values: &[f64; N], standard_error: &[f64; N]) -> Verdict {
    worst::<N>(core::array::from_fn(|i| {
        standard_error[i] / values[i].abs()
    }))
}

/// Judges unknowns against one common size.
fn noise_verdict_relative_to<const N: usize>(size: f64, standard_error: &[f64; N]) -> Verdict {
    worst(standard_error.map(|e| e / size))
}

fn worst<const N: usize>(relative: [f64; N]) -> Verdict {
    let mut unknown = 0;
    for i in 1..N {
        // NaN (0/0) must win over any number: nothing is known then.
        if relative[i].is_nan() || relative[i] > relative[unknown] {
            unknown = i;
        }
    }
    if relative[unknown] <= RELATIVE_STANDARD_ERROR_LIMIT {
        Verdict::Determined
    } else {
        Verdict::Undetermined {
            reason: Reason::Noise {
                unknown: unknown + 1,
                // Of NaN and a number, `min` takes the number.
                relative_standard_error: relative[unknown].min(f64::MAX),
            },
        }
    }
}
