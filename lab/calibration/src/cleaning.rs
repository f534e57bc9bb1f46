//! The preprocessing that a session asks for, stage by stage, on one trial.

mod transposed;

use glam::DVec3;
use sixaxis_core::dsp::butterworth::{self, Section};
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{undo_high_pass, undo_low_pass};
use sixaxis_core::dsp::zero_phase::zero_phase;
use sixaxis_core::dsp::{detrend, each_channel, outlier};
use sixaxis_core::{LIMBS, Result};

use crate::trial::Trial;
use sixaxis_recordings::session::{Preprocessing, Session};

/// Highest corner of the low-pass, of the sample rate: at half of it there is no filter.
const HIGHEST_CORNER: f64 = 0.4;

/// What is done to a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaning {
    /// The stages.
    pub stages: Preprocessing,
    /// Bandwidth of the accelerometer, Hz, if its lag is to be undone.
    pub accelerometer_bandwidth_hz: Option<f64>,
    /// Bandwidth of the gyroscope, Hz, if its lag is to be undone.
    pub gyroscope_bandwidth_hz: Option<f64>,
}

/// A trial ready for identification and decoupling.
#[derive(Debug, Clone, PartialEq)]
pub struct Cleaned {
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard linear acceleration, ground axes, m/s^2.
    pub linear_ground_m_s2: Vec<DVec3>,
    /// Standard rate, shell axes, rad/s.
    pub rate_shell_rad_s: Vec<DVec3>,
    /// Its derivative, rad/s^2.
    pub angular_shell_rad_s2: Vec<DVec3>,
    /// Samples that the outlier test replaced, over all channels.
    pub outliers: usize,
}

/// Samples that the baseline of a high-passed channel is taken from: at rest in any run that begins at rest.
const BASELINE: usize = 16;

fn mean(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len().max(1) as f64
}

impl Cleaning {
    /// What a session asks for.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self {
            stages: session.preprocessing.clone(),
            accelerometer_bandwidth_hz: session.accelerometer.bandwidth_hz,
            gyroscope_bandwidth_hz: session.gyroscope.bandwidth_hz,
        }
    }

    /// Corner of the low-pass for a trial, Hz.
    #[must_use]
    pub fn corner_hz(&self, trial: &Trial) -> Option<f64> {
        let low_pass = self.stages.low_pass.settings()?;
        // A recording that is sampled slowly has little to lose up there.
        let highest_hz = HIGHEST_CORNER * trial.sample_rate_hz;
        Some((low_pass.times_drive * trial.frequency_hz + low_pass.plus_hz).min(highest_hz))
    }

    fn sections(&self, trial: &Trial) -> Result<Option<Vec<Section>>> {
        match (self.stages.low_pass.settings(), self.corner_hz(trial)) {
            (Some(low_pass), Some(corner_hz)) => {
                butterworth::low_pass(low_pass.order, corner_hz, trial.sample_rate_hz).map(Some)
            }
            _ => Ok(None),
        }
    }

    fn rest_samples(&self, trial: &Trial) -> Option<usize> {
        self.stages
            .detrend
            .settings()
            .map(|line| ((line.rest_s * trial.sample_rate_hz) as usize).max(1))
    }

    fn differentiator(&self, trial: &Trial) -> Result<Differentiator> {
        let settings = self.stages.differentiator;
        Differentiator::new(settings.half_width, settings.order, trial.sample_rate_hz)
    }

    /// Bandwidth of an accelerometer whose lag is to be undone and can be seen at this sample rate, Hz.
    fn undone_accelerometer_hz(&self, trial: &Trial) -> Option<f64> {
        self.accelerometer_bandwidth_hz
            .filter(|bandwidth_hz| *bandwidth_hz < 0.5 * trial.sample_rate_hz)
    }

    /// Cleans one trial. Everything passes through the same filters, so that what little they take off is the same on both
    /// sides of every equation.
    ///
    /// # Errors
    /// Those of the stages: a trial too short for one, a sample that is not finite, settings that cannot be.
    pub fn clean(&self, trial: &Trial) -> Result<Cleaned> {
        let sections = self.sections(trial)?;
        let mut outliers = 0;
        let mut rejected = |series: &mut [f64]| -> Result<()> {
            if let Some(test) = self.stages.outliers.settings() {
                outliers += outlier::hampel(series, test.half_width, test.sigmas)?.len();
            }
            Ok(())
        };
        let mut voltage_v = trial.voltage_v.clone();
        each_channel(&mut voltage_v, &mut rejected)?;
        let mut acceleration = trial.accelerometer_m_s2.clone();
        rejected(&mut acceleration)?;
        let mut rate = trial.gyroscope_rad_s.clone();
        rejected(&mut rate)?;
        if let Some(corner_hz) = self.stages.amplifier_high_pass_hz {
            each_channel(&mut voltage_v, |series| {
                // A sum over the whole run follows: what the baseline is off by grows with time.
                let rest = mean(&series[..BASELINE.min(series.len())]);
                let change: Vec<f64> = series.iter().map(|u| u - rest).collect();
                for (x, undone) in
                    series
                        .iter_mut()
                        .zip(undo_high_pass(&change, corner_hz, trial.sample_rate_hz)?)
                {
                    *x = undone + rest;
                }
                Ok(())
            })?;
        }
        let rest = self.rest_samples(trial);
        let filtered = |series: &mut [f64]| -> Result<()> {
            match &sections {
                Some(sections) => zero_phase(sections, series),
                None => Ok(()),
            }
        };
        each_channel(&mut voltage_v, |series| {
            if let Some(rest) = rest {
                // The drift of step 1 is taken off later; here only the change since the first rest.
                let level = mean(&series[..rest.min(series.len())]);
                detrend::rest_to_rest_trend(series, rest)?;
                series.iter_mut().for_each(|x| *x += level);
            }
            filtered(series)
        })?;
        for series in [&mut acceleration, &mut rate] {
            if let Some(rest) = rest {
                // A standard that shows something at rest shows its own offset.
                detrend::rest_to_rest_trend(series, rest)?;
            }
            filtered(series)?;
        }
        let differentiator = self.differentiator(trial)?;
        if let Some(bandwidth_hz) = self.undone_accelerometer_hz(trial) {
            acceleration = undo_low_pass(&acceleration, bandwidth_hz, &differentiator)?;
        }
        if let Some(bandwidth_hz) = self.gyroscope_bandwidth_hz {
            rate = undo_low_pass(&rate, bandwidth_hz, &differentiator)?;
        }
        let slope = differentiator.derivative(&rate)?;
        let direction = trial.direction_ground;
        let along = |series: Vec<f64>| series.into_iter().map(|x| direction * x).collect();
        Ok(Cleaned {
            voltage_v,
            linear_ground_m_s2: along(acceleration),
            // The pinion turns about a direction that is the same in ground and shell axes.
            rate_shell_rad_s: along(rate),
            angular_shell_rad_s2: along(slope),
            outliers,
        })
    }
}
