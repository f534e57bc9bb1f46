//! Cleaning of recordings before identification and decoupling: the virtual instrument's preprocessing.
//!
//! In the order in which a recording passes through: [`outlier`] rejection, [`detrend`]ing, the digital filter
//! ([`butterworth`], run forwards and backwards by [`zero_phase`]), and for the standard instruments [`lag`]
//! compensation and the smoothing differentiator [`differentiate`]. Each works on one series, a `&mut [f64]`; an
//! [`crate::Error::NotFinite`] from here has channel 0, because a series does not know whose it is. What knows the
//! sensor (closing a run from rest to rest) is not here but in [`crate::rest_to_rest`].

pub mod butterworth;
pub mod detrend;
pub mod differentiate;
pub mod lag;
pub mod outlier;
pub mod zero_phase;

use crate::error::{Error, Result};

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

fn check_length(what: &'static str, needed: usize, got: usize) -> Result<()> {
    if got < needed {
        return Err(Error::TooFewSamples { what, needed, got });
    }
    Ok(())
}
