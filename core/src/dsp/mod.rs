//! Cleaning of recordings before identification and decoupling: the virtual instrument's preprocessing.
//!
//! In the order in which a recording passes through: [`outlier`] rejection, because one wild value bends every later
//! stage; [`resample`] onto one clock, where the channels were not taken at the same instants; [`detrend`]ing, because
//! a filter answers an offset with a transient at the ends; the digital filter ([`butterworth`], run forwards and
//! backwards by [`zero_phase`] or live by [`stream`]); and for the standard instruments [`lag`] compensation and the
//! smoothing differentiator [`differentiate`]. At any point [`spectrum`] says what of a record is noise.
//! [`transposed`] reads the linear stages backwards: what each raw sample weighs in what is computed from the clean ones.
//!
//! Each stage works on one series, a `&mut [f64]`, evenly sampled, in any unit. A series does not know whose it is: an
//! [`Error::NotFinite`] or [`Error::Overflow`] from a stage has channel 0, until [`each_channel`] puts the number in. What knows the sensor
//! (closing a run from rest to rest) is not here but in [`crate::decouple::rest_to_rest`].

use alloc::vec;

pub mod butterworth;
pub mod detrend;
pub mod differentiate;
pub mod lag;
pub mod outlier;
pub mod resample;
pub mod spectrum;
pub mod stream;
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
        Some(sample) => Err(Error::Overflow {
            what,
            channel: 0,
            sample,
        }),
    }
}

fn check_length(what: &'static str, needed: usize, got: usize) -> Result<()> {
    if got < needed {
        return Err(Error::TooFewSamples { what, needed, got });
    }
    Ok(())
}
