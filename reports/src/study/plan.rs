//! What the study plays, in full and quick.

use serde::Serialize;

/// Sample rate of the campaign's recordings, Hz.
pub const CAMPAIGN_RATE_HZ: f64 = 10_000.0;
/// Steps per sample of the campaign: 25 us, and doubled for the reference's own error.
pub const CAMPAIGN_STEPS: usize = 4;
/// Sample rate at which compound runs are simulated, Hz: the highest of the order study.
pub const COMPOUND_RATE_HZ: f64 = 20_000.0;
/// Steps per sample of the compound runs: 25 us; halved for the reference's own error.
pub const COMPOUND_STEPS: usize = 2;
/// Step of the threshold sweeps, s: stable for the stiffest mode of the design, 6.7 kHz.
pub const SWEEP_STEP_S: f64 = 5e-5;

/// How much is played.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Plan {
    /// Seed of the laboratory's errors.
    pub seed: u64,
    /// Fewer runs, for a look.
    pub quick: bool,
}

impl Plan {
    /// Trials per identification step: the paper's ten.
    pub fn trials_per_step(&self) -> usize {
        if self.quick { 3 } else { 10 }
    }

    /// Frequencies of the threshold sweeps, Hz.
    pub fn sweep_frequencies_hz(&self) -> Vec<f64> {
        if self.quick {
            vec![1.9, 2.7, 4.0]
        } else {
            vec![
                0.4, 0.6, 0.9, 1.3, 1.6, 2.0, 2.2, 2.4, 2.6, 3.0, 3.5, 4.0, 5.0,
            ]
        }
    }

    /// Sample rates of the order study as divisors of [`COMPOUND_RATE_HZ`]: 250 Hz to 20 kHz.
    pub fn order_divisors(&self) -> Vec<usize> {
        vec![80, 50, 40, 20, 10, 5, 4, 2, 1]
    }

    /// Steps per sample of the campaign; quick takes the coarser ones that otherwise serve as the check.
    pub fn campaign_steps(&self) -> usize {
        if self.quick {
            CAMPAIGN_STEPS / 2
        } else {
            CAMPAIGN_STEPS
        }
    }

    /// Every how many samples of the 4 to 5 Hz runs the curves of Fig. 10 are computed from: 2 kHz, quick 1 kHz, is ample,
    /// and the minimum stays on the same grid point as at 10 kHz.
    pub fn search_stride(&self) -> usize {
        if self.quick { 10 } else { 5 }
    }

    /// Sizes of error a decade in the study of what step 4 tolerates.
    pub fn tolerance_sizes_per_decade(&self) -> i32 {
        if self.quick { 1 } else { 4 }
    }

    /// Random draws at each size; odd, so that the median is one of them.
    pub fn tolerance_draws(&self) -> usize {
        if self.quick { 5 } else { 25 }
    }

    /// Random six-axis motions that are simulated and decoupled beside the rig's.
    pub fn random_motions(&self) -> u64 {
        if self.quick { 2 } else { 8 }
    }

    /// Whether the simulations that only serve the reference's own error of the identification are played.
    pub fn checks_campaign_step(&self) -> bool {
        !self.quick
    }
}
