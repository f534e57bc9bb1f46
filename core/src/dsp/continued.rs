//! A filter without phase whose ends do not hang on single samples.
//!
//! A filter that looks both ways has to assume what lies beyond the ends of a record. [`super::zero_phase`] turns the record round
//! its end sample, as SciPy does, for three times the filter's length. Where the corner is far below the sample rate that is
//! nothing of what the filter remembers, and the filtered record begins at its first raw sample: with that sample's whole noise,
//! however little of it the filter leaves elsewhere. A decoupler integrates that twice.
//!
//! Here the record is turned round the end of a *parabola* fitted over its first samples, as many as the filter delays, for five times as
//! many. The noise of an end is then that of the fit, 3 over the root of that number (test `inv_an_end_has_the_noise_of_its_fit`); a parabola,
//! because a record that does not end at rest is curved. Where the filter delays by less than three samples the fit is the end sample itself.

use alloc::vec::Vec;

use super::butterworth::Section;
use super::check_finite;
use super::stage::{self, Stage};
use super::zero_phase::{ZeroPhase, padding};
use crate::error::{Result, require_samples};

/// Name of the filter in errors.
const WHAT: &str = "zero-phase filter";

/// Filter delays by which a record is continued: the slowest pole of an order-4 Butterworth has then decayed to 0.7 %.
const EXTENT: f64 = 5.0;

/// By how many samples a cascade delays a slow signal: its group delay at zero frequency.
fn delay_samples(sections: &[Section]) -> f64 {
    let delay: f64 = sections
        .iter()
        .map(|Section { b, a }| {
            (b[1] + 2.0 * b[2]) / (b[0] + b[1] + b[2]) - (a[0] + 2.0 * a[1]) / (1.0 + a[0] + a[1])
        })
        .sum();
    if delay.is_finite() {
        delay.max(0.0)
    } else {
        0.0
    }
}

/// How a record goes on beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Continuation {
    /// Samples by which it goes on.
    pub extent: usize,
    /// Samples over which the parabola is fitted.
    fitted: usize,
}

impl Continuation {
    /// Of a record that is as long as it needs.
    fn of(sections: &[Section]) -> Self {
        let delay = delay_samples(sections);
        Self {
            extent: (EXTENT * delay) as usize,
            fitted: (delay as usize).max(1),
        }
    }

    /// Of a record of so many samples, at least one.
    pub fn of_record(sections: &[Section], samples: usize) -> Self {
        Self::of(sections).within(samples)
    }

    fn within(self, samples: usize) -> Self {
        Self {
            extent: self.extent.min(samples - 1),
            fitted: self.fitted.min(samples),
        }
    }

    /// Weights of the samples from the end on in the parabola's value there: least squares over 0, 1, ... m - 1 in closed form.
    pub fn weights(self) -> impl Iterator<Item = f64> {
        let m = self.fitted as f64;
        let (constant, slope) = (3.0 * (3.0 * m * m - 3.0 * m + 2.0), 18.0 * (2.0 * m - 1.0));
        (0..self.fitted).map(move |i| {
            let i = i as f64;
            (constant - slope * i + 30.0 * i * i) / (m * (m + 1.0) * (m + 2.0))
        })
    }

    /// What lies beyond the end that `inwards` begins at, the nearest first.
    fn beyond<'a>(
        self,
        inwards: impl Iterator<Item = &'a f64> + Clone,
    ) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        let fit: f64 = self
            .weights()
            .zip(inwards.clone())
            .map(|(w, x)| w * x)
            .sum();
        let turned: Vec<f64> = inwards
            .skip(1)
            .take(self.extent)
            .map(|x| 2.0 * fit - x)
            .collect();
        turned.into_iter()
    }
}

/// Filters `series` in place without phase, continued beyond its ends as the module says.
///
/// # Errors
/// Those of [`super::zero_phase::zero_phase`].
pub fn zero_phase(sections: &[Section], series: &mut [f64]) -> Result<()> {
    require_samples(WHAT, padding(sections) + 1, series.len())?;
    check_finite(series)?;
    let mut stage = ContinuedZeroPhase::around(sections, ZeroPhase::whole(sections));
    stage::whole(WHAT, &mut stage, series)
}

/// The filter as a stage.
///
/// Equals [`zero_phase`] on the whole record to 1e-13 of the peak (test `inv_a_zero_phase_stream_equals_the_whole`).
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuedZeroPhase {
    continuation: Continuation,
    least_samples: usize,
    filter: ZeroPhase,
    /// Beginning and, later, end of the record.
    edge: Vec<f64>,
    /// The filter has had what lies before the record.
    begun: bool,
    /// Filtered samples that lie before the record and have yet to come.
    before: usize,
    /// Samples that were taken and not given.
    owed: usize,
    filtered: Vec<f64>,
}

impl ContinuedZeroPhase {
    /// The filter over a stream. It holds what [`ZeroPhase`] holds and ten times the filter's delay.
    ///
    /// # Errors
    /// Those of [`ZeroPhase::new`].
    pub fn new(sections: &[Section]) -> Result<Self> {
        Ok(Self::around(sections, ZeroPhase::new(sections)?))
    }

    fn around(sections: &[Section], filter: ZeroPhase) -> Self {
        Self {
            continuation: Continuation::of(sections),
            least_samples: padding(sections) + 1,
            filter,
            edge: Vec::new(),
            begun: false,
            before: 0,
            owed: 0,
            filtered: Vec::new(),
        }
    }

    fn begin(&mut self) {
        let before = self.continuation.beyond(self.edge.iter());
        self.before = before.len();
        let before: Vec<f64> = before.rev().collect();
        self.filter.push(&before, &mut self.filtered);
        self.filter.push(&self.edge, &mut self.filtered);
        self.begun = true;
    }

    /// Hands out what the filter has given of the record itself.
    fn give(&mut self, out: &mut Vec<f64>) {
        let skipped = self.before.min(self.filtered.len());
        self.before -= skipped;
        let given = self.owed.min(self.filtered.len() - skipped);
        self.owed -= given;
        out.extend(&self.filtered[skipped..skipped + given]);
        self.filtered.clear();
    }
}

impl Stage for ContinuedZeroPhase {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        self.owed += samples.len();
        self.edge.extend(samples);
        let Continuation { extent, fitted } = self.continuation;
        let needed = extent.saturating_add(1).max(fitted).max(self.least_samples);
        if self.begun {
            self.filter.push(samples, &mut self.filtered);
        } else if self.edge.len() >= needed {
            self.begin();
        }
        // Only the last of them will be needed.
        if self.begun && self.edge.len() > 2 * needed {
            self.edge.drain(..self.edge.len() - needed);
        }
        self.give(out);
    }

    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()> {
        if !self.begun {
            require_samples(WHAT, self.least_samples, self.edge.len())?;
            self.continuation = self.continuation.within(self.edge.len());
            self.begin();
        }
        let after: Vec<f64> = self.continuation.beyond(self.edge.iter().rev()).collect();
        self.filter.push(&after, &mut self.filtered);
        self.filter.finish(&mut self.filtered)?;
        self.give(out);
        Ok(())
    }
}
