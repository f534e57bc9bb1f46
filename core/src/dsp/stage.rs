//! A stage of one channel, over a stream or over a whole record by the same code.

use alloc::vec::Vec;

use crate::error::Result;

/// A stage that takes the samples of one channel as they come.
///
/// It gives as many samples as it takes, in their order, each as soon as the samples that it rests on are there; how the stream
/// is cut does not change a bit of them. A stage does not look for NaN or infinity, which those with a memory keep for good:
/// [`whole`] refuses them beforehand, a stream's caller has to.
pub trait Stage {
    /// Takes the next samples and appends to `out` those that are ready.
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>);

    /// Ends the record and appends the samples that were waiting for more.
    ///
    /// # Errors
    /// [`crate::Error::TooFewSamples`] for a record too short for the stage.
    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()>;
}

/// A whole record through a stage, in place; `what` is the stage's name in errors.
///
/// # Errors
/// Those of [`Stage::finish`], [`crate::Error::NotFinite`] for a sample, [`crate::Error::Overflow`] for what the stage makes of
/// finite ones. The record is then unchanged.
pub fn whole(what: &'static str, stage: &mut impl Stage, series: &mut [f64]) -> Result<()> {
    super::check_finite(series)?;
    let mut out = Vec::with_capacity(series.len());
    stage.push(series, &mut out);
    stage.finish(&mut out)?;
    super::check_answer(what, out.iter().copied())?;
    series.copy_from_slice(&out);
    Ok(())
}
