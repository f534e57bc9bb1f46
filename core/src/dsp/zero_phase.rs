//! A filter run forwards and then backwards over a record: no phase, the square of the gain.

use alloc::vec::Vec;

use super::butterworth::Section;
use super::{check_answer, check_finite, check_length};
use crate::error::Result;

/// Samples by which a record is extended at either end: three times the filter's length, SciPy's default.
#[must_use]
pub fn padding(sections: &[Section]) -> usize {
    let first_order = sections
        .iter()
        .filter(|s| s.b[2] == 0.0 && s.a[1] == 0.0)
        .count();
    3 * (2 * sections.len() + 1 - first_order.min(1))
}

/// Filters `series` in place without phase. Equals SciPy's `sosfiltfilt` with its defaults: odd extension by
/// [`padding`] samples, each pass starting in the steady state of its first sample.
///
/// Against SciPy 1e-13 of the peak at ordinary corners (test `ref_scipy_zero_phase`). At order 8 and a corner of 5e-4
/// of the sample rate rounding shows: 2.3e-12 of the peak from the same filter in 50 digits, SciPy 2.5e-11 (test
/// `ref_exact_narrow_zero_phase`). The samples within about one period of the corner from either end rest on the
/// extension, not on the record.
///
/// # Errors
/// [`crate::Error::TooFewSamples`] unless the series is longer than [`padding`], [`crate::Error::NotFinite`];
/// [`crate::Error::Overflow`] for samples too large, or sections without a static gain or a stable pole.
pub fn zero_phase(sections: &[Section], series: &mut [f64]) -> Result<()> {
    let pad = padding(sections);
    check_length("zero-phase filter", pad + 1, series.len())?;
    check_finite(series)?;
    let n = series.len();
    let (first, last) = (series[0], series[n - 1]);
    let mut extended = Vec::with_capacity(n + 2 * pad);
    extended.extend((1..=pad).rev().map(|i| 2.0 * first - series[i]));
    extended.extend_from_slice(series);
    extended.extend((1..=pad).map(|i| 2.0 * last - series[n - 1 - i]));
    for _ in 0..2 {
        pass(sections, &mut extended);
        extended.reverse();
    }
    check_answer("zero-phase filter", extended[pad..pad + n].iter().copied())?;
    series.copy_from_slice(&extended[pad..pad + n]);
    Ok(())
}

fn pass(sections: &[Section], series: &mut [f64]) {
    for section in sections {
        let mut state = section.settled(series[0]);
        for x in series.iter_mut() {
            *x = section.step(&mut state, *x);
        }
    }
}
