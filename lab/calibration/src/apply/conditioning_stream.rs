//! What is done to voltages before they are decoupled, as streams: of the stages that condition a calibration's recordings
//! those that need no more than a bounded stretch of a recording, in the same order ([`Stage::ORDER`]).

#[cfg(test)]
mod tests;

use std::sync::{Arc, OnceLock};

use anyhow::{Context, Result, ensure};
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::dsp::causal::Causal;
use sixaxis_core::dsp::continued::ContinuedZeroPhase;
use sixaxis_core::dsp::delay::Delay;
use sixaxis_core::dsp::outlier::Hampel;
use sixaxis_core::dsp::{self, butterworth};
use sixaxis_core::{CrossTalk, LIMBS};

use super::Row;
use super::exclusions::Exclusions;
use super::voltages::Voltages;
use crate::conditioning::Stage;
use crate::conditioning::high_pass::{UndoneHighPass, longest_rest};
use sixaxis_recordings::session::Outliers;

/// Longest lag or lead, samples; a converter's channels are a few samples apart at most.
const LONGEST_LAG: f64 = 10_000.0;

/// Order of the low-pass, as a session's default.
pub const LOW_PASS_ORDER: usize = 4;

/// Periods of its corner after which the low-pass has forgotten a sample: its slowest pole is down to six millionths.
const REMEMBERED: f64 = 5.0;

/// What is to be done to the voltages of one recording.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConditioningConfig {
    /// Delay of each limb's channel against the clock, s.
    pub delays_s: Option<Row>,
    /// Wild samples are replaced.
    pub outliers: Option<Outliers>,
    /// Corner of the amplifiers' high-pass that is to be undone, Hz.
    pub amplifier_high_pass_hz: Option<f64>,
    /// What undoes the cross-talk.
    pub cross_talk: Option<CrossTalk>,
    /// Corner of a low-pass, Hz.
    pub low_pass_hz: Option<f64>,
    /// The low-pass runs forwards only, for live use: it delays.
    pub causal: bool,
}

impl ConditioningConfig {
    /// What comes before the low-pass, for a monitor: it holds single samples to the channels' noise, and a filter would spread a
    /// channel's failure over samples before and after it.
    pub fn unfiltered(&self) -> Self {
        Self {
            low_pass_hz: None,
            ..*self
        }
    }

    /// Samples on either side from which the low-pass makes one.
    pub fn reach(&self, sample_rate_hz: f64) -> u64 {
        self.low_pass_hz.map_or(0, |corner_hz| {
            (REMEMBERED * sample_rate_hz / corner_hz).ceil() as u64
        })
    }
}

/// The stages of nine channels, each in [`Stage::ORDER`], and what undoes their cross-talk after them.
pub struct ConditioningStream {
    channels: [Chain; LIMBS],
    cross_talk: Option<CrossTalk>,
    excluded: Exclusions,
    /// Corner of the high-pass that is undone, Hz, and samples per second.
    undone_hz: Option<[f64; 2]>,
    /// Whether the last stage is a low-pass.
    low_passes: bool,
    /// Samples handed out.
    samples: u64,
}

/// A channel that stays at its last value for as long as its limb is excluded: what a failed channel shows, which need not be
/// a number, is not to pass through a filter with a memory.
struct Held {
    limb: usize,
    excluded: Exclusions,
    sample: u64,
    last: f64,
}

impl dsp::stage::Stage for Held {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for value in samples {
            if !self.excluded.at(self.sample).contains(self.limb) {
                self.last = *value;
            }
            out.push(self.last);
            self.sample += 1;
        }
    }

    fn finish(&mut self, _: &mut Vec<f64>) -> sixaxis_core::Result<()> {
        Ok(())
    }
}

/// One channel's stages.
#[derive(Default)]
struct Chain {
    stages: Vec<Box<dyn dsp::stage::Stage + Send>>,
    /// Of an undone high-pass, once they are known.
    samples_of_level: Arc<OnceLock<usize>>,
    between: [Vec<f64>; 2],
    /// What has left the last stage. Channels with different delays are not equally far.
    ready: Vec<f64>,
}

impl Chain {
    /// Passes samples through the stages from the given one on.
    fn push(&mut self, first: usize, samples: &[f64]) {
        let [current, next] = &mut self.between;
        current.clear();
        current.extend_from_slice(samples);
        for stage in &mut self.stages[first..] {
            next.clear();
            stage.push(current, next);
            core::mem::swap(current, next);
        }
        self.ready.append(current);
    }

    fn finish(&mut self) -> sixaxis_core::Result<()> {
        for index in 0..self.stages.len() {
            let mut left = Vec::new();
            self.stages[index].finish(&mut left)?;
            self.push(index + 1, &left);
        }
        Ok(())
    }
}

/// Correlation, over the white variance, that the zero-phase low-pass leaves between a sample of noise and itself, its
/// neighbour and the one after it: that of the filter's response to a single sample.
///
/// # Errors
/// A corner that the sample rate does not allow.
pub fn noise_correlation(config: &ConditioningConfig, sample_rate_hz: f64) -> Result<[f64; 3]> {
    // Of the corner, after which nothing is left of an order-4 Butterworth.
    const PERIODS: f64 = 10.0;
    let Some(corner_hz) = config.low_pass_hz else {
        return Ok([1.0, 0.0, 0.0]);
    };
    let sections = low_pass(corner_hz, sample_rate_hz)?;
    let half = (PERIODS * sample_rate_hz / corner_hz) as usize + 100;
    let mut answer = vec![0.0; 2 * half + 1];
    answer[half] = 1.0;
    sixaxis_core::dsp::zero_phase::zero_phase(&sections, &mut answer)?;
    Ok(core::array::from_fn(|lag| {
        answer.iter().zip(&answer[lag..]).map(|(a, b)| a * b).sum()
    }))
}

fn low_pass(corner_hz: f64, sample_rate_hz: f64) -> Result<Vec<butterworth::Section>> {
    butterworth::low_pass(LOW_PASS_ORDER, corner_hz, sample_rate_hz)
        .map_err(|e| anyhow::anyhow!("--low-pass: {e}; the recording has {sample_rate_hz} Hz"))
}

/// One limb's stage as a stream, where it is asked for.
fn streaming(
    stage: Stage,
    limb: usize,
    config: &ConditioningConfig,
    sample_rate_hz: f64,
    samples_of_level: &mut Arc<OnceLock<usize>>,
) -> Result<Option<Box<dyn dsp::stage::Stage + Send>>> {
    Ok(match stage {
        Stage::Delays => match config.delays_s {
            Some(delays_s) => {
                let samples = delays_s[limb] * sample_rate_hz;
                ensure!(
                    (-LONGEST_LAG..=LONGEST_LAG).contains(&samples),
                    "limbs_lag_us: {samples} samples for limb {}; it can be up to {LONGEST_LAG} either way",
                    limb + 1
                );
                Some(Box::new(Delay::new(-samples)?))
            }
            None => None,
        },
        Stage::HighPass => match config.amplifier_high_pass_hz {
            Some(corner_hz) => Some(Box::new({
                let longest = longest_rest(sample_rate_hz);
                let undone = UndoneHighPass::new(corner_hz, sample_rate_hz, longest)
                    .context("the amplifier's high-pass")?;
                *samples_of_level = undone.samples_of_level();
                undone
            })),
            None => None,
        },
        Stage::LowPass => match config.low_pass_hz {
            Some(corner_hz) => {
                let sections = low_pass(corner_hz, sample_rate_hz)?;
                Some(if config.causal {
                    Box::new(Causal::new(sections))
                } else {
                    Box::new(ContinuedZeroPhase::new(&sections).context("--low-pass")?)
                })
            }
            None => None,
        },
        Stage::Outliers => match config.outliers {
            Some(test) => Some(Box::new(
                Hampel::new(test.half_width, test.sigmas).context("outliers")?,
            )),
            None => None,
        },
        // Known only when the run is over; `--rest-to-rest` takes it off.
        Stage::Trend => None,
        // A recording to be decoupled has no standards.
        Stage::AccelerometerLag | Stage::GyroscopeLag | Stage::Derivative => None,
    })
}

impl ConditioningStream {
    /// Prepares the stages.
    ///
    /// # Errors
    /// Corners that the sample rate does not allow, a delay of more than ten thousand samples.
    pub fn new(config: &ConditioningConfig, sample_rate_hz: f64) -> Result<Self> {
        let mut channels: [Chain; LIMBS] = Default::default();
        for (limb, chain) in channels.iter_mut().enumerate() {
            for stage in Stage::ORDER {
                let level = &mut chain.samples_of_level;
                let more = streaming(stage, limb, config, sample_rate_hz, level)?;
                chain.stages.extend(more);
            }
        }
        Ok(Self {
            channels,
            cross_talk: config.cross_talk,
            excluded: Exclusions::default(),
            undone_hz: (config.amplifier_high_pass_hz).map(|hz| [hz, sample_rate_hz]),
            low_passes: config.low_pass_hz.is_some(),
            samples: 0,
        })
    }

    /// How zeros wander where a high-pass is undone: known before the first sample comes out.
    #[must_use]
    pub fn zero_wander(&self) -> Option<ZeroWander> {
        let [corner_hz, sample_rate_hz] = self.undone_hz?;
        let mut samples = [0; LIMBS];
        for (samples, chain) in samples.iter_mut().zip(&self.channels) {
            *samples = *chain.samples_of_level.get()?;
        }
        ZeroWander::new(corner_hz, sample_rate_hz, &samples).ok()
    }

    /// Passes nothing through the low-pass that a channel shows while its limb is excluded.
    #[must_use]
    pub fn holding(mut self, excluded: &Exclusions) -> Self {
        if self.low_passes {
            for limb in excluded.ever().indices() {
                let stages = &mut self.channels[limb].stages;
                let held = Held {
                    limb,
                    excluded: excluded.clone(),
                    sample: 0,
                    last: 0.0,
                };
                stages.insert(stages.len() - 1, Box::new(held));
            }
        }
        self
    }

    /// Takes nothing that some channels show for cross-talk of the others.
    #[must_use]
    pub fn excluding(mut self, limbs: Exclusions) -> Self {
        self.excluded = limbs;
        self
    }

    /// Leaves cross-talk to whoever watches for channels that fail.
    #[must_use]
    pub fn without_cross_talk(mut self) -> Self {
        self.cross_talk = None;
        self
    }

    /// Takes all samples out of `voltage_v` and appends those that are ready to `out`.
    pub fn push(&mut self, voltage_v: &mut Voltages, out: &mut Voltages) {
        if self.channels.iter().all(|chain| chain.stages.is_empty()) {
            let before = out.samples();
            out.append(voltage_v);
            self.undo_cross_talk(out, before);
            return;
        }
        for (chain, column) in self.channels.iter_mut().zip(&voltage_v.columns) {
            chain.push(0, column);
        }
        voltage_v.clear();
        self.hand_out(out);
    }

    /// Appends what is left when no more samples come.
    ///
    /// # Errors
    /// A record too short for the low-pass.
    pub fn finish(&mut self, out: &mut Voltages) -> Result<()> {
        for chain in &mut self.channels {
            chain.finish().context("--low-pass")?;
        }
        self.hand_out(out);
        Ok(())
    }

    /// Samples of which all nine channels are ready.
    fn hand_out(&mut self, out: &mut Voltages) {
        let samples = self
            .channels
            .iter()
            .map(|c| c.ready.len())
            .min()
            .unwrap_or(0);
        let before = out.samples();
        for (column, chain) in out.columns.iter_mut().zip(&mut self.channels) {
            column.extend(chain.ready.drain(..samples));
        }
        self.undo_cross_talk(out, before);
    }

    fn undo_cross_talk(&mut self, voltage_v: &mut Voltages, from: usize) {
        let first = self.samples;
        self.samples += (voltage_v.samples() - from) as u64;
        let Some(cross_talk) = &self.cross_talk else {
            return;
        };
        for sample in from..voltage_v.samples() {
            let excluded = self.excluded.at(first + (sample - from) as u64);
            let row = cross_talk.undo_without(&voltage_v.row(sample), excluded);
            for (column, undone) in voltage_v.columns.iter_mut().zip(row) {
                column[sample] = undone;
            }
        }
    }
}

/// Delay of the causal low-pass well below its corner, s.
pub fn causal_delay_s(corner_hz: f64) -> f64 {
    // Sum over the poles of a Butterworth filter of order 4: 1/tan and so on come to 2.6131 over the corner's frequency.
    2.613_125_929_752_753 / (core::f64::consts::TAU * corner_hz)
}
