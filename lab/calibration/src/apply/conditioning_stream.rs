//! What is done to voltages before they are decoupled, as streams: of the stages that condition a calibration's recordings
//! those that need no more than a bounded stretch of a recording, in the same order ([`Stage::ORDER`]).

use anyhow::{Context, Result, ensure};
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
use crate::conditioning::high_pass::UndoneHighPass;
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
    #[must_use]
    pub fn unfiltered(&self) -> Self {
        Self {
            low_pass_hz: None,
            ..*self
        }
    }

    /// Samples on either side from which the low-pass makes one.
    #[must_use]
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
            Some(corner_hz) => Some(Box::new(
                UndoneHighPass::new(corner_hz, sample_rate_hz)
                    .context("the amplifier's high-pass")?,
            )),
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
                chain
                    .stages
                    .extend(streaming(stage, limb, config, sample_rate_hz)?);
            }
        }
        Ok(Self {
            channels,
            cross_talk: config.cross_talk,
            excluded: Exclusions::default(),
            low_passes: config.low_pass_hz.is_some(),
            samples: 0,
        })
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
#[must_use]
pub fn causal_delay_s(corner_hz: f64) -> f64 {
    // Sum over the poles of a Butterworth filter of order 4: 1/tan and so on come to 2.6131 over the corner's frequency.
    2.613_125_929_752_753 / (core::f64::consts::TAU * corner_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_core::LimbSet;
    use sixaxis_core::dsp::delay::delayed;
    use sixaxis_core::dsp::lag::undo_high_pass;

    const RATE_HZ: f64 = 2000.0;

    fn rows(samples: u32) -> Vec<Row> {
        (0..samples)
            .map(|k| {
                core::array::from_fn(|limb| {
                    let x = core::f64::consts::TAU * 5.0 * f64::from(k) / RATE_HZ;
                    1.0 + (x + limb as f64).sin() * (0.01 * x).min(1.0)
                })
            })
            .collect()
    }

    fn conditioned(config: &ConditioningConfig, rows: &[Row], size: usize) -> Vec<Row> {
        let mut stream = ConditioningStream::new(config, RATE_HZ).expect("prepares");
        let mut out = Voltages::default();
        for part in rows.chunks(size) {
            stream.push(&mut part.iter().collect(), &mut out);
        }
        stream.finish(&mut out).expect("finishes");
        out.rows().collect()
    }

    fn column(rows: &[Row], limb: usize) -> Vec<f64> {
        rows.iter().map(|row| row[limb]).collect()
    }

    #[test]
    fn delays_as_of_a_whole_record() {
        let rows = rows(3000);
        let delays_s: Row = core::array::from_fn(|limb| 130e-6 * (limb as f64 - 3.0));
        let config = ConditioningConfig {
            delays_s: Some(delays_s),
            ..ConditioningConfig::default()
        };
        let out = conditioned(&config, &rows, 100);
        assert_eq!(out, conditioned(&config, &rows, 3000));
        assert_eq!(out.len(), rows.len());
        for limb in 0..LIMBS {
            let (whole, _) =
                delayed(&column(&rows, limb), -delays_s[limb], RATE_HZ).expect("shifts");
            for (k, expected) in whole.iter().enumerate().take(2990).skip(10) {
                // Spline and polynomial each: measured 2e-10 of the amplitude.
                assert!((out[k][limb] - expected).abs() < 2e-8, "limb {limb}, {k}");
            }
        }
    }

    #[test]
    fn high_pass_as_of_a_whole_record() {
        let rows = rows(3000);
        let config = ConditioningConfig {
            amplifier_high_pass_hz: Some(0.16),
            ..ConditioningConfig::default()
        };
        let out = conditioned(&config, &rows, 100);
        assert_eq!(out, conditioned(&config, &rows, 7));
        for limb in 0..LIMBS {
            let series = column(&rows, limb);
            let rest = series[..16].iter().sum::<f64>() / 16.0;
            let change: Vec<f64> = series.iter().map(|u| u - rest).collect();
            let whole = undo_high_pass(&change, 0.16, RATE_HZ).expect("undoes");
            let expected: Vec<f64> = whole.iter().map(|change| change + rest).collect();
            assert_eq!(column(&out, limb), expected, "limb {limb}");
        }
    }

    #[test]
    fn neg_what_a_failed_channel_shows_does_not_pass_through_the_low_pass() {
        const LIMB: usize = 3;
        let sound = rows(4000);
        let mut failed = sound.clone();
        for row in &mut failed[2000..] {
            row[LIMB] = f64::NAN;
        }
        let config = ConditioningConfig {
            low_pass_hz: Some(60.0),
            ..ConditioningConfig::default()
        };
        let mut excluded = Exclusions::default();
        excluded.from(2000, LimbSet::EMPTY.with(LIMB));
        let through = [&sound, &failed].map(|rows| {
            let stream = ConditioningStream::new(&config, RATE_HZ).expect("stages");
            let mut stream = stream.holding(&excluded);
            let mut out = Voltages::default();
            stream.push(&mut rows.iter().collect(), &mut out);
            stream.finish(&mut out).expect("long enough");
            out.rows().collect::<Vec<Row>>()
        });
        assert_eq!(through[0], through[1]);
        // Beyond the filter's reach it is the sound channel's, to what the filter has forgotten.
        let expected = conditioned(&config, &sound, 64);
        let reach = config.reach(RATE_HZ) as usize;
        let peak = column(&sound, LIMB)
            .iter()
            .fold(0.0_f64, |a, u| a.max(u.abs()));
        let off = |k: usize| (through[1][k][LIMB] - expected[k][LIMB]).abs() / peak;
        let before = (0..2000 - reach).map(off).fold(0.0, f64::max);
        assert!(
            before < 2e-5 && off(1999) > 1e-3,
            "{before:e} {}",
            off(1999)
        );
        for (found, expected) in through[1].iter().zip(&expected) {
            let others = (0..LIMBS).filter(|limb| *limb != LIMB);
            for limb in others {
                assert!((found[limb] - expected[limb]).abs() < 1e-12 * peak.max(1.0));
            }
        }
    }

    #[test]
    fn a_causal_low_pass_delays_by_what_is_said() {
        let ramp: Vec<Row> = (0..4000).map(|k| [f64::from(k) / RATE_HZ; LIMBS]).collect();
        let config = ConditioningConfig {
            low_pass_hz: Some(20.0),
            causal: true,
            ..ConditioningConfig::default()
        };
        let out = conditioned(&config, &ramp, 64);
        let lag_s = ramp[3999][0] - out[3999][0];
        // The bilinear transform bends frequencies near the corner, not at zero.
        assert!((lag_s / causal_delay_s(20.0) - 1.0).abs() < 1e-3, "{lag_s}");
    }
}
