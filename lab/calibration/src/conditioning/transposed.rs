//! The transpose of conditioning: what each raw sample weighs in a weighted sum over the conditioned ones.
//!
//! All stages but the rejection of outliers are linear, and each has its transpose in `core::dsp::transposed`; here they run in
//! the opposite order. Rejection replaces a sample in thousands and is passed over.

use sixaxis_core::Result;
use sixaxis_core::dsp::transposed;

use super::{Conditioning, Stage};
use crate::trial::Trial;

/// A channel by what it measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    Limb,
    Accelerometer,
    Gyroscope,
}

/// Adds `share` of a mean over the first samples.
fn add_mean(weights: &mut [f64], samples: usize, share: f64) {
    let samples = samples.clamp(1, weights.len().max(1));
    for w in weights.iter_mut().take(samples) {
        *w += share / samples as f64;
    }
}

impl Conditioning {
    /// From weights of one limb's conditioned voltages to weights of its raw ones, in place.
    ///
    /// # Errors
    /// Those of [`Conditioning::condition`].
    pub fn voltage_transposed(&self, trial: &Trial, weights: &mut Vec<f64>) -> Result<()> {
        self.back(Channel::Limb, trial, weights)
    }

    /// The same of the standard accelerometer.
    ///
    /// # Errors
    /// Those of [`Conditioning::condition`].
    pub fn accelerometer_transposed(&self, trial: &Trial, weights: &mut Vec<f64>) -> Result<()> {
        self.back(Channel::Accelerometer, trial, weights)
    }

    /// The same of the standard gyroscope, from weights of the conditioned rate and of its derivative.
    ///
    /// # Errors
    /// Those of [`Conditioning::condition`].
    pub fn gyroscope_transposed(
        &self,
        trial: &Trial,
        of_rate: &[f64],
        of_derivative: &[f64],
    ) -> Result<Vec<f64>> {
        let mut weights = transposed::derivative(&self.differentiator(trial)?, of_derivative)?;
        for (w, rate) in weights.iter_mut().zip(of_rate) {
            *w += rate;
        }
        self.back(Channel::Gyroscope, trial, &mut weights)?;
        Ok(weights)
    }

    fn back(&self, channel: Channel, trial: &Trial, weights: &mut Vec<f64>) -> Result<()> {
        for stage in Stage::ORDER.into_iter().rev() {
            self.run_transposed(stage, channel, trial, weights)?;
        }
        Ok(())
    }

    fn run_transposed(
        &self,
        stage: Stage,
        channel: Channel,
        trial: &Trial,
        weights: &mut Vec<f64>,
    ) -> Result<()> {
        let lag = match (stage, channel) {
            (Stage::AccelerometerLag, Channel::Accelerometer) => {
                self.undone_accelerometer_hz(trial)
            }
            (Stage::GyroscopeLag, Channel::Gyroscope) => self.gyroscope_bandwidth_hz,
            _ => None,
        };
        if let Some(bandwidth_hz) = lag {
            let differentiator = self.differentiator(trial)?;
            *weights = transposed::undo_low_pass(weights, bandwidth_hz, &differentiator)?;
        }
        match stage {
            Stage::LowPass => {
                if let Some(sections) = self.sections(trial)? {
                    transposed::continued_zero_phase(&sections, weights)?;
                }
            }
            Stage::Trend => {
                if let Some(rest) = self.rest_samples(trial) {
                    let level: f64 = weights.iter().sum();
                    transposed::rest_to_rest_trend(weights, rest)?;
                    if channel == Channel::Limb {
                        add_mean(weights, rest, level);
                    }
                }
            }
            Stage::HighPass => {
                if let Some(corner_hz) = self.stages.amplifier_high_pass_hz
                    && channel == Channel::Limb
                {
                    let level: f64 = weights.iter().sum();
                    *weights =
                        transposed::undo_high_pass(weights, corner_hz, trial.sample_rate_hz)?;
                    let undone: f64 = weights.iter().sum();
                    add_mean(weights, self.level_samples(trial), level - undone);
                }
            }
            Stage::Delays
            | Stage::Outliers
            | Stage::AccelerometerLag
            | Stage::GyroscopeLag
            | Stage::Derivative => {}
        }
        Ok(())
    }
}
