//! `props/results/failed_limbs.json`: every set of up to three failed limbs.

use serde::{Deserialize, Serialize};

const FAILED_LIMBS: &str = include_str!("../../../../props/results/failed_limbs.json");

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
