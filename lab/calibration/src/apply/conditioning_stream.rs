//! What is done to voltages before they are decoupled, as streams: of the stages that condition a calibration's recordings
//! those that need no more than a bounded stretch of a recording, in the same order ([`Stage::ORDER`]).

use anyhow::Result;
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::lag::FirstOrder;
use sixaxis_core::dsp::stream::SectionsState;

use super::Row;
use super::delays::Delays;
use super::zero_phase_stream::ZeroPhase;
use crate::conditioning::Stage;

/// Order of the low-pass, as a session's default.
pub const LOW_PASS_ORDER: usize = 4;

/// What is to be done to the voltages of one recording.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConditioningConfig {
    /// Delay of each limb's channel against the clock, s.
    pub delays_s: Option<Row>,
    /// Corner of the amplifiers' high-pass that is to be undone, Hz.
    pub amplifier_high_pass_hz: Option<f64>,
    /// Corner of a low-pass, Hz.
    pub low_pass_hz: Option<f64>,
    /// The low-pass runs forwards only, for live use: it delays.
    pub causal: bool,
}

/// A stage that takes rows and hands on those that are ready, in the order of their samples.
pub trait Streaming: Send {
    /// Takes rows and appends those that are ready.
    fn push(&mut self, rows: &[Row], out: &mut Vec<Row>);

    /// Appends what is left when no more rows come.
    ///
    /// # Errors
    /// A record too short for the stage.
    fn finish(&mut self, _out: &mut Vec<Row>) -> Result<()> {
        Ok(())
    }
}

/// The stages that are on, in [`Stage::ORDER`].
pub struct ConditioningStream {
    stages: Vec<Box<dyn Streaming>>,
    between: [Vec<Row>; 2],
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
        .map_err(|e| anyhow::anyhow!("--low-pass: {e}"))
}

/// A stage as a stream, where it is asked for and runs on limbs.
fn streaming(
    stage: Stage,
    config: &ConditioningConfig,
    sample_rate_hz: f64,
) -> Result<Option<Box<dyn Streaming>>> {
    Ok(match stage {
        Stage::Delays => match config.delays_s {
            Some(delays_s) => Some(Box::new(Delays::new(delays_s.map(|d| d * sample_rate_hz))?)),
            None => None,
        },
        Stage::HighPass => match config.amplifier_high_pass_hz {
            Some(corner_hz) => Some(Box::new(UndoneHighPass::new(corner_hz, sample_rate_hz)?)),
            None => None,
        },
        Stage::LowPass => match config.low_pass_hz {
            Some(corner_hz) => {
                let sections = low_pass(corner_hz, sample_rate_hz)?;
                Some(if config.causal {
                    Box::new(Causal {
                        sections,
                        state: None,
                    })
                } else {
                    Box::new(ZeroPhase::new(sections)?)
                })
            }
            None => None,
        },
        // A wild sample is for the user or the fault monitor to see, and a trend is known only when the run is over
        // (`--rest-to-rest` takes it off).
        Stage::Outliers | Stage::Trend => None,
        // A recording to be decoupled has no standards.
        Stage::AccelerometerLag | Stage::GyroscopeLag | Stage::Derivative => None,
    })
}

impl ConditioningStream {
    /// Prepares the stages.
    ///
    /// # Errors
    /// Corners that the sample rate does not allow.
    pub fn new(config: &ConditioningConfig, sample_rate_hz: f64) -> Result<Self> {
        let mut stages = Vec::new();
        for stage in Stage::ORDER {
            stages.extend(streaming(stage, config, sample_rate_hz)?);
        }
        Ok(Self {
            stages,
            between: Default::default(),
        })
    }

    /// Takes rows and appends those that are ready to `out`, in the order of their samples.
    pub fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        self.push_from(0, rows, out);
    }

    /// The same from the stage of this index on.
    fn push_from(&mut self, first: usize, rows: &[Row], out: &mut Vec<Row>) {
        let Some((last, stages)) = self.stages[first..].split_last_mut() else {
            out.extend_from_slice(rows);
            return;
        };
        let [current, next] = &mut self.between;
        let mut rows = rows;
        for stage in stages {
            next.clear();
            stage.push(rows, next);
            core::mem::swap(current, next);
            rows = current;
        }
        last.push(rows, out);
    }

    /// Appends what is left when no more rows come.
    ///
    /// # Errors
    /// A record too short for the low-pass.
    pub fn finish(&mut self, out: &mut Vec<Row>) -> Result<()> {
        for index in 0..self.stages.len() {
            let mut left = Vec::new();
            self.stages[index].finish(&mut left)?;
            self.push_from(index + 1, &left, out);
        }
        Ok(())
    }
}

impl Streaming for ZeroPhase {
    fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        Self::push(self, rows, out);
    }

    fn finish(&mut self, out: &mut Vec<Row>) -> Result<()> {
        Self::finish(self, out)
    }
}

/// A low-pass that runs forwards only, settled on the first row.
struct Causal {
    sections: Vec<butterworth::Section>,
    state: Option<Box<[SectionsState; LIMBS]>>,
}

impl Streaming for Causal {
    fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        for row in rows {
            let state = self.state.get_or_insert_with(|| {
                Box::new(row.map(|value| SectionsState::settled(&self.sections, value)))
            });
            out.push(core::array::from_fn(|limb| state[limb].step(row[limb])));
        }
    }
}

/// Delay of the causal low-pass well below its corner, s.
#[must_use]
pub fn causal_delay_s(corner_hz: f64) -> f64 {
    // Sum over the poles of a Butterworth filter of order 4: 1/tan and so on come to 2.6131 over the corner's frequency.
    2.613_125_929_752_753 / (core::f64::consts::TAU * corner_hz)
}

/// An amplifier's first-order high-pass, undone about the first row.
struct UndoneHighPass {
    rest: Option<Row>,
    amplifiers: [FirstOrder; LIMBS],
}

impl UndoneHighPass {
    fn new(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        let amplifier = FirstOrder::high_pass(corner_hz, sample_rate_hz)
            .map_err(|e| anyhow::anyhow!("the amplifier's high-pass: {e}"))?;
        Ok(Self {
            rest: None,
            amplifiers: [amplifier; LIMBS],
        })
    }

    fn undo(&mut self, row: &Row) -> Row {
        let rest = *self.rest.get_or_insert(*row);
        core::array::from_fn(|limb| {
            let amplifier = &mut self.amplifiers[limb];
            // What it shows is a straight line over its next input: two trials say which input it was.
            let (mut at_zero, mut at_one) = (*amplifier, *amplifier);
            let (zero, one) = (at_zero.step(0.0), at_one.step(1.0));
            let input = (row[limb] - rest[limb] - zero) / (one - zero);
            amplifier.step(input);
            input + rest[limb]
        })
    }
}

impl Streaming for UndoneHighPass {
    fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        out.extend(rows.iter().map(|row| self.undo(row)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_core::dsp::lag::undo_high_pass;
    use sixaxis_core::dsp::resample::delayed;

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
        let mut out = Vec::new();
        for part in rows.chunks(size) {
            stream.push(part, &mut out);
        }
        stream.finish(&mut out).expect("finishes");
        out
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
        for limb in 0..LIMBS {
            let series = column(&rows, limb);
            let change: Vec<f64> = series.iter().map(|u| u - series[0]).collect();
            let whole = undo_high_pass(&change, 0.16, RATE_HZ).expect("undoes");
            for (row, change) in out.iter().zip(whole) {
                let expected = change + series[0];
                assert!((row[limb] - expected).abs() < 1e-10, "limb {limb}");
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
