//! Digital signal processing of recorded channels: the virtual instrument's preprocessing.
//!
//! | stage | over a stream | over a whole record |
//! |---|---|---|
//! | rejection of wild samples | [`outlier::Hampel`] | [`outlier::hampel`] |
//! | channels brought to one instant | [`delay::Delay`] | [`delay::delayed`] |
//! | an amplifier's high-pass undone | [`lag::UndoHighPass`] | [`lag::undo_high_pass`] |
//! | offset and trend | | [`detrend`] |
//! | low-pass without phase, ends as SciPy's | [`zero_phase::ZeroPhase`] | [`zero_phase::zero_phase`] |
//! | low-pass without phase, ends without the noise of single samples | [`continued::ContinuedZeroPhase`] | [`continued::zero_phase`] |
//! | low-pass forwards only | [`causal::Causal`] | |
//! | an instrument's low-pass undone, derivative | | [`lag::undo_low_pass`], [`differentiate`] |
//! | power spectrum | [`spectrum::Welch`] | [`spectrum::welch`] |
//!
//! Where there are both, the whole record is pushed through the stream's code ([`stage::Stage`]). [`butterworth`] designs the
//! filters, [`resample`] reads a record on another clock, [`spectrum::noise_floor`] estimates the noise under a motion, and
//! [`transposed`] has the linear stages' transposes: what each raw sample weighs in what is computed from the clean ones.
//!
//! A stage works on one evenly sampled series in any unit. A series does not know its channel: an [`Error::NotFinite`] or
//! [`Error::Overflow`] from a stage has channel 0, until [`each_channel`] puts the number in. What knows the sensor (closing a
//! run from rest to rest) is in [`crate::decouple::rest_to_rest`].

use alloc::vec;

pub mod butterworth;
pub mod causal;
pub mod continued;
pub mod delay;
pub mod detrend;
pub mod differentiate;
pub mod lag;
pub mod outlier;
pub mod resample;
pub mod spectrum;
pub mod stage;
pub mod transposed;
pub mod zero_phase;

use crate::error::{Error, Result};

/// Runs a stage over each channel of a recording held as rows of one sample each.
///
/// # Errors
/// The stage's, with the channel, from 1, in an [`Error::NotFinite`] or [`Error::Overflow`]. The channels before it are done, it and those
/// after it unchanged.
pub fn each_channel<const N: usize>(
    rows: &mut [[f64; N]],
    mut stage: impl FnMut(&mut [f64]) -> Result<()>,
) -> Result<()> {
    let mut series = vec![0.0; rows.len()];
    for channel in 0..N {
        for (x, row) in series.iter_mut().zip(rows.iter()) {
            *x = row[channel];
        }
        stage(&mut series).map_err(|error| match error {
            Error::NotFinite { sample, value, .. } => Error::NotFinite {
                channel: channel + 1,
                sample,
                value,
            },
            Error::Overflow { what, sample, .. } => Error::Overflow {
                what,
                channel: channel + 1,
                sample,
            },
            other => other,
        })?;
        for (x, row) in series.iter().zip(rows.iter_mut()) {
            row[channel] = *x;
        }
    }
    Ok(())
}

fn check_finite(series: &[f64]) -> Result<()> {
    match series.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(sample) => Err(Error::NotFinite {
            channel: 0,
            sample,
            value: series[sample],
        }),
    }
}

/// Refuses what a stage has made of finite samples if it is not finite itself.
fn check_answer(what: &'static str, answer: impl IntoIterator<Item = f64>) -> Result<()> {
    match answer.into_iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(sample) => Err(Error::overflow(what, sample)),
    }
}
