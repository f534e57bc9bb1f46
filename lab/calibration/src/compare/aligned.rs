//! Two motions, sample beside sample, on the clock of the slower one.

use anyhow::{Result, anyhow, ensure};

use super::track::{Motion, Track, is_unknown};

/// Departure of a ratio of rates from a whole number, relative, that is put down to rounding.
const RATIO_TOLERANCE: f64 = 1e-6;
/// Distance of the samples of one motion from those of the other, in samples of the faster, that is put down to rounding.
const PHASE_TOLERANCE: f64 = 0.01;

/// What lies further apart, s, has no instant in common, whatever its clocks: eleven days.
const LONGEST_S: f64 = 1e6;

/// Instants that were gone through.
#[derive(Debug, Clone, Copy)]
pub struct Passed {
    /// Common ones.
    pub count: u64,
    /// Those where the attitude of one of the two is not known, which are passed over.
    pub unknown: u64,
    /// Those of the result, and of the truth, after the other's last.
    pub beyond: [u64; 2],
}

/// A result beside its truth.
pub struct Aligned {
    result: Track,
    truth: Track,
    /// Samples before the first common instant: result, truth.
    first: [u64; 2],
    /// Samples passed over between two common instants: result, truth.
    skip: [u64; 2],
    /// Time of the first common instant on the truth's clock, s.
    pub start_s: f64,
    /// Common instants per second.
    pub rate_hz: f64,
}

fn nothing_in_common(result: &Track, truth: &Track) -> anyhow::Error {
    anyhow!(
        "{} starts at {} s, {} at {} s: they have no instant in common",
        result.path.display(),
        result.start_s,
        truth.path.display(),
        truth.start_s
    )
}

impl Aligned {
    /// Finds the common instants.
    ///
    /// # Errors
    /// Rates that are not whole multiples of each other; clocks whose samples lie between each other's; motions that have no
    /// instant in common.
    pub fn new(result: Track, truth: Track) -> Result<Self> {
        let rates = [result.sample_rate_hz, truth.sample_rate_hz];
        let fastest = rates[0].max(rates[1]);
        let ratio = fastest / rates[0].min(rates[1]);
        let whole = ratio.round();
        ensure!(
            (ratio - whole).abs() <= RATIO_TOLERANCE * ratio,
            "{} has {} Hz, {} has {} Hz: one rate must be a whole multiple of the other; resample one of them",
            result.path.display(),
            rates[0],
            truth.path.display(),
            rates[1]
        );
        let stride = whole as i64;
        let slow = usize::from(rates[0] == fastest);
        let starts_s = [result.start_s, truth.start_s];
        if (starts_s[0] - starts_s[1]).abs() > LONGEST_S {
            return Err(nothing_in_common(&result, &truth));
        }
        // The result's start against the truth's, in samples of the faster.
        let apart = (result.start_s - truth.start_s) * fastest;
        let distance = apart.round();
        ensure!(
            (apart - distance).abs() <= PHASE_TOLERANCE,
            "{} starts at {} s, {} at {} s: the samples of one lie {:.2} of a sample beside those of the other; resample one of them",
            result.path.display(),
            result.start_s,
            truth.path.display(),
            truth.start_s,
            (apart - distance).abs()
        );
        // Samples of the faster by which the slower starts after it, or before it.
        let later = distance as i64 * if slow == 0 { 1 } else { -1 };
        let passed_by_slow = if later < 0 {
            (-later + stride - 1) / stride
        } else {
            0
        };
        let mut first = [0; 2];
        first[slow] = passed_by_slow as u64;
        first[1 - slow] = (later + passed_by_slow * stride) as u64;
        let mut skip = [0; 2];
        skip[1 - slow] = stride as u64 - 1;
        let start_s = truth.start_s + first[1] as f64 / truth.sample_rate_hz;
        let rate_hz = rates[0].min(rates[1]);
        Ok(Self {
            result,
            truth,
            first,
            skip,
            start_s,
            rate_hz,
        })
    }

    /// Whether both have these columns.
    pub fn has(&self, columns: core::ops::Range<usize>) -> bool {
        self.result.has(columns.clone()) && self.truth.has(columns)
    }

    /// Goes through all common instants from the first: time, result, truth.
    ///
    /// # Errors
    /// Those of reading; no instant at all.
    pub fn each(&mut self, mut see: impl FnMut(f64, &Motion, &Motion)) -> Result<Passed> {
        self.result.rewind()?;
        self.truth.rewind()?;
        let (mut count, mut unknown) = (0, 0);
        let mut skip = self.first;
        let only = loop {
            let both = (self.result.next(skip[0])?, self.truth.next(skip[1])?);
            let (Some(result), Some(truth)) = both else {
                break [both.0.is_some(), both.1.is_some()];
            };
            let time_s = self.start_s + (count + unknown) as f64 / self.rate_hz;
            if is_unknown(&result) || is_unknown(&truth) {
                unknown += 1;
            } else {
                see(time_s, &result, &truth);
                count += 1;
            }
            skip = self.skip;
        };
        let mut beyond = only.map(u64::from);
        while only[0] && self.result.next(self.skip[0])?.is_some() {
            beyond[0] += 1;
        }
        while only[1] && self.truth.next(self.skip[1])?.is_some() {
            beyond[1] += 1;
        }
        ensure!(
            count > 0 || unknown == 0,
            "{} and {}: at none of {unknown} common instants is the attitude known (NaN in all ground axes)",
            self.result.path.display(),
            self.truth.path.display()
        );
        if count == 0 {
            return Err(nothing_in_common(&self.result, &self.truth));
        }
        Ok(Passed {
            count,
            unknown,
            beyond,
        })
    }
}
