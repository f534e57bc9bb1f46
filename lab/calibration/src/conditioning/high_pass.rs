//! An amplifier's first-order high-pass, undone about the level at which the record begins.

use sixaxis_core::Result;
use sixaxis_core::dsp::lag::UndoHighPass;
use sixaxis_core::dsp::stage::Stage;

/// Samples that the level is the mean of: at rest in any run that begins at rest. What it is off by grows with time, because
/// undoing a high-pass integrates.
pub(crate) const BASELINE: usize = 16;

/// One channel's amplifier, undone; the first [`BASELINE`] samples are handed on together.
#[derive(Debug, Clone, PartialEq)]
pub struct UndoneHighPass {
    undo: UndoHighPass,
    rest: Option<f64>,
    first: Vec<f64>,
}

impl UndoneHighPass {
    /// Of an amplifier with its corner at `corner_hz`.
    ///
    /// # Errors
    /// [`sixaxis_core::Error::OutOfRange`] unless both frequencies are positive and finite.
    pub fn new(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        Ok(Self {
            undo: UndoHighPass::new(corner_hz, sample_rate_hz)?,
            rest: None,
            first: Vec::with_capacity(BASELINE),
        })
    }

    fn begin(&mut self, out: &mut Vec<f64>) {
        let rest = self.first.iter().sum::<f64>() / self.first.len().max(1) as f64;
        self.rest = Some(rest);
        let first = core::mem::take(&mut self.first);
        self.push(&first, out);
    }
}

impl Stage for UndoneHighPass {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        if let Some(rest) = self.rest {
            out.extend(samples.iter().map(|x| self.undo.step(x - rest) + rest));
            return;
        }
        let (first, more) = samples.split_at((BASELINE - self.first.len()).min(samples.len()));
        self.first.extend(first);
        if self.first.len() == BASELINE {
            self.begin(out);
            self.push(more, out);
        }
    }

    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()> {
        if self.rest.is_none() {
            self.begin(out);
        }
        Ok(())
    }
}
