//! Steps 2 to 4 repeated until k/m stands still, or until it is clear that it will not.
//!
//! Each pass keeps the compliance that the pass before found. Without errors the distance from the fixed point shrinks by a
//! constant factor a pass (`sixaxis_core::identify::bias`). With errors of the standards or the channels step 4's curve has no
//! minimum that means anything, and a pass has nothing to hand to the next one: that ends it.

use serde::Serialize;
use sixaxis_core::identify::{Reason, Verdict};

use crate::error::Result;
use crate::steps::{Campaign, FourSteps};

/// When an iteration ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Relative change of k/m from pass to pass at which it stands still.
    pub stiffness_change: f64,
    /// Largest relative change of a scale factor, and of I/m over its largest entry, likewise.
    pub parameter_change: f64,
    /// Passes after which it ends in any case.
    pub passes: usize,
}

impl Default for Criterion {
    /// A change of k/m by 1e-5 moves the decoupled accelerations at 5 Hz by 1e-10 and s/m by 2e-11; the curve's parabola
    /// through three grid points is not better than that.
    fn default() -> Self {
        Self {
            stiffness_change: 1e-5,
            parameter_change: 1e-9,
            passes: 10,
        }
    }
}

/// One pass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pass {
    /// k/m that steps 2 and 3 reckoned with, s^-2; none for the first pass of all, in which limbs are rigid.
    pub kept_per_s2: Option<f64>,
    /// k/m where step 4's curve is smallest, between grid points, s^-2.
    pub found_per_s2: f64,
    /// Whether that curve determines it.
    pub verdict: Verdict,
    /// Largest relative change of a scale factor since the pass before.
    pub scale_change: Option<f64>,
    /// Largest change of an entry of I/m since the pass before, over the largest entry.
    pub inertia_change: Option<f64>,
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// k/m, s/m and I/m stand still.
    Converged,
    /// A pass's step 4 determines nothing that the next pass could go on from.
    Undetermined {
        /// Why.
        reason: Reason,
    },
    /// They still move after as many passes as were allowed.
    StillMoving {
        /// Relative change of k/m in the last pass.
        stiffness_change: f64,
    },
    /// The campaign has no trials for step 4.
    NoStepFour,
}

/// The passes and how they ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// Oldest first.
    pub passes: Vec<Pass>,
    /// How they ended.
    pub end: End,
    /// The four steps as the last pass left them.
    pub last: FourSteps,
}

impl Iteration {
    /// k/m, if it stands still, s^-2.
    pub fn stiffness_per_mass_per_s2(&self) -> Option<f64> {
        let last = self.passes.last()?;
        (self.end == End::Converged).then_some(last.found_per_s2)
    }

    /// What became of k/m, in one sentence.
    pub fn sentence(&self) -> String {
        let why = match self.end {
            End::Converged => {
                return format!(
                    "k/m stands still after {} passes",
                    self.passes.len().saturating_sub(1)
                );
            }
            End::Undetermined {
                reason: Reason::EdgeOfGrid,
            } => "the search ends at an edge of its grid".to_owned(),
            End::Undetermined {
                reason: Reason::Flat { floor_over_largest },
            } => format!(
                "the curve of the search is flat, its minimum {:.0} % of its largest value",
                100.0 * floor_over_largest
            ),
            End::Undetermined {
                reason: Reason::Noise { .. } | Reason::Misfit { .. },
            } => "it drowns in noise".to_owned(),
            End::StillMoving { stiffness_change } => format!(
                "it still moves by {:.1e} of itself after {} passes",
                stiffness_change,
                self.passes.len().saturating_sub(1)
            ),
            End::NoStepFour => "there is no step 4".to_owned(),
        };
        format!("k/m cannot be had from this campaign; tap the shell: {why}")
    }
}

impl Campaign {
    /// Repeats steps 2 to 4 with the limbs' compliance kept until k/m stands still.
    ///
    /// `start_per_s2` is the k/m of the first repetition; without one it is what `first` found, and if `first` found none the
    /// iteration ends before it begins.
    ///
    /// # Errors
    /// [`crate::Error::Step`]: the first step which refuses its data.
    pub fn repeat_until(
        &self,
        first: &FourSteps,
        start_per_s2: Option<f64>,
        criterion: &Criterion,
    ) -> Result<Iteration> {
        let mut last = first.clone();
        let mut passes = Vec::new();
        let Some(pass) = summed_up(None, None, first) else {
            return Ok(Iteration {
                passes,
                end: End::NoStepFour,
                last,
            });
        };
        let mut kept = start_per_s2.unwrap_or(pass.found_per_s2);
        let mut verdict = match start_per_s2 {
            Some(_) => Verdict::Determined,
            None => pass.verdict.clone(),
        };
        passes.push(pass);
        let end = loop {
            if let Verdict::Undetermined { reason } = verdict {
                break End::Undetermined { reason };
            }
            if passes.len() > criterion.passes {
                let found = passes.last().map_or(kept, |pass| pass.found_per_s2);
                let before = passes.iter().rev().nth(1).map_or(found, |p| p.found_per_s2);
                break End::StillMoving {
                    stiffness_change: (found / before - 1.0).abs(),
                };
            }
            let next = self.repeat_from(&last, kept)?;
            let Some(pass) = summed_up(Some(kept), Some(&last), &next) else {
                break End::NoStepFour;
            };
            let still = (pass.found_per_s2 / kept - 1.0).abs() <= criterion.stiffness_change
                && [pass.scale_change, pass.inertia_change]
                    .iter()
                    .all(|change| change.is_some_and(|c| c <= criterion.parameter_change));
            kept = pass.found_per_s2;
            verdict = pass.verdict.clone();
            passes.push(pass);
            last = next;
            if still && verdict.is_determined() {
                break End::Converged;
            }
        };
        Ok(Iteration { passes, end, last })
    }
}

/// None without step 4.
fn summed_up(kept: Option<f64>, before: Option<&FourSteps>, now: &FourSteps) -> Option<Pass> {
    let stiffness = now.stiffness.as_ref()?;
    let inertia = |steps: &FourSteps| steps.inertia.inertia_per_mass.to_paper_order();
    Some(Pass {
        kept_per_s2: kept,
        found_per_s2: stiffness.interpolated_per_s2,
        verdict: stiffness.verdict.clone(),
        scale_change: before.map(|before| {
            let (a, b) = (&before.scale.estimate.values, &now.scale.estimate.values);
            largest(a.iter().zip(b).map(|(a, b)| b / a - 1.0))
        }),
        inertia_change: before.map(|before| {
            let (a, b) = (inertia(before), inertia(now));
            largest(a.iter().zip(b).map(|(a, b)| b - a)) / largest(a.iter().copied())
        }),
    })
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}
