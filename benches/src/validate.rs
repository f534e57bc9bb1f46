//! Holds an answer against MuJoCo's truth before it is timed.

use std::fmt;

use glam::DVec3;
use sixaxis_core::identify::stiffness::PAPER_GRID_PER_S2;
use sixaxis_core::{LIMBS, Parameters, SixAxis};
use sixaxis_reference::motion::TrueMotion;

use sixaxis_props::compare::worse;
use sixaxis_props::faults::dying::angle_rad;
use sixaxis_props::problem::recorded::{candidate, true_parameters};
use sixaxis_props::tolerance::{self, DecoupledRun, Tolerance};

/// Why an answer is not worth timing.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// Not the samples asked for: one missing, doubled or out of order.
    Samples {
        /// What belongs there: a number of samples, or an index.
        expected: u64,
        /// What is there.
        got: u64,
    },
    /// An error beyond its limit; NaN is beyond every limit.
    Error {
        /// The quantity and its unit.
        what: &'static str,
        /// The limit.
        limit: Tolerance,
        /// The error.
        error: f64,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples { expected, got } => {
                write!(
                    f,
                    "samples are missing or out of order: {got} where {expected} belongs"
                )
            }
            Self::Error { what, limit, error } => write!(
                f,
                "{what} is off by {error:.3e}, allowed is {:.3e}",
                limit.limit
            ),
        }
    }
}

/// Refuses another number of samples than expected.
fn count(expected: usize, got: usize) -> Result<(), Refusal> {
    if got == expected {
        Ok(())
    } else {
        Err(Refusal::Samples {
            expected: expected as u64,
            got: got as u64,
        })
    }
}

/// What was compared: each quantity with its limit and the error found.
pub type Report = Vec<(&'static str, Tolerance, f64)>;

/// Prints what an answer achieved, or ends the bench.
///
/// # Panics
/// If the answer was refused.
pub fn require(name: &str, outcome: Result<Report, Refusal>) {
    match outcome {
        Ok(report) => {
            for (what, limit, error) in report {
                eprintln!("{name}: {what} {error:.3e} (limit {:.3e})", limit.limit);
            }
        }
        Err(refusal) => panic!("{name} is not timed, because its answer is wrong: {refusal}"),
    }
}

fn judge(report: Report) -> Result<Report, Refusal> {
    match report
        .iter()
        .find(|(_, limit, error)| !limit.allows(*error))
    {
        None => Ok(report),
        Some(&(what, limit, error)) => Err(Refusal::Error { what, limit, error }),
    }
}

/// Largest of `errors`; NaN if there is one, or if there are none.
fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    errors.reduce(worse).unwrap_or(f64::NAN)
}

/// Largest difference of vectors over the largest of the second.
fn over_peak(pairs: impl Iterator<Item = (DVec3, DVec3)> + Clone) -> f64 {
    largest(pairs.clone().map(|(ours, truth)| (ours - truth).length()))
        / largest(pairs.map(|(_, truth)| truth.length()))
}

/// A decoupled run: every sample from the second to the last but one, in order, near the truth throughout.
///
/// # Errors
/// A sample missing, doubled or out of order; an error beyond its limit.
pub fn decoupled(
    truth: &[TrueMotion],
    answers: &[SixAxis],
    limits: &DecoupledRun,
) -> Result<Report, Refusal> {
    count(truth.len().saturating_sub(2), answers.len())?;
    if let Some((expected, answer)) = (1..).zip(answers).find(|(at, a)| a.sample != *at) {
        return Err(Refusal::Samples {
            expected,
            got: answer.sample,
        });
    }
    let pairs = answers.iter().zip(&truth[1..]);
    judge(vec![
        (
            "linear acceleration over its peak",
            limits.linear,
            over_peak(
                pairs
                    .clone()
                    .map(|(a, t)| (a.linear_ground_m_s2, t.linear_ground_m_s2)),
            ),
        ),
        (
            "angular acceleration over its peak",
            limits.angular,
            over_peak(
                pairs
                    .clone()
                    .map(|(a, t)| (a.angular_ground_rad_s2, t.angular_ground_rad_s2)),
            ),
        ),
        (
            "angular rate over its peak",
            limits.rate,
            over_peak(
                pairs
                    .clone()
                    .map(|(a, t)| (a.rate_shell_rad_s, t.rate_shell_rad_s)),
            ),
        ),
        (
            "attitude in rad",
            limits.attitude_rad,
            largest(pairs.map(|(a, t)| angle_rad(a.attitude, t.attitude))),
        ),
    ])
}

/// Poses of the mass in the shell: position, m, and rotation vector, rad.
///
/// # Errors
/// Another number of poses than of truths; an error beyond its limit.
pub fn poses(truth: &[(DVec3, DVec3)], answers: &[(DVec3, DVec3)]) -> Result<Report, Refusal> {
    count(truth.len(), answers.len())?;
    let pairs = answers.iter().zip(truth);
    judge(vec![
        (
            "position of the mass over its peak",
            tolerance::POSE_POSITION,
            over_peak(pairs.clone().map(|(a, t)| (a.0, t.0))),
        ),
        (
            "rotation of the mass over its peak",
            tolerance::POSE_ROTATION,
            over_peak(pairs.map(|(a, t)| (a.1, t.1))),
        ),
    ])
}

/// The nine s_i/m, 1/kg.
///
/// # Errors
/// An error beyond its limit.
pub fn scale_per_mass(answer: &[f64; LIMBS]) -> Result<Report, Refusal> {
    let truth = true_parameters().scale_per_mass_per_kg;
    judge(vec![(
        "scale per mass, relative",
        tolerance::SCALE,
        largest(answer.iter().zip(truth).map(|(a, t)| ((a - t) / t).abs())),
    )])
}

/// The six I/m in the paper's order, m^2.
///
/// # Errors
/// An error beyond its limit.
pub fn inertia_per_mass(answer: &[f64; 6]) -> Result<Report, Refusal> {
    let truth = true_parameters().inertia_per_mass.to_paper_order();
    let size = largest(truth.iter().map(|t| t.abs()));
    judge(vec![(
        "inertia per mass over its largest entry",
        tolerance::INERTIA,
        largest(answer.iter().zip(truth).map(|(a, t)| (a - t).abs() / size)),
    )])
}

/// Step 4's objective: small at the true k/m, and large beside it. `rate_norm_sum` gives the sum of |w*|, rad/s, and
/// the number of samples for given parameters; there must be `samples` of them.
///
/// # Errors
/// Another number of samples; an error beyond its limit.
pub fn stiffness(
    samples: usize,
    rate_norm_sum: impl Fn(&Parameters) -> (f64, usize),
) -> Result<Report, Refusal> {
    let (_, _, grid_step) = PAPER_GRID_PER_S2;
    let truth = true_parameters().stiffness_per_mass_per_s2;
    let mut means = [0.0; 3];
    for (mean, k) in means
        .iter_mut()
        .zip([truth - grid_step, truth, truth + grid_step])
    {
        let (sum, got) = rate_norm_sum(&candidate(k));
        count(samples, got)?;
        *mean = sum / got as f64;
    }
    let [below, at_truth, above] = means;
    judge(vec![
        (
            "mean rate at the true k/m in rad/s",
            tolerance::STIFFNESS_RATE,
            at_truth,
        ),
        (
            "mean rate at the true k/m over that beside it",
            tolerance::STIFFNESS_CONTRAST,
            largest([at_truth / below, at_truth / above].into_iter()),
        ),
    ])
}

/// Accelerations in m/s^2 or rad/s^2, answer and truth, against a limit over the peak.
///
/// # Errors
/// An error beyond the limit.
pub fn accelerations(
    what: &'static str,
    limit: Tolerance,
    pairs: &[(DVec3, DVec3)],
) -> Result<Report, Refusal> {
    judge(vec![(what, limit, over_peak(pairs.iter().copied()))])
}
