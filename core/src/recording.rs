//! Whether a recording can be worked with at all: what is wrong with it is said before anything is computed from it.

use crate::error::{Error, Result};
use crate::geometry::LIMBS;

/// Departure of a time step from the sample rate's, as a share of it, that still passes: a converter's clock is good to
/// 1e-4, a time column printed with a digit too few is not.
pub const STEP_TOLERANCE: f64 = 1e-2;

/// Checks that time stamps advance evenly at the sample rate.
///
/// # Errors
/// [`Error::OutOfRange`] for a sample rate that is not positive and finite, or so small that its step is not;
/// [`Error::NotFinite`] (channel 0) for a first stamp that is not finite; [`Error::IrregularTime`] at the first later one
/// that is not, does not increase, or departs from the step by more than [`STEP_TOLERANCE`].
pub fn check_time_stamps(time_s: &[f64], sample_rate_hz: f64) -> Result<()> {
    let expected_step_s = 1.0 / sample_rate_hz;
    // Against an infinite step any stamp would be regular.
    if !(sample_rate_hz.is_finite() && sample_rate_hz > 0.0 && expected_step_s.is_finite()) {
        return Err(Error::OutOfRange {
            name: "sample_rate_hz",
            value: sample_rate_hz,
            requirement: "positive and finite, and its step, too",
        });
    }
    if let Some(&value) = time_s.first()
        && !value.is_finite()
    {
        return Err(Error::NotFinite {
            channel: 0,
            sample: 0,
            value,
        });
    }
    for (i, pair) in time_s.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        // Written so that NaN is irregular, too.
        let regular = (step - expected_step_s).abs() <= STEP_TOLERANCE * expected_step_s;
        if !regular {
            return Err(Error::IrregularTime {
                sample: i + 1,
                time_s: pair[1],
                previous_s: pair[0],
                expected_step_s,
            });
        }
    }
    Ok(())
}

/// Checks nine channels recorded during a motion.
///
/// `limit_v` is the converter's limit (infinite if it has none), V.
///
/// # Errors
/// [`Error::OutOfRange`] for a limit that is not positive; [`Error::TooFewSamples`] below two samples;
/// [`Error::NotFinite`], [`Error::Clipped`] at the first offending sample;
/// [`Error::DeadChannel`] for a channel that reads one and the same value throughout while another moves.
pub fn check_channels(voltage_v: &[[f64; LIMBS]], limit_v: f64) -> Result<()> {
    // Written so that NaN, which nothing reaches, is refused, too.
    let has_a_limit = limit_v > 0.0;
    if !has_a_limit {
        return Err(Error::OutOfRange {
            name: "limit_v",
            value: limit_v,
            requirement: "positive",
        });
    }
    let [first, rest @ ..] = voltage_v else {
        return too_few(0);
    };
    if rest.is_empty() {
        return too_few(1);
    }
    let mut moves = [false; LIMBS];
    for (sample, row) in voltage_v.iter().enumerate() {
        for (i, &value) in row.iter().enumerate() {
            if !value.is_finite() {
                return Err(Error::NotFinite {
                    channel: i + 1,
                    sample,
                    value,
                });
            }
            if value.abs() >= limit_v {
                return Err(Error::Clipped {
                    channel: i + 1,
                    sample,
                    limit_v,
                });
            }
            moves[i] |= value != first[i];
        }
    }
    match moves.iter().position(|m| !m) {
        Some(i) if moves.contains(&true) => Err(Error::DeadChannel {
            channel: i + 1,
            value_v: first[i],
            samples: voltage_v.len(),
        }),
        _ => Ok(()),
    }
}

fn too_few(got: usize) -> Result<()> {
    Err(Error::TooFewSamples {
        what: "recording",
        needed: 2,
        got,
    })
}
