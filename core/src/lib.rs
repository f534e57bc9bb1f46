#![no_std]
//! The mathematics of a parallel six-axis accelerometer: a cubic mass hung in a shell on nine piezo limbs (9-SPS).
//!
//! Nine voltages in, six accelerations out, once 25 parameters are identified. After You Jingjing, Li Chenggang and
//! Wu Hongtao, *Parameter identification of parallel type six-axis accelerometer*, Optics and Precision Engineering
//! 21(10), 2013; equation numbers are that paper's.
//!
//! | Module | Contents |
//! |---|---|
//! | [`geometry`], [`limb_set`], [`model`], [`parameter`], [`scheme`] | the sensor, its 25 parameters, the settings of a run |
//! | [`paper`] | equations (1) to (11) as printed, but for the sign of (2) |
//! | [`decouple`] | decoupling: sample by sample, along a recording, along eight recordings at once; with excluded limbs; with uncertainties |
//! | [`identify`] | the four steps that find the parameters, and estimators of all or single parameters |
//! | [`redundancy`] | nine limbs, six accelerations: parity relations, self-calibration, detection and exclusion of failed limbs |
//! | `dsp` (feature `alloc`) | filters, detrending, resampling and spectra for recorded channels |
//! | [`recording`] | checks that a recording can be worked with |
//!
//! The decoders of [`decouple`] run on `kernel`, which is hidden from this documentation: the equations of [`paper`] arranged so
//! that nothing is computed twice, over any number type.
//!
//! SI units throughout; each name carries its unit and, where it crosses a boundary, its frame: `_ground` {0},
//! `_shell` {1}, `_mass` {2}. No input or output, no simulator, no std: the decoupler neither allocates nor panics.

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod aided;
mod columns;
pub mod decouple;
#[cfg(feature = "alloc")]
pub mod dsp;
pub mod error;
#[cfg(test)]
mod fixture;
mod float;
pub mod geometry;
pub mod identify;
#[doc(hidden)]
pub mod kernel;
pub mod limb_set;
pub mod model;
pub mod paper;
pub mod parameter;
pub mod recording;
pub mod redundancy;
pub mod scheme;
pub mod significance;
pub mod six_axis;
pub mod unobservable;

pub use decouple::Decoupler;
pub use error::{Error, Result};
pub use geometry::{Geometry, LIMBS};
pub use limb_set::LimbSet;
pub use model::{
    CrossTalk, Gains, InertiaPerMass, LimbLaw, Model, Parameters, Sensor, Settings, StaticResponse,
};
pub use parameter::Parameter;
pub use redundancy::FaultTolerant;
pub use scheme::Scheme;
pub use six_axis::SixAxis;
pub use unobservable::{LostLoad, UnobservableDirections};

/// The README's example, compiled and run with the doc tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

/// The example of docs/microcontroller.md, likewise.
#[cfg(doctest)]
#[doc = include_str!("../../docs/microcontroller.md")]
struct Microcontroller;
