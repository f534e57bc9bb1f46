//! From one clock to another: the cubic spline through a series, read at any time.
//!
//! Two recorders side by side have two clocks, a laboratory's time stamps jitter, and a multiplexed converter takes
//! its channels one after the other. Identification and decoupling want all channels at the same instants.
//!
//! The spline goes through every sample, noise included. Halfway between two samples it reads a sine of frequency f and
//! sample rate F too small by about (2 pi f/F)^4/384 of its amplitude, elsewhere by less, without phase (test
//! `order_spline`). Largest errors, of the amplitude (test `inv_sine_read_between_samples`):
//!
//! | f/F | inside the record | in its first and last step |
//! |---|---|---|
//! | 1/100 | 4.1e-8 | 4.5e-7 |
//! | 1/20 | 2.7e-5 | 2.8e-4 |
//! | 1/10 | 4.5e-4 | 4.5e-3 |
//!
//! What an end or a wild sample does to the spline falls by a factor of 2 + sqrt 3 = 3.7 from sample to sample (test
//! `inv_influence_of_a_sample_falls_by_two_plus_root_three`). Nothing here is a filter: on the way to a slower clock,
//! what lies above half of its rate must be taken out first ([`super::zero_phase`]).

use alloc::vec::Vec;

use super::{check_answer, check_finite};
use crate::error::{Error, Result, require_positive, require_samples};

/// Fewest samples through which a not-a-knot spline is one: below, the conditions at the two ends are the same.
pub const MIN_SAMPLES: usize = 4;

/// How far, in roundings of the record's length, a computed time may lie outside an even record and still mean its
/// first or last sample: k/F and k (1/F) differ by as much.
const END_ROUNDINGS: f64 = 4.0;

/// Where the samples lie.
#[derive(Debug, Clone, PartialEq)]
enum Clock {
    /// Sample k at k/rate.
    Even { sample_rate_hz: f64 },
    /// Each sample at its stamp; `step_s` is the mean step.
    Stamped { times_s: Vec<f64>, step_s: f64 },
}

/// The twice continuously differentiable piecewise cubic through a series, whose first two and last two pieces are one
/// cubic each (not-a-knot).
///
/// Equals SciPy's `CubicSpline` with its defaults to 2e-15 of the peak, on even samples and on uneven ones (measured; test
/// `ref_scipy_spline` allows more). Exact for cubics. Setting up takes time in proportion to the samples; reading allocates nothing
/// and takes one search among the stamps, on even samples none.
#[derive(Debug, Clone, PartialEq)]
pub struct CubicSpline {
    clock: Clock,
    values: Vec<f64>,
    /// Second derivative at each sample, per square of the (mean) step.
    curvatures: Vec<f64>,
}

impl CubicSpline {
    /// Through evenly taken samples, the first at time 0, sample k at k/`sample_rate_hz`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a sample rate that is not positive and finite, [`Error::TooFewSamples`] below
    /// [`MIN_SAMPLES`], [`Error::NotFinite`], [`Error::Overflow`].
    pub fn even(values: &[f64], sample_rate_hz: f64) -> Result<Self> {
        require_positive("sample_rate_hz", sample_rate_hz)?;
        Ok(Self {
            curvatures: curvatures(|_| 1.0, values)?,
            clock: Clock::Even { sample_rate_hz },
            values: values.to_vec(),
        })
    }

    /// Through samples at the given times, s, each later than the one before.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] unless there is one time stamp for each value; [`Error::IrregularTime`] for a stamp
    /// that is not finite or not later than the one before, where the expected step is the record's mean;
    /// [`Error::TooFewSamples`] below [`MIN_SAMPLES`]; [`Error::NotFinite`] for a value; [`Error::Overflow`], also
    /// where one step is so small beside the mean that no f64 holds the curvature.
    pub fn through(times_s: &[f64], values: &[f64]) -> Result<Self> {
        if times_s.len() != values.len() {
            return Err(Error::LengthMismatch {
                what: "time stamps",
                expected: values.len(),
                got: times_s.len(),
            });
        }
        require_samples("spline", MIN_SAMPLES, values.len())?;
        let step_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1) as f64;
        let advances = |pair: &[f64]| pair[1] > pair[0] && (pair[1] - pair[0]).is_finite();
        if let Some(before) = times_s.windows(2).position(|pair| !advances(pair)) {
            return Err(Error::IrregularTime {
                sample: before + 1,
                time_s: times_s[before + 1],
                previous_s: times_s[before],
                expected_step_s: step_s,
            });
        }
        // In mean steps, so that no square or product of steps leaves the range of f64 for the unit's sake.
        let step = |i: usize| (times_s[i + 1] - times_s[i]) / step_s;
        Ok(Self {
            curvatures: curvatures(step, values)?,
            clock: Clock::Stamped {
                times_s: times_s.to_vec(),
                step_s,
            },
            values: values.to_vec(),
        })
    }

    /// The spline at a time, s. At a sample's own time its value, to the last bit if stamped and to the rounding of the
    /// time if even.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time outside the record (NaN included): a cubic past its last sample soon shows
    /// anything. [`Error::Overflow`] with the sample before that time.
    pub fn at(&self, time_s: f64) -> Result<f64> {
        let (index, share, step) = self.place(time_s).ok_or(Error::out_of_range(
            "time_s",
            time_s,
            "within the record, from its first to its last sample",
        ))?;
        let value = self.piece(index, share, step);
        if !value.is_finite() {
            return Err(Error::overflow("spline", index));
        }
        Ok(value)
    }

    /// The spline at each of the given times, s, in any order: the series on another clock.
    ///
    /// # Errors
    /// As [`Self::at`], of the first time refused.
    pub fn at_each(&self, times_s: &[f64]) -> Result<Vec<f64>> {
        times_s.iter().map(|&time_s| self.at(time_s)).collect()
    }

    /// The piece in which a time lies: sample before it, share of the step passed, length of the step in mean steps.
    fn place(&self, time_s: f64) -> Option<(usize, f64, f64)> {
        let last = self.values.len() - 1;
        match &self.clock {
            Clock::Even { sample_rate_hz } => {
                let (index, share) = self.even_place(time_s * sample_rate_hz)?;
                Some((index, share, 1.0))
            }
            Clock::Stamped { times_s, step_s } => {
                if !(times_s[0]..=times_s[last]).contains(&time_s) {
                    return None;
                }
                let after = times_s.partition_point(|&t| t <= time_s).min(last);
                let (from_s, to_s) = (times_s[after - 1], times_s[after]);
                let share = (time_s - from_s) / (to_s - from_s);
                Some((after - 1, share, (to_s - from_s) / step_s))
            }
        }
    }

    /// The piece and the share of it passed at a position counted in even steps.
    fn even_place(&self, position: f64) -> Option<(usize, f64)> {
        let last = (self.values.len() - 1) as f64;
        let slack = END_ROUNDINGS * f64::EPSILON * last;
        if !(-slack..=last + slack).contains(&position) {
            return None;
        }
        let inside = position.clamp(0.0, last);
        let index = (inside as usize).min(self.values.len() - 2);
        Some((index, inside - index as f64))
    }

    fn piece(&self, index: usize, share: f64, step: f64) -> f64 {
        let rest = 1.0 - share;
        let line = rest * self.values[index] + share * self.values[index + 1];
        let bend =
            (1.0 + rest) * self.curvatures[index] + (1.0 + share) * self.curvatures[index + 1];
        // The step's square last and in two: it may be far larger or smaller than what it weighs.
        line - share * rest / 6.0 * (bend * step * step)
    }
}

/// Second derivatives at the samples of the not-a-knot spline; `step(i)` lies between samples i and i + 1.
///
/// For those of the inner samples there is one equation each, tridiagonal, once the two of the end samples are replaced
/// by the straight lines that not-a-knot makes of them. Each row is then dominated by its diagonal, whatever the steps:
/// elimination without exchange of rows loses nothing.
fn curvatures(step: impl Fn(usize) -> f64, values: &[f64]) -> Result<Vec<f64>> {
    require_samples("spline", MIN_SAMPLES, values.len())?;
    check_finite(values)?;
    let last = values.len() - 1;
    let slope = |i: usize| (values[i + 1] - values[i]) / step(i);
    // Of each row after elimination: weight of the next unknown, and right side, which becomes the solution.
    let mut next_weights = Vec::with_capacity(values.len());
    let mut solution = Vec::with_capacity(values.len());
    next_weights.push(0.0);
    solution.push(0.0);
    for i in 1..last {
        let (before, after) = (step(i - 1), step(i));
        let mut weights = (before, 2.0 * (before + after), after);
        if i == 1 {
            weights.1 = (before + after) * (before + 2.0 * after) / after;
            weights.2 = (after - before) * (after + before) / after;
        }
        if i == last - 1 {
            weights.0 = (before - after) * (before + after) / before;
            weights.1 = (before + after) * (after + 2.0 * before) / before;
        }
        let (from_before, own, to_next) = weights;
        // The end samples' curvatures are in the weights already.
        let coupled = if i == 1 { 0.0 } else { from_before };
        let pivot = own - coupled * next_weights[i - 1];
        let right = 6.0 * (slope(i) - slope(i - 1));
        next_weights.push(to_next / pivot);
        solution.push((right - coupled * solution[i - 1]) / pivot);
    }
    for i in (1..last - 1).rev() {
        solution[i] -= next_weights[i] * solution[i + 1];
    }
    let beyond = |near: f64, far: f64, step_out: f64, step_in: f64| {
        near + (near - far) * (step_out / step_in)
    };
    solution[0] = beyond(solution[1], solution[2], step(0), step(1));
    let (end, inside) = (solution[last - 1], solution[last - 2]);
    solution.push(beyond(end, inside, step(last - 1), step(last - 2)));
    check_answer("spline", solution.iter().copied())?;
    Ok(solution)
}
