//! `props/results/detection.json` and `props/results/dying_limb.json`, embedded, with the commands that make them anew.

use serde::{Deserialize, Serialize};

const DETECTION: &str = include_str!("../../../../props/results/detection.json");
const DYING_LIMB: &str = include_str!("../../../../props/results/dying_limb.json");

/// Failed limbs by the thousand.
#[derive(Serialize, Deserialize)]
pub struct Detection {
    pub first_seed: u64,
    pub sample_rate_hz: f64,
    pub false_alarms_per_hour: f64,
    pub within_samples: Vec<u64>,
    pub false_alarms: Vec<FalseAlarms>,
    pub kinds: Vec<Kind>,
    pub class_sigmas: f64,
    pub classes: Vec<Class>,
    pub curves: Vec<Curve>,
}

#[derive(Serialize, Deserialize)]
pub struct FalseAlarms {
    pub rate_per_sample: f64,
    pub unequal: f64,
    pub samples: u64,
    pub alarms: u64,
}

#[derive(Serialize, Deserialize)]
pub struct Kind {
    pub kind: String,
    pub sigmas: Option<f64>,
    pub trials: u64,
    pub detected_within: Vec<f64>,
    pub isolated: Counts,
    pub isolated_after: [u64; 2],
    pub named: Counts,
    pub twins: Counts,
}

#[derive(Serialize, Deserialize, Clone, Copy)]
pub struct Counts {
    pub right: u64,
    pub wrong: u64,
    pub open: u64,
}

impl Counts {
    pub fn all(self) -> u64 {
        self.right + self.wrong + self.open
    }
}

#[derive(Serialize, Deserialize)]
pub struct Class {
    pub limbs: Vec<u64>,
    pub isolated: Counts,
    pub isolated_after: [u64; 2],
}

#[derive(Serialize, Deserialize)]
pub struct Curve {
    pub window: u64,
    pub limb: u64,
    pub sigmas: f64,
    pub draws: u64,
    pub false_alarm: Vec<f64>,
    pub detected: Vec<f64>,
    pub theory: Vec<f64>,
}

/// A limb that dies in mid-motion.
#[derive(Serialize, Deserialize)]
pub struct DyingLimb {
    pub sample_rate_hz: f64,
    pub limb: u64,
    pub died_at_s: f64,
    pub isolated_after_samples: u64,
    pub switched_after_samples: u64,
    pub verdict: String,
    pub threshold: f64,
    pub time_s: Vec<f64>,
    /// Largest whitened row squared of each stretch of samples.
    pub statistic: Vec<f64>,
    /// Along x, ground axes, m/s^2: truth, with all nine, and with the limb given up.
    pub truth_m_s2: Vec<f64>,
    pub nine_m_s2: Vec<f64>,
    pub watched_m_s2: Vec<f64>,
    /// Rotation from the truth, rad: the sensor that never failed, all nine, the limb given up.
    pub never_failed_rad: Vec<f64>,
    pub nine_rad: Vec<f64>,
    pub watched_rad: Vec<f64>,
}

pub fn detection() -> serde_json::Result<Detection> {
    serde_json::from_str(DETECTION)
}

pub fn dying_limb() -> serde_json::Result<DyingLimb> {
    serde_json::from_str(DYING_LIMB)
}
