//! Results of examples and campaigns that take too long for a report, as `props/results` holds them.
//!
//! They are embedded when the report is built, so that it is the same wherever it is made. Each comes with the command that makes
//! it anew.

use std::collections::BTreeMap;

use serde::Deserialize;
use sixaxis_core::Parameter;

const CAMPAIGN: &str = include_str!("../../../../props/results/campaign.json");
const PROPAGATION: &str = include_str!("../../../../props/results/propagation.json");
const TAPS: &str = include_str!("../../../../props/results/tap.json");

/// Makes [`campaign`].
pub const MAKE_CAMPAIGN: &str = "`sixaxis campaign run --plan props/results/campaign.toml --count 10000 --out campaign`, \
                                 `sixaxis campaign summary campaign --json`";
/// Makes [`propagation`].
pub const MAKE_PROPAGATION: &str =
    "`cargo run --release -p sixaxis-props --example propagation -- --publish`";
/// Makes [`taps`].
pub const MAKE_TAPS: &str = "`cargo run --release -p sixaxis-props --example tap -- --publish`";

/// `props/results/campaign.json`: a campaign summed up.
#[derive(Deserialize)]
pub struct Campaign {
    pub first_seed: u64,
    pub last_seed: u64,
    pub cases: u64,
    /// How often step 4 said what.
    pub step_4: BTreeMap<String, u64>,
    pub parameters: Vec<CampaignParameter>,
}

#[derive(Deserialize)]
pub struct CampaignParameter {
    #[serde(rename = "name")]
    pub parameter: Parameter,
    pub four_steps: Estimator,
    pub joint: Option<Estimator>,
    /// What it states is the Cramér-Rao bound.
    pub joint_gain_known: Option<Estimator>,
}

#[derive(Deserialize)]
pub struct Estimator {
    pub cases: u64,
    pub variance_over_stated: Option<f64>,
    pub within_stated_95: Option<Share>,
}

#[derive(Deserialize, Clone, Copy)]
pub struct Share {
    pub value: f64,
    pub standard_error: f64,
}

/// `props/results/propagation.json`: closed-form standard deviations against drawn ones.
#[derive(Deserialize)]
pub struct Propagation {
    pub draws: u64,
    /// Standard deviation of a drawn standard deviation, relative.
    pub drawn_to: f64,
    pub sets: Vec<Set>,
}

#[derive(Deserialize)]
pub struct Set {
    pub sources: String,
    pub largest_departure: f64,
    pub parameters: Vec<Ratio>,
    pub by_attitude: Vec<Band>,
}

/// A parameter's standard deviation, closed form over drawn.
#[derive(Deserialize)]
pub struct Ratio {
    #[serde(rename = "name")]
    pub parameter: Parameter,
    pub ratio: f64,
}

/// Accelerations where the attitude's standard deviation lies below an edge and above the edge before.
#[derive(Deserialize)]
pub struct Band {
    pub below_rad: f64,
    pub values: u64,
    pub largest_departure: f64,
    pub rms_departure: f64,
}

/// `props/results/tap.json`: taps by the hundred.
#[derive(Deserialize)]
pub struct Taps {
    pub noise_over_peak: f64,
    pub sample_rate_hz: f64,
    pub tallies: Vec<Tally>,
}

/// Taps at one damping.
#[derive(Deserialize)]
pub struct Tally {
    pub damping_ratio: f64,
    pub taps: u64,
    pub refused: u64,
    pub rms_error_ln: f64,
    pub deviation_over_bound: f64,
    pub bias_over_bound: f64,
    pub coverage_95: f64,
}

pub fn campaign() -> serde_json::Result<Campaign> {
    serde_json::from_str(CAMPAIGN)
}

pub fn propagation() -> serde_json::Result<Propagation> {
    serde_json::from_str(PROPAGATION)
}

pub fn taps() -> serde_json::Result<Taps> {
    serde_json::from_str(TAPS)
}
