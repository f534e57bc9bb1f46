//! What is done to voltages before they are decoupled, as streams: the same stages as a calibration's, in the same order.

use std::collections::VecDeque;

use anyhow::{Result, bail};
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::dsp::lag::FirstOrder;

use super::Row;
use super::low_pass::ZeroPhase;

/// Order of the low-pass, as a session's default.
pub const LOW_PASS_ORDER: usize = 4;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wishes {
    /// Delay of each limb's channel against the clock, s.
    pub delays_s: Option<Row>,
    /// Corner of the amplifier's high-pass that is to be undone, Hz.
    pub amplifier_high_pass_hz: Option<f64>,
    /// Corner of a low-pass, Hz.
    pub low_pass_hz: Option<f64>,
    /// The low-pass goes forwards only, for live use: it delays.
    pub causal: bool,
}

/// The stages.
pub struct Conditioning {
    delays: Option<Delays>,
    high_pass: Option<UndoneHighPass>,
    low_pass: Option<LowPass>,
    between: [Vec<Row>; 2],
}

enum LowPass {
    Causal(
        Vec<butterworth::Section>,
        Option<Box<[SectionsState; LIMBS]>>,
    ),
    ZeroPhase(Box<ZeroPhase>),
}

/// Correlation, over the white variance, that the zero-phase low-pass leaves between a sample of noise and itself, its
/// neighbour and the one after it: that of the filter's answer to a single sample.
///
/// # Errors
/// A corner that the sample rate does not allow.
pub fn noise_correlation(wishes: &Wishes, sample_rate_hz: f64) -> Result<[f64; 3]> {
    // Of the corner, after which nothing is left of an order-4 Butterworth.
    const PERIODS: f64 = 10.0;
    let Some(corner_hz) = wishes.low_pass_hz else {
        return Ok([1.0, 0.0, 0.0]);
    };
    let sections = butterworth::low_pass(LOW_PASS_ORDER, corner_hz, sample_rate_hz)
        .map_err(|e| anyhow::anyhow!("--low-pass: {e}"))?;
    let half = (PERIODS * sample_rate_hz / corner_hz) as usize + 100;
    let mut answer = vec![0.0; 2 * half + 1];
    answer[half] = 1.0;
    sixaxis_core::dsp::zero_phase::zero_phase(&sections, &mut answer)?;
    Ok(core::array::from_fn(|lag| {
        answer.iter().zip(&answer[lag..]).map(|(a, b)| a * b).sum()
    }))
}

impl Conditioning {
    /// Prepares the stages.
    ///
    /// # Errors
    /// Corners that the sample rate does not allow.
    pub fn new(wishes: &Wishes, sample_rate_hz: f64) -> Result<Self> {
        let low_pass = match wishes.low_pass_hz {
            Some(corner_hz) => {
                let sections = butterworth::low_pass(LOW_PASS_ORDER, corner_hz, sample_rate_hz)
                    .map_err(|e| anyhow::anyhow!("--low-pass: {e}"))?;
                Some(if wishes.causal {
                    LowPass::Causal(sections, None)
                } else {
                    LowPass::ZeroPhase(Box::new(ZeroPhase::new(sections)?))
                })
            }
            None => None,
        };
        let high_pass = match wishes.amplifier_high_pass_hz {
            Some(corner_hz) => Some(UndoneHighPass::new(corner_hz, sample_rate_hz)?),
            None => None,
        };
        let delays = match wishes.delays_s {
            Some(delays_s) => Some(Delays::new(delays_s.map(|d| d * sample_rate_hz))?),
            None => None,
        };
        Ok(Self {
            delays,
            high_pass,
            low_pass,
            between: Default::default(),
        })
    }

    /// Takes rows and appends those that are ready to `out`, in the order of their samples.
    pub fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        let Self {
            delays,
            high_pass,
            low_pass,
            between: [first, second],
        } = self;
        let mut current = rows;
        if let Some(delays) = delays {
            first.clear();
            for row in current {
                delays.push(row, first);
            }
            current = first.as_slice();
        }
        if let Some(high_pass) = high_pass {
            second.clear();
            second.extend(current.iter().map(|row| high_pass.undo(row)));
            current = second.as_slice();
        }
        match low_pass {
            None => out.extend_from_slice(current),
            Some(LowPass::ZeroPhase(filter)) => filter.push(current, out),
            Some(LowPass::Causal(sections, state)) => {
                for row in current {
                    let state = state.get_or_insert_with(|| {
                        Box::new(row.map(|value| SectionsState::settled(sections, value)))
                    });
                    out.push(core::array::from_fn(|limb| state[limb].step(row[limb])));
                }
            }
        }
    }

    /// Appends what is left when no more rows come.
    ///
    /// # Errors
    /// A record too short for the low-pass.
    pub fn finish(&mut self, out: &mut Vec<Row>) -> Result<()> {
        if let Some(mut delays) = self.delays.take() {
            let mut last = Vec::new();
            delays.finish(&mut last);
            self.push(&last, out);
        }
        if let Some(LowPass::ZeroPhase(filter)) = &mut self.low_pass {
            filter.finish(out)?;
        }
        Ok(())
    }
}

/// Delay of the causal low-pass well below its corner, s.
#[must_use]
pub fn causal_delay_s(corner_hz: f64) -> f64 {
    // Sum over the poles of a Butterworth filter of order 4: 1/tan and so on come to 2.6131 over the corner's frequency.
    2.613_125_929_752_753 / (core::f64::consts::TAU * corner_hz)
}

/// Samples on either side that an interpolated value rests on.
const REACH: usize = 3;

/// Longest lag or lead, samples: more is no converter's.
const LONGEST_LAG: f64 = 10_000.0;

/// Channels that lag, brought forward, and channels that lead, brought back: each is read that much later in the file, between samples by the polynomial through the
/// six nearest ones. At a tenth of the sample rate that is 2e-4 of the amplitude off, at a hundredth 2e-10.
struct Delays {
    /// Whole samples and weights of six neighbours, for each channel.
    taps: [(usize, [f64; 2 * REACH]); LIMBS],
    /// Rows needed after, and, beyond [`REACH`], before the one that goes out.
    ahead: usize,
    behind: usize,
    /// Rows still needed, the first [`REACH`] of them from before the row that is next to go out.
    window: VecDeque<Row>,
}

impl Delays {
    fn new(samples: Row) -> Result<Self> {
        if let Some(limb) = samples
            .iter()
            .position(|lag| !(-LONGEST_LAG..=LONGEST_LAG).contains(lag))
        {
            bail!(
                "limbs_lag_us: {} samples for limb {}; it can be up to {LONGEST_LAG} either way",
                samples[limb],
                limb + 1
            );
        }
        let whole = samples.map(|lag| lag.floor() as i64);
        let behind = whole.into_iter().min().unwrap_or(0).min(0).unsigned_abs() as usize;
        let ahead = whole.into_iter().max().unwrap_or(0).max(0) as usize + REACH;
        let taps = core::array::from_fn(|limb| {
            let share = samples[limb] - whole[limb] as f64;
            ((whole[limb] + behind as i64) as usize, weights(share))
        });
        Ok(Self {
            taps,
            ahead,
            behind,
            window: VecDeque::new(),
        })
    }

    fn push(&mut self, row: &Row, out: &mut Vec<Row>) {
        if self.window.is_empty() {
            self.window
                .extend(core::iter::repeat_n(*row, REACH - 1 + self.behind));
        }
        self.window.push_back(*row);
        if self.window.len() == REACH + self.behind + self.ahead {
            out.push(core::array::from_fn(|limb| {
                let (whole, weights) = &self.taps[limb];
                (0..2 * REACH)
                    .map(|k| weights[k] * self.window[whole + k][limb])
                    .sum()
            }));
            self.window.pop_front();
        }
    }

    /// The end is held, as it is where a whole record is shifted.
    fn finish(&mut self, out: &mut Vec<Row>) {
        if let Some(last) = self.window.back().copied() {
            for _ in 0..self.ahead {
                self.push(&last, out);
            }
        }
    }
}

/// Weights of samples -2 to 3 for the value at `share` between 0 and 1.
fn weights(share: f64) -> [f64; 2 * REACH] {
    let nodes: [f64; 2 * REACH] = core::array::from_fn(|k| k as f64 - (REACH - 1) as f64);
    core::array::from_fn(|k| {
        nodes
            .iter()
            .filter(|node| **node != nodes[k])
            .map(|node| (share - node) / (nodes[k] - node))
            .product()
    })
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

#[cfg(test)]
mod tests {
    use super::*;
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

    fn conditioned(wishes: &Wishes, rows: &[Row], size: usize) -> Vec<Row> {
        let mut conditioning = Conditioning::new(wishes, RATE_HZ).expect("prepares");
        let mut out = Vec::new();
        for part in rows.chunks(size) {
            conditioning.push(part, &mut out);
        }
        conditioning.finish(&mut out).expect("finishes");
        out
    }

    fn column(rows: &[Row], limb: usize) -> Vec<f64> {
        rows.iter().map(|row| row[limb]).collect()
    }

    #[test]
    fn delays_as_of_a_whole_record() {
        let rows = rows(3000);
        let delays_s: Row = core::array::from_fn(|limb| 130e-6 * (limb as f64 - 3.0));
        let wishes = Wishes {
            delays_s: Some(delays_s),
            ..Wishes::default()
        };
        let out = conditioned(&wishes, &rows, 100);
        assert_eq!(out, conditioned(&wishes, &rows, 3000));
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
        let wishes = Wishes {
            amplifier_high_pass_hz: Some(0.16),
            ..Wishes::default()
        };
        let out = conditioned(&wishes, &rows, 100);
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
        let wishes = Wishes {
            low_pass_hz: Some(20.0),
            causal: true,
            ..Wishes::default()
        };
        let out = conditioned(&wishes, &ramp, 64);
        let lag_s = ramp[3999][0] - out[3999][0];
        // The bilinear transform bends frequencies near the corner, not at zero.
        assert!((lag_s / causal_delay_s(20.0) - 1.0).abs() < 1e-3, "{lag_s}");
    }
}
