//! How well the campaign with errors knows each of the 25 parameters, as data.

use serde::Serialize;
use sixaxis_core::Parameter;

/// Both estimators on the campaign with errors, and a tap beside it.
#[derive(Debug, Clone, Serialize)]
pub struct Known {
    /// d in V, s/m in 1/kg, I/m in m^2, m/k in s^2; numbered as in the paper.
    pub parameters: Vec<KnownParameter>,
    /// Squared residuals of the joint fit per degree of freedom: 1 where model and noise are right.
    pub joint_misfit: f64,
    /// Whether the joint fit determines m/k.
    pub compliance_is_determined: bool,
    /// k/m from one tap.
    pub tap: KnownTap,
}

/// One parameter.
#[derive(Debug, Clone, Serialize)]
pub struct KnownParameter {
    /// As in the paper, but `m/k`, of which errors are normal.
    #[serde(rename = "name")]
    pub parameter: Parameter,
    /// Of all numbers here that have one.
    pub unit: String,
    /// The truth, for comparison; no algorithm saw it.
    pub truth: f64,
    /// The four steps.
    pub four_steps: Interval,
    /// The joint fit.
    pub joint: Interval,
    /// Cramér-Rao bound of the standard deviation, the accelerometer's gain known.
    pub bound: f64,
    /// Error of the joint fit that is told the accelerometer's true gain, over that bound: a normal variable if the model is
    /// right.
    pub joint_error_over_bound: f64,
}

/// An estimate.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Interval {
    /// Best guess.
    pub estimate: f64,
    /// Ends of the 95 % interval.
    pub ends_95: (f64, f64),
    /// Standard deviation from noise and wedges, and whatever else of the day the trials themselves tell.
    pub of_trials: f64,
    /// Standard deviation from what the accelerometer's certificate leaves open.
    pub of_certificate: f64,
}

/// k/m from one tap, 1/s^2.
#[derive(Debug, Clone, Serialize)]
pub struct KnownTap {
    /// The truth.
    pub truth_per_s2: f64,
    /// k/m and the ends of its 95 % interval, where the tap determines it.
    pub found_per_s2: Option<(f64, (f64, f64))>,
    /// Why it does not.
    pub refused: Option<String>,
}
