//! Gauss-Newton's iteration with step halving: the one loop of every fit that is not linear in its unknowns.
//!
//! At each point the fit is linearised and the linear problem's solution taken as a step. A full step may overshoot, so it is
//! halved until it leads to a better point. The iteration ends with a step that changes nothing the data could show.

use crate::error::Result;

/// A fit that proceeds by linearised least squares.
pub(crate) trait Nonlinear {
    /// Values of the unknowns, with whatever has been evaluated there.
    type Point;
    /// A step of all unknowns.
    type Step;

    /// The Gauss-Newton step from a point.
    fn step(&self, from: &Self::Point) -> Result<Self::Step>;

    /// Whether a step is too small for the data to show.
    fn is_negligible(&self, step: &Self::Step) -> bool;

    /// Whether more than so many steps are of no use, with the last of them not yet taken.
    fn gives_up(&self, _steps: usize, _at: &Self::Point, _step: &Self::Step) -> bool {
        false
    }

    /// The point after `share` of a step; an error where the model is not defined.
    fn moved(&self, from: &Self::Point, step: &Self::Step, share: f64) -> Result<Self::Point>;

    /// Whether the iteration may go on from `next`.
    fn is_better(&self, next: &Self::Point, than: &Self::Point) -> bool;
}

/// How much larger a share of a step is tried first than the one before it needed: where halving was needed it is needed again.
const GROWTH: f64 = 4.0;

/// When the iteration gives up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Steps at most.
    pub steps: usize,
    /// Shares 1, 1/2, 1/4 ... of one step that are tried at most.
    pub shares: usize,
}

/// Why an iteration has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The next step is negligible.
    Converged,
    /// No share of the next step leads to a better point.
    NoBetterPoint,
    /// As many steps as allowed or of use, and the last one is not negligible.
    OutOfSteps,
}

/// Where an iteration has ended.
pub(crate) struct End<N: Nonlinear> {
    /// The last point.
    pub at: N::Point,
    /// The step from there, which was not taken; self-calibration, which needs no allocation, does not read it.
    #[cfg_attr(not(feature = "alloc"), expect(dead_code))]
    pub step: N::Step,
    /// Steps computed, that one included.
    pub steps: usize,
    /// Why it ended there.
    pub outcome: Outcome,
}

/// Iterates from a start until a step is negligible, no share of it leads to a better point, or `limits` are reached.
///
/// # Errors
/// Those of [`Nonlinear::step`].
pub(crate) fn iterate<N: Nonlinear>(fit: &N, start: N::Point, limits: Limits) -> Result<End<N>> {
    let mut at = start;
    let mut steps = 0;
    let mut share = 1.0_f64;
    loop {
        let step = fit.step(&at)?;
        steps += 1;
        let outcome = if fit.is_negligible(&step) {
            Outcome::Converged
        } else if steps >= limits.steps || fit.gives_up(steps, &at, &step) {
            Outcome::OutOfSteps
        } else {
            // A share that leads out of the model's range is no better; a smaller one may be.
            let first = 1.0_f64.min(GROWTH * share);
            let better = core::iter::successors(Some(first), |share| Some(0.5 * share))
                .take(limits.shares)
                .find_map(|share| {
                    let next = fit.moved(&at, &step, share).ok()?;
                    fit.is_better(&next, &at).then_some((next, share))
                });
            if let Some(better) = better {
                (at, share) = better;
                continue;
            }
            Outcome::NoBetterPoint
        };
        return Ok(End {
            at,
            step,
            steps,
            outcome,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root of atan x = 0 by Newton's step, which overshoots ever further from |x| > 1.39 on.
    struct Arctangent;

    impl Nonlinear for Arctangent {
        type Point = f64;
        type Step = f64;

        fn step(&self, from: &f64) -> Result<f64> {
            Ok(-from.atan() * (1.0 + from * from))
        }

        fn is_negligible(&self, step: &f64) -> bool {
            step.abs() < 1e-12
        }

        fn moved(&self, from: &f64, step: &f64, share: f64) -> Result<f64> {
            Ok(from + share * step)
        }

        fn is_better(&self, next: &f64, than: &f64) -> bool {
            next.atan().abs() < than.atan().abs()
        }
    }

    #[test]
    fn a_step_that_overshoots_is_halved() {
        let outcome = |steps, shares| {
            let end = iterate(&Arctangent, 3.0, Limits { steps, shares }).expect("steps");
            (end.outcome, end.at)
        };
        let (converged, root) = outcome(20, 8);
        assert_eq!(converged, Outcome::Converged);
        assert!(root.abs() < 1e-12, "{root}");
        assert_eq!(outcome(20, 1).0, Outcome::NoBetterPoint);
        assert_eq!(outcome(2, 8).0, Outcome::OutOfSteps);
    }
}
