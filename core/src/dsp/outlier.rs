//! Rejection of wild values by the Hampel test: distance from the running median in units of the running median
//! absolute deviation.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::stage::{self, Stage};
use crate::error::{Result, require, require_positive, require_samples};

/// Standard deviation of a normal variable over its median absolute deviation: 1/quantile(3/4).
pub(crate) const SIGMA_PER_MAD: f64 = 1.482_602_218_505_602;

/// The Hampel test as a stage: see [`hampel`].
#[derive(Debug, Clone, PartialEq)]
pub struct Hampel {
    half_width: usize,
    sigmas: f64,
    /// The samples that a next one may be judged by, as they came in, and the place of the first of them in the record.
    around: VecDeque<f64>,
    first: usize,
    next: usize,
    window: Vec<f64>,
    replaced: Vec<usize>,
}

impl Hampel {
    /// With `half_width` samples on either side.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for a half width of zero or `sigmas` not positive.
    pub fn new(half_width: usize, sigmas: f64) -> Result<Self> {
        require(half_width > 0, "half_width", 0.0, "at least 1")?;
        require_positive("sigmas", sigmas)?;
        Ok(Self {
            half_width,
            sigmas,
            around: VecDeque::new(),
            first: 0,
            next: 0,
            window: Vec::new(),
            replaced: Vec::new(),
        })
    }

    /// Places of the samples replaced so far.
    #[must_use]
    pub fn replaced(&self) -> &[usize] {
        &self.replaced
    }

    fn taken(&self) -> usize {
        self.first + self.around.len()
    }

    /// Judges the next sample by those around it that are there.
    fn judged(&mut self) -> f64 {
        let from = self.next.saturating_sub(self.half_width);
        let to = (self.next + self.half_width + 1).min(self.taken());
        self.around.drain(..from - self.first);
        self.first = from;
        let sample = self.around[self.next - from];
        self.window.clear();
        self.window.extend(self.around.range(..to - from));
        let median = median(&mut self.window);
        for x in &mut self.window {
            *x = (*x - median).abs();
        }
        let deviation = SIGMA_PER_MAD * self::median(&mut self.window);
        self.next += 1;
        if (sample - median).abs() > self.sigmas * deviation {
            self.replaced.push(self.next - 1);
            return median;
        }
        sample
    }
}

impl Stage for Hampel {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for x in samples {
            self.around.push_back(*x);
            if self.taken() > self.next + self.half_width {
                out.push(self.judged());
            }
        }
    }

    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()> {
        let width = self.half_width.saturating_mul(2).saturating_add(1);
        require_samples(WHAT, width, self.taken())?;
        while self.next < self.taken() {
            out.push(self.judged());
        }
        Ok(())
    }
}

/// Name of the test in errors.
const WHAT: &str = "Hampel test";

/// Replaces samples further than `sigmas` deviations from the median of the `2 half_width + 1` samples around them by
/// that median, and returns their indices. At the ends the window is cut off.
///
/// Judged on the series as it came in, so that one replacement does not excuse the next. Equals the definition by
/// sorting, sample for sample (test `ref_numpy_hampel`). A straight line is not touched above 1.35 `sigmas`, not even
/// where the window is cut off (test `inv_straight_line_is_untouched`), and up to `half_width` wild samples in one
/// whole window do not hide each other (test `inv_wild_samples_do_not_hide_each_other`); the first and the last samples of a record are judged by
/// as few as `half_width + 1`, of which fewer than half may be wild: of a run of wild ones that the record begins with, the first pass.
///
/// In a window that is constant but for one sample the deviation is zero and any difference is wild; a series that
/// carries no noise at all, or less than a converter step, should not be tested.
///
/// # Errors
/// [`crate::Error::OutOfRange`] for a half width of zero or `sigmas` not positive; [`crate::Error::TooFewSamples`] for a series
/// shorter than one window; [`crate::Error::NotFinite`].
pub fn hampel(series: &mut [f64], half_width: usize, sigmas: f64) -> Result<Vec<usize>> {
    let mut stage = Hampel::new(half_width, sigmas)?;
    stage::whole(WHAT, &mut stage, series)?;
    Ok(stage.replaced)
}

/// Median; reorders its argument. NaN of nothing.
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    if n == 0 {
        return f64::NAN;
    }
    let (below, &mut upper, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        return upper;
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // In halves: the sum of the two may overflow where their mean does not.
    0.5 * lower + 0.5 * upper
}
