//! `props/results/self_calibration.json`, embedded when the report is built.

use serde::{Deserialize, Serialize};

const RESULT: &str = include_str!("../../../../props/results/self_calibration.json");

#[derive(Serialize, Deserialize)]
pub struct Published {
    pub first_seed: u64,
    pub noise_over_peak: f64,
    pub sample_rate_hz: f64,
    pub bar: f64,
    pub rates: [f64; 2],
    pub step_2_deviation: f64,
    pub stiffness_bar: f64,
    pub accumulator_bytes: u64,
    pub lengths: Vec<Length>,
    pub stiffness: Vec<Stiffness>,
    pub drift: Drift,
    pub motions: Vec<Motion>,
}

#[derive(Serialize, Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    Calm,
    Brisk,
    Shaken,
}

impl Pace {
    pub const fn word(self) -> &'static str {
        match self {
            Self::Calm => "calm",
            Self::Brisk => "brisk",
            Self::Shaken => "shaken",
        }
    }
}

/// Errors against intervals at one length.
#[derive(Serialize, Deserialize)]
pub struct Length {
    pub pace: Pace,
    pub duration_s: f64,
    pub draws: u64,
    pub refused: u64,
    pub rms_error: f64,
    pub largest_error: f64,
    pub median_deviation: f64,
    pub share_within_bar: f64,
    pub draws_within_bar: f64,
    pub coverage_95: f64,
    pub coverage_95_by_limb: [f64; 9],
    pub named_without_drift: [f64; 2],
    pub refused_equal_stiffness: [f64; 2],
}

/// The test of equal stiffness at one spread.
#[derive(Serialize, Deserialize)]
pub struct Stiffness {
    pub spread: f64,
    pub draws: u64,
    pub refused_at: [f64; 2],
    pub rms_error_of_pair: f64,
    pub largest_error_of_pair: f64,
    pub share_of_pairs_within_bar: f64,
}

/// One limb that has drifted.
#[derive(Serialize, Deserialize)]
pub struct Drift {
    pub limb: u64,
    pub change: f64,
    pub duration_s: f64,
    pub draws: u64,
    pub named_alone: f64,
    pub rms_error: f64,
    pub coverage_95: f64,
}

/// What a motion leaves open.
#[derive(Serialize, Deserialize)]
pub struct Motion {
    pub motion: String,
    pub open: Option<String>,
    pub directions: u64,
}

pub fn published() -> serde_json::Result<Published> {
    serde_json::from_str(RESULT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_published_self_calibration_is_whole() {
        let p = published().expect("props/results/self_calibration.json");
        assert!(!p.lengths.is_empty() && !p.stiffness.is_empty() && !p.motions.is_empty());
        for length in &p.lengths {
            assert!(length.refused < length.draws);
            for share in length.coverage_95_by_limb {
                assert!((0.0..=1.0).contains(&share));
            }
        }
        assert!(p.motions.iter().any(|m| m.open.is_none()));
    }
}
