//! Limbs' channels that were sampled late or early, brought onto one clock as a stream.

use std::collections::VecDeque;

use anyhow::{Result, bail};
use sixaxis_core::LIMBS;

use super::Row;
use super::conditioning_stream::Streaming;

/// Samples on either side that an interpolated value rests on.
const REACH: usize = 3;

/// Longest lag or lead, samples: more is no converter's.
const LONGEST_LAG: f64 = 10_000.0;

/// Brings channels that lag forward and channels that lead back: each is read that much later in the file, between samples by
/// the polynomial through the six nearest ones. At a tenth of the sample rate that is 2e-4 of the amplitude off, at a hundredth 2e-10.
pub struct Delays {
    /// Whole samples and weights of six neighbours, for each channel.
    taps: [(usize, [f64; 2 * REACH]); LIMBS],
    /// Rows needed after, and, beyond [`REACH`], before the one that goes out.
    ahead: usize,
    behind: usize,
    /// Rows still needed, the first [`REACH`] of them from before the row that is next to go out.
    window: VecDeque<Row>,
}

impl Delays {
    /// For delays in samples.
    ///
    /// # Errors
    /// A delay beyond [`LONGEST_LAG`].
    pub fn new(samples: Row) -> Result<Self> {
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

    fn take(&mut self, row: &Row, out: &mut Vec<Row>) {
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
}

impl Streaming for Delays {
    fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        for row in rows {
            self.take(row, out);
        }
    }

    /// The last row is held, as it is where a whole record is shifted.
    fn finish(&mut self, out: &mut Vec<Row>) -> Result<()> {
        if let Some(last) = self.window.back().copied() {
            for _ in 0..self.ahead {
                self.take(&last, out);
            }
        }
        Ok(())
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
