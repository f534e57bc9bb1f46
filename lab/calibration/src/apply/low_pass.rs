//! A zero-phase filter over a record that does not fit in the memory.
//!
//! The pass backwards begins at the end of the record. What it has there is forgotten after a while, as its poles decay: so
//! it may as well begin [`settling_samples`] after the samples it is wanted for.

use anyhow::{Result, ensure};
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::butterworth::Section;
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::dsp::zero_phase::padding;

use super::{CHUNK, Row};

/// What is left of the backward pass's beginning where its answer is used.
const FORGOTTEN: f64 = 1e-16;
/// Samples that may be looked ahead: 72 MB of them.
const LOOK_AHEAD_LIMIT: usize = 1_000_000;

/// Samples after which a cascade has forgotten all but 1e-16 of what was before.
#[must_use]
pub fn settling_samples(sections: &[Section]) -> usize {
    let radius = sections
        .iter()
        .map(|s| {
            if s.a[1] == 0.0 {
                s.a[0].abs()
            } else {
                s.a[1].abs().sqrt()
            }
        })
        .fold(0.0, f64::max);
    // Sections ring one into the other: twice the time of the slowest covers the polynomial that comes with it.
    if radius < 1.0 {
        (2.0 * FORGOTTEN.ln() / radius.max(1e-3).ln()).ceil() as usize
    } else {
        usize::MAX
    }
}

/// The filter as a stream of rows.
///
/// Equals `sixaxis_core::dsp::zero_phase` on each whole channel to 1e-13 of the peak (test `equals_the_whole`).
pub struct ZeroPhase {
    sections: Vec<Section>,
    look_ahead: usize,
    /// Beginning and, later, end of the record as it came, for the odd extension.
    edge: Vec<Row>,
    forward: Option<[SectionsState; LIMBS]>,
    /// What the forward pass has given and the backward pass has not.
    waiting: Vec<Row>,
}

impl ZeroPhase {
    /// Prepares a filter.
    ///
    /// # Errors
    /// A corner so low that too much would have to be looked ahead.
    pub fn new(sections: Vec<Section>) -> Result<Self> {
        let look_ahead = settling_samples(&sections);
        ensure!(
            look_ahead <= LOOK_AHEAD_LIMIT,
            "--low-pass: a corner this far below the sample rate needs to look {look_ahead} samples ahead, the limit is {LOOK_AHEAD_LIMIT}"
        );
        Ok(Self {
            sections,
            look_ahead,
            edge: Vec::new(),
            forward: None,
            waiting: Vec::new(),
        })
    }

    /// Takes rows and appends those that are ready to `out`.
    pub fn push(&mut self, rows: &[Row], out: &mut Vec<Row>) {
        let pad = padding(&self.sections);
        for row in rows {
            self.edge.push(*row);
            match &mut self.forward {
                Some(forward) => {
                    let filtered = core::array::from_fn(|i| forward[i].step(row[i]));
                    self.waiting.push(filtered);
                    // Only the last of them will be needed.
                    if self.edge.len() > 4 * pad + CHUNK {
                        self.edge.drain(..self.edge.len() - pad - 1);
                    }
                    if self.waiting.len() >= self.block() + self.look_ahead {
                        self.backward(self.block(), out);
                    }
                }
                None if self.edge.len() > pad => self.begin(pad),
                None => {}
            }
        }
    }

    /// Appends the rest.
    ///
    /// # Errors
    /// A record that is not longer than the extension.
    pub fn finish(&mut self, out: &mut Vec<Row>) -> Result<()> {
        let pad = padding(&self.sections);
        let Some(forward) = &mut self.forward else {
            anyhow::bail!(
                "--low-pass needs more than {pad} samples, the recording has {}",
                self.edge.len()
            );
        };
        let (rows, last) = (self.waiting.len(), self.edge.len() - 1);
        for i in 1..=pad {
            let row: Row = core::array::from_fn(|limb| {
                2.0 * self.edge[last][limb] - self.edge[last - i][limb]
            });
            self.waiting
                .push(core::array::from_fn(|limb| forward[limb].step(row[limb])));
        }
        self.backward(rows, out);
        self.waiting.clear();
        Ok(())
    }

    /// Rows that are handed out at a time: as many as are looked ahead, so that at most twice the work is done.
    fn block(&self) -> usize {
        self.look_ahead.max(CHUNK)
    }

    /// The forward pass over the extension before the record and over what has come of it.
    fn begin(&mut self, pad: usize) {
        let first = self.edge[0];
        let before = |i: usize| -> Row {
            core::array::from_fn(|limb| 2.0 * first[limb] - self.edge[i][limb])
        };
        let start = before(pad);
        let mut forward: [SectionsState; LIMBS] =
            core::array::from_fn(|limb| SectionsState::settled(&self.sections, start[limb]));
        for i in (1..=pad).rev() {
            let row = before(i);
            for limb in 0..LIMBS {
                forward[limb].step(row[limb]);
            }
        }
        for row in &self.edge {
            self.waiting
                .push(core::array::from_fn(|limb| forward[limb].step(row[limb])));
        }
        self.forward = Some(forward);
    }

    /// Runs backwards over all that waits and hands the first `rows` out.
    fn backward(&mut self, rows: usize, out: &mut Vec<Row>) {
        let Some(end) = self.waiting.last().copied() else {
            return;
        };
        let mut backward: [SectionsState; LIMBS] =
            core::array::from_fn(|limb| SectionsState::settled(&self.sections, end[limb]));
        let at = out.len();
        out.resize(at + rows, [0.0; LIMBS]);
        for (index, row) in self.waiting.iter().enumerate().rev() {
            let filtered: Row = core::array::from_fn(|limb| backward[limb].step(row[limb]));
            if index < rows {
                out[at + index] = filtered;
            }
        }
        self.waiting.drain(..rows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_core::dsp::butterworth;
    use sixaxis_core::dsp::zero_phase::zero_phase;

    #[test]
    fn equals_the_whole() {
        for (order, corner_hz, samples) in [(4, 12.0, 60_000), (1, 400.0, 40_000), (2, 30.0, 17)] {
            let sections = butterworth::low_pass(order, corner_hz, 2000.0).expect("designs");
            let rows: Vec<Row> = (0..samples)
                .map(|k| {
                    core::array::from_fn(|limb| {
                        let x = f64::from(k) * 1e-3 * (limb + 1) as f64;
                        3.0 + x.sin() + 0.2 * (37.0 * x).cos() + 1e-4 * f64::from(k % 7)
                    })
                })
                .collect();
            let mut whole = rows.clone();
            sixaxis_core::dsp::each_channel(&mut whole, |series| zero_phase(&sections, series))
                .expect("filters");
            for size in [1_usize, 777, 100_000] {
                let mut filter = ZeroPhase::new(sections.clone()).expect("prepares");
                let mut out = Vec::new();
                for part in rows.chunks(size) {
                    filter.push(part, &mut out);
                }
                filter.finish(&mut out).expect("finishes");
                assert_eq!(out.len(), whole.len());
                let worst = out
                    .iter()
                    .flatten()
                    .zip(whole.iter().flatten())
                    .fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
                // Peak 4.2; measured 5e-15.
                assert!(worst < 4e-13, "order {order}, parts of {size}: {worst:e}");
            }
        }
    }

    #[test]
    fn too_short_is_said() {
        let sections = butterworth::low_pass(4, 12.0, 2000.0).expect("designs");
        let mut filter = ZeroPhase::new(sections).expect("prepares");
        let mut out = Vec::new();
        filter.push(&[[0.0; LIMBS]; 15], &mut out);
        assert!(filter.finish(&mut out).is_err());
    }
}
