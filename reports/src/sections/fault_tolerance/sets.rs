//! `props/results/failed_limbs.json`: every set of up to three failed limbs.

use serde::{Deserialize, Serialize};

const FAILED_LIMBS: &str = include_str!("../../../../props/results/failed_limbs.json");

#[derive(Serialize, Deserialize)]
pub struct FailedLimbs {
    pub seeds: u64,
    pub noise_samples: u64,
    pub survivable: usize,
    pub within_twice: usize,
    pub within_twice_consistent: usize,
    pub within_twice_rms: usize,
    pub within_twice_rms_consistent: usize,
    pub largest_noise_free_excess: f64,
    pub healthy_largest_error: Vec<f64>,
    pub sets: Vec<Set>,
}

#[derive(Serialize, Deserialize)]
pub struct Set {
    pub failed: Vec<usize>,
    pub lost: Option<String>,
    pub amplification: Option<[f64; 6]>,
    pub amplification_measured: Option<[f64; 6]>,
    pub error_ratio: Option<f64>,
    pub error_ratio_consistent: Option<f64>,
}

impl Set {
    /// Of the six, the one that grows most.
    pub fn largest(&self) -> Option<f64> {
        let of = |six: [f64; 6]| six.into_iter().fold(0.0, f64::max);
        self.amplification.map(of)
    }

    /// "1, 6, 9".
    pub fn name(&self) -> String {
        let numbers: Vec<String> = self.failed.iter().map(usize::to_string).collect();
        numbers.join(", ")
    }
}

impl FailedLimbs {
    /// The set with exactly these limbs, ascending.
    pub fn set(&self, failed: &[usize]) -> Option<&Set> {
        self.sets.iter().find(|set| set.failed == failed)
    }
}

pub fn failed_limbs() -> serde_json::Result<FailedLimbs> {
    serde_json::from_str(FAILED_LIMBS)
}
