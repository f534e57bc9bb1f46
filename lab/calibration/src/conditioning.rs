//! Conditioning of a whole recording: what the session asks to be done to it before anything is computed from it.
//!
//! [`stage`] has the stages and their order, [`high_pass`] the one that neither `core` nor a library has.

pub mod high_pass;
pub mod stage;
mod transposed;

use glam::DVec3;
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::dsp::butterworth::{self, Section};
use sixaxis_core::dsp::continued::zero_phase;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{UndoHighPass, undo_low_pass};
use sixaxis_core::dsp::{detrend, each_channel, outlier, stage::whole};
use sixaxis_core::{LIMBS, Result};

pub use stage::Stage;

use crate::trial::Trial;
use sixaxis_recordings::session::{Preprocessing, Session};

/// Highest corner of the low-pass over the sample rate; at half the sample rate the filter does not exist.
const HIGHEST_CORNER: f64 = 0.4;

/// What is done to a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditioning {
    /// The stages.
    pub stages: Preprocessing,
    /// Bandwidth of the accelerometer, Hz, if its lag is to be undone.
    pub accelerometer_bandwidth_hz: Option<f64>,
    /// Bandwidth of the gyroscope, Hz, if its lag is to be undone.
    pub gyroscope_bandwidth_hz: Option<f64>,
    /// Samples at rest whose mean is the level of an undone high-pass; those that a trial begins with where it is not stated.
    pub level_samples: Option<usize>,
}

/// A trial ready for identification and decoupling.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditioned {
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
    /// By how much noise moves each zero until the end where a high-pass is undone, standard deviations, V; 0 where none is.
    pub zero_wander_v: [f64; LIMBS],
}

fn mean(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len().max(1) as f64
}

impl Conditioning {
    /// What a session asks for.
    pub fn of(session: &Session) -> Self {
        Self {
            stages: session.preprocessing.clone(),
            accelerometer_bandwidth_hz: session.accelerometer.bandwidth_hz,
            gyroscope_bandwidth_hz: session.gyroscope.bandwidth_hz,
            level_samples: None,
        }
    }

    /// Corner of the low-pass for a trial, Hz.
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

    /// Samples of rest that a trial begins with, whose mean is the level about which an amplifier's high-pass is undone: of the channel that moves
    /// first, so that one transpose serves all.
    pub(crate) fn level_samples(&self, trial: &Trial) -> usize {
        if let Some(samples) = self.level_samples {
            return samples;
        }
        let longest = high_pass::longest_rest(trial.sample_rate_hz);
        let of = |limb: usize| trial.voltage_v.iter().map(move |row| row[limb]);
        let rests = (0..LIMBS).map(|limb| high_pass::at_rest(of(limb), longest));
        rests.min().unwrap_or(0)
    }

    /// What takes the rate's derivative of a trial.
    pub(crate) fn differentiator(&self, trial: &Trial) -> Result<Differentiator> {
        let settings = self.stages.differentiator;
        Differentiator::new(settings.half_width, settings.order, trial.sample_rate_hz)
    }

    /// Bandwidth of an accelerometer whose lag is to be undone and can be seen at this sample rate, Hz.
    fn undone_accelerometer_hz(&self, trial: &Trial) -> Option<f64> {
        self.accelerometer_bandwidth_hz
            .filter(|bandwidth_hz| *bandwidth_hz < 0.5 * trial.sample_rate_hz)
    }

    /// Whether the session has a stage on. Delays are the reader's, who has the channels' names; the derivative is always taken.
    pub fn has(&self, stage: Stage) -> bool {
        match stage {
            Stage::Delays => false,
            Stage::Outliers => self.stages.outliers.settings().is_some(),
            Stage::HighPass => self.stages.amplifier_high_pass_hz.is_some(),
            Stage::Trend => self.stages.detrend.settings().is_some(),
            Stage::LowPass => self.stages.low_pass.settings().is_some(),
            Stage::AccelerometerLag => self.accelerometer_bandwidth_hz.is_some(),
            Stage::GyroscopeLag => self.gyroscope_bandwidth_hz.is_some(),
            Stage::Derivative => true,
        }
    }

    /// Runs one stage over the channels of a trial, which the stages before it in [`Stage::ORDER`] have passed; nothing where
    /// the session has it off. [`Stage::Delays`] was run when the trial was read, [`Stage::Derivative`] changes no channel.
    ///
    /// # Errors
    /// As [`Self::condition`].
    pub fn run(&self, stage: Stage, trial: &Trial, channels: &mut Channels) -> Result<()> {
        let Channels {
            voltage_v,
            accelerometer_m_s2,
            gyroscope_rad_s,
            outliers,
        } = channels;
        match stage {
            Stage::Delays | Stage::Derivative => {}
            Stage::Outliers => {
                let Some(test) = self.stages.outliers.settings() else {
                    return Ok(());
                };
                let mut replace = |series: &mut [f64]| -> Result<()> {
                    *outliers += outlier::hampel(series, test.half_width, test.sigmas)?.len();
                    Ok(())
                };
                each_channel(voltage_v, &mut replace)?;
                replace(accelerometer_m_s2)?;
                replace(gyroscope_rad_s)?;
            }
            Stage::HighPass => {
                let Some(corner_hz) = self.stages.amplifier_high_pass_hz else {
                    return Ok(());
                };
                let rest = self.level_samples(trial);
                each_channel(voltage_v, |series| {
                    let level = mean(&series[..rest.min(series.len())]);
                    series.iter_mut().for_each(|x| *x -= level);
                    let mut undo = UndoHighPass::new(corner_hz, trial.sample_rate_hz)?;
                    whole("undone high-pass", &mut undo, series)?;
                    series.iter_mut().for_each(|x| *x += level);
                    Ok(())
                })?;
            }
            Stage::Trend => {
                let Some(rest) = self.rest_samples(trial) else {
                    return Ok(());
                };
                each_channel(voltage_v, |series| {
                    // The drift of step 1 is taken off later; here only the change since the first rest.
                    let level = mean(&series[..rest.min(series.len())]);
                    detrend::rest_to_rest_trend(series, rest)?;
                    series.iter_mut().for_each(|x| *x += level);
                    Ok(())
                })?;
                // A standard that shows something at rest shows its own offset.
                detrend::rest_to_rest_trend(accelerometer_m_s2, rest)?;
                detrend::rest_to_rest_trend(gyroscope_rad_s, rest)?;
            }
            Stage::LowPass => {
                let Some(sections) = self.sections(trial)? else {
                    return Ok(());
                };
                each_channel(voltage_v, |series| zero_phase(&sections, series))?;
                zero_phase(&sections, accelerometer_m_s2)?;
                zero_phase(&sections, gyroscope_rad_s)?;
            }
            Stage::AccelerometerLag => {
                if let Some(bandwidth_hz) = self.undone_accelerometer_hz(trial) {
                    let differentiator = self.differentiator(trial)?;
                    *accelerometer_m_s2 =
                        undo_low_pass(accelerometer_m_s2, bandwidth_hz, &differentiator)?;
                }
            }
            Stage::GyroscopeLag => {
                if let Some(bandwidth_hz) = self.gyroscope_bandwidth_hz {
                    let differentiator = self.differentiator(trial)?;
                    *gyroscope_rad_s =
                        undo_low_pass(gyroscope_rad_s, bandwidth_hz, &differentiator)?;
                }
            }
        }
        Ok(())
    }

    /// Conditions one trial: all stages that the session has on, in [`Stage::ORDER`].
    ///
    /// # Errors
    /// Those of the stages: a trial too short for one, a sample that is not finite, settings that cannot be.
    pub fn condition(&self, trial: &Trial) -> Result<Conditioned> {
        let mut channels = Channels::of(trial);
        for stage in Stage::ORDER {
            self.run(stage, trial, &mut channels)?;
        }
        let slope = self
            .differentiator(trial)?
            .derivative(&channels.gyroscope_rad_s)?;
        let direction = trial.direction_ground;
        let along = |series: Vec<f64>| series.into_iter().map(|x| direction * x).collect();
        Ok(Conditioned {
            voltage_v: channels.voltage_v,
            linear_ground_m_s2: along(channels.accelerometer_m_s2),
            // The pinion turns about a direction that is the same in ground and shell axes.
            rate_shell_rad_s: along(channels.gyroscope_rad_s),
            angular_shell_rad_s2: along(slope),
            outliers: channels.outliers,
            zero_wander_v: self.zero_wander_v(trial)?,
        })
    }

    fn zero_wander_v(&self, trial: &Trial) -> Result<[f64; LIMBS]> {
        let Some(corner_hz) = self.stages.amplifier_high_pass_hz else {
            return Ok([0.0; LIMBS]);
        };
        let mut white_v = [0.0; LIMBS];
        for (limb, white_v) in white_v.iter_mut().enumerate() {
            *white_v = trial.noise_v(limb)?;
        }
        let (rate_hz, levels) = (trial.sample_rate_hz, [self.level_samples(trial); LIMBS]);
        let wander = ZeroWander::new(corner_hz, rate_hz, &levels)?;
        let at_end = wander.variances(trial.voltage_v.len() as u64);
        Ok(core::array::from_fn(|limb| {
            white_v[limb] * at_end[limb].sqrt()
        }))
    }
}

/// The channels of a trial on their way through the stages.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard accelerometer along the travel, m/s^2.
    pub accelerometer_m_s2: Vec<f64>,
    /// Standard gyroscope about the pinion's axis, rad/s.
    pub gyroscope_rad_s: Vec<f64>,
    /// Samples replaced so far, over all channels.
    pub outliers: usize,
}

impl Channels {
    /// As recorded.
    pub fn of(trial: &Trial) -> Self {
        Self {
            voltage_v: trial.voltage_v.clone(),
            accelerometer_m_s2: trial.accelerometer_m_s2.clone(),
            gyroscope_rad_s: trial.gyroscope_rad_s.clone(),
            outliers: 0,
        }
    }
}
