//! Whether a recording can be worked with at all: what is wrong with it is said before anything is computed from it.

use crate::error::{Error, Result, require};
use crate::geometry::LIMBS;

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
    require(has_a_limit, "limit_v", limit_v, "positive")?;
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
