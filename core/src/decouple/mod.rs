//! Nine voltages in, six accelerations out: section 2 of the paper, at the speed of [`crate::kernel`].
//!
//! [`Decoupler`] takes one sample at a time; [`record`] runs it along a recording, [`lanes`] along eight recordings at once, with
//! the same answers but for rounding. Each of them works with limbs excluded. [`decouple`] decodes a recording that lies in memory,
//! [`rest_to_rest`] takes the trend off a run that ends as it began, [`uncertainty`] runs beside a stream and says how well each
//! sample is known.

pub mod lanes;
pub mod record;
#[cfg(feature = "alloc")]
pub mod rest_to_rest;
pub mod stream;
pub mod uncertainty;

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

pub use stream::Decoupler;

#[cfg(feature = "alloc")]
use crate::error::Result;
#[cfg(feature = "alloc")]
use crate::geometry::LIMBS;
#[cfg(feature = "alloc")]
use crate::model::{Parameters, Sensor, Settings};
#[cfg(feature = "alloc")]
use crate::six_axis::SixAxis;

/// Decodes a recording, nine voltages a row, V: elements belong to samples 1, 2, ... of it.
///
/// # Errors
/// Those of [`Decoupler::new`] and [`Decoupler::push`].
#[cfg(feature = "alloc")]
pub fn decouple(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    voltage_v: &[[f64; LIMBS]],
) -> Result<Vec<SixAxis>> {
    let mut answers = Vec::with_capacity(voltage_v.len());
    Decoupler::new(sensor, parameters, settings)?
        .push_all(voltage_v, |sample| answers.push(*sample))?;
    Ok(answers)
}
