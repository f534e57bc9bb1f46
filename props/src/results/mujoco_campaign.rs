//! Calibrations of sessions that MuJoCo played, and what the stated intervals hold of them, pooled over the parameters.

use serde::{Deserialize, Serialize};
use sixaxis_campaign::row::{Group, Row};
use sixaxis_campaign::statistics::{Share, Summary};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::significance::NORMAL_95;

/// The campaign of `campaign_mujoco.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MujocoCampaign {
    /// How often stated 95 % intervals hold the truth: of the four steps, of the joint fit.
    pub coverage: Vec<Pooled>,
    /// The same and more parameter by parameter.
    pub summary: Summary,
}

/// Coverage over all parameters and cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pooled {
    /// Whose intervals.
    pub estimator: String,
    /// Intervals that were stated.
    pub intervals: u64,
    /// Those that hold the truth.
    pub inside: u64,
    /// Wilson's 95 % interval of the share, as if all intervals were independent.
    pub wilson_95: (f64, f64),
    /// The same by the scatter from case to case: parameters of one case err together.
    pub by_case_95: (f64, f64),
}

impl Pooled {
    /// Of an estimator by name; `held` says of a case and a parameter whether the interval holds the truth, none where none is stated.
    pub fn of(estimator: &str, rows: &[Row], held: impl Fn(&Row, usize) -> Option<bool>) -> Self {
        let cases: Vec<(u64, u64)> = rows
            .iter()
            .map(|row| {
                let stated = (0..PARAMETERS).filter_map(|i| held(row, i));
                stated.fold((0, 0), |(inside, of), holds| {
                    (inside + u64::from(holds), of + 1)
                })
            })
            .collect();
        let inside = cases.iter().map(|(inside, _)| inside).sum();
        let intervals = cases.iter().map(|(_, of)| of).sum();
        let share = inside as f64 / intervals as f64;
        // A ratio of two sums over cases: its variance by the residuals, case by case.
        let squares: f64 = cases
            .iter()
            .map(|&(inside, of)| (inside as f64 - share * of as f64).powi(2))
            .sum();
        let n = cases.len() as f64;
        let half = NORMAL_95 * (squares * n / (n - 1.0).max(1.0)).sqrt() / intervals as f64;
        Self {
            estimator: estimator.to_owned(),
            intervals,
            inside,
            wilson_95: Share::of(inside, intervals).map_or((0.0, 1.0), |share| share.wilson_95),
            by_case_95: (share - half, share + half),
        }
    }

    /// Share of the intervals that hold the truth.
    pub fn share(&self) -> f64 {
        self.inside as f64 / self.intervals as f64
    }
}

/// Whether a case's interval of the four steps holds the truth.
pub fn four_steps_hold(row: &Row, i: usize) -> Option<bool> {
    let of = |group: Group| row.group(group)[i];
    let error = of(Group::FourSteps)? - of(Group::Truth)?;
    Some(error.abs() <= of(Group::StatedHalfWidth)?)
}

/// Whether a case's interval of the joint fit holds the truth.
pub fn joint_holds(row: &Row, i: usize) -> Option<bool> {
    let of = |group: Group| row.group(group)[i];
    let (low, high) = (of(Group::JointLow)?, of(Group::JointHigh)?);
    Some((low..=high).contains(&of(Group::Truth)?))
}
