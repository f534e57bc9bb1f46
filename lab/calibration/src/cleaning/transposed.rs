//! The cleaning read backwards: what each raw sample weighs in a sum over the cleaned ones.
//!
//! All stages but the rejection of wild samples are linear, and each has its transpose in `core::dsp::transposed`;
//! here they follow each other in the opposite order. Rejection replaces a sample in thousands and is passed over.

use sixaxis_core::Result;
use sixaxis_core::dsp::transposed;

use super::{BASELINE, Cleaning};
use crate::trial::Trial;

/// Adds `share` of a mean over the first samples.
fn add_mean(weights: &mut [f64], samples: usize, share: f64) {
    let samples = samples.clamp(1, weights.len().max(1));
    for w in weights.iter_mut().take(samples) {
        *w += share / samples as f64;
    }
}

impl Cleaning {
    /// From weights of one channel's cleaned voltages to weights of its raw ones, in place.
    ///
    /// # Errors
    /// Those of [`Cleaning::clean`].
    pub fn voltage_transposed(&self, trial: &Trial, weights: &mut Vec<f64>) -> Result<()> {
        self.filter_transposed(trial, weights)?;
        if let Some(rest) = self.rest_samples(trial) {
            let level: f64 = weights.iter().sum();
            transposed::rest_to_rest_trend(weights, rest)?;
            add_mean(weights, rest, level);
        }
        if let Some(corner_hz) = self.stages.amplifier_high_pass_hz {
            let level: f64 = weights.iter().sum();
            *weights = transposed::undo_high_pass(weights, corner_hz, trial.sample_rate_hz)?;
            let undone: f64 = weights.iter().sum();
            add_mean(weights, BASELINE, level - undone);
        }
        Ok(())
    }

    /// The same of the standard accelerometer.
    ///
    /// # Errors
    /// Those of [`Cleaning::clean`].
    pub fn accelerometer_transposed(&self, trial: &Trial, weights: &mut Vec<f64>) -> Result<()> {
        if let Some(bandwidth_hz) = self.undone_accelerometer_hz(trial) {
            let differentiator = self.differentiator(trial)?;
            *weights = transposed::undo_low_pass(weights, bandwidth_hz, &differentiator)?;
        }
        self.standard_transposed(trial, weights)
    }

    /// The same of the standard gyroscope, from weights of the cleaned rate and of its derivative.
    ///
    /// # Errors
    /// Those of [`Cleaning::clean`].
    pub fn gyroscope_transposed(
        &self,
        trial: &Trial,
        of_rate: &[f64],
        of_derivative: &[f64],
    ) -> Result<Vec<f64>> {
        let differentiator = self.differentiator(trial)?;
        let mut weights = transposed::derivative(&differentiator, of_derivative)?;
        for (w, rate) in weights.iter_mut().zip(of_rate) {
            *w += rate;
        }
        if let Some(bandwidth_hz) = self.gyroscope_bandwidth_hz {
            weights = transposed::undo_low_pass(&weights, bandwidth_hz, &differentiator)?;
        }
        self.standard_transposed(trial, &mut weights)?;
        Ok(weights)
    }

    fn standard_transposed(&self, trial: &Trial, weights: &mut [f64]) -> Result<()> {
        self.filter_transposed(trial, weights)?;
        match self.rest_samples(trial) {
            Some(rest) => transposed::rest_to_rest_trend(weights, rest),
            None => Ok(()),
        }
    }

    fn filter_transposed(&self, trial: &Trial, weights: &mut [f64]) -> Result<()> {
        match self.sections(trial)? {
            Some(sections) => transposed::zero_phase(&sections, weights),
            None => Ok(()),
        }
    }
}
