#![no_std]
//! The mathematics of a parallel six-axis accelerometer: a cubic mass hung in a shell on nine piezo limbs (9-SPS).
//!
//! Nine voltages in, six accelerations out, once 25 parameters are identified. After You Jingjing, Li Chenggang and
//! Wu Hongtao, *Parameter identification of parallel type six-axis accelerometer*, Optics and Precision Engineering
//! 21(10), 2013; equation numbers are that paper's.
//!
//! The modules follow a voltage on its way through the sensor: [`geometry`] and [`parameters`] say what the sensor
//! is, [`settings`] what else is known; [`signal`] turns voltages into limb forces, [`preload`] adds the static share a
//! piezo hides, [`pose`] turns forces into the mass's place in the shell, and [`limbs`] is these three as a stream:
//! the plain formulas, on which [`dynamics`] sums forces and [`identify`] runs the four steps that find the parameters.
//!
//! Decoupling itself is [`kernel`]: the same equations once more, arranged so that nothing is computed twice, over any
//! number type. [`decoupler`] runs them sample by sample, [`record`] along a recording, [`lanes`] along eight at once, and
//! [`rigid`] without the motion of the mass in the shell; [`scheme`] names the integrators.
//!
//! [`parity`] is what nine limbs say more than six: the coordination equations, and which limbs can be done without.
//! [`self_calibration`] has eight of nine scale ratios from them, without any reference.
//!
//! [`fault`] watches the parity rows: that a limb has failed, which, and how; [`fault_tolerant`]
//! decouples on without it.
//!
//! [`uncertainty`] says how well the parameters and each decoupled sample are known.
//!
//! Before either, [`recording`] says whether a recording can be worked with, and `preprocess` (feature `alloc`) cleans
//! it; `rest_to_rest` takes the trend off a run that ends as it began.
//!
//! SI units throughout; each name carries its unit and, where it crosses a boundary, its frame: `_ground` {0},
//! `_shell` {1}, `_mass` {2}. No input or output, no simulator, no std: the decoupler neither allocates nor panics.

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod attitude;
pub mod decoupler;
pub mod dynamics;
pub mod error;
pub mod fault;
pub mod fault_tolerant;
pub mod geometry;
pub mod identify;
pub mod kernel;
pub mod lanes;
pub mod limbs;
pub mod parameters;
pub mod parity;
pub mod pose;
pub mod preload;
#[cfg(feature = "alloc")]
pub mod preprocess;
pub mod record;
pub mod recording;
#[cfg(feature = "alloc")]
pub mod rest_to_rest;
pub mod rigid;
mod scalar;
pub mod scheme;
pub mod self_calibration;
pub mod settings;
pub mod signal;
pub mod significance;
pub mod uncertainty;

pub use decoupler::{Decoupler, SixAxis};
pub use error::{Error, Result};
pub use fault_tolerant::FaultTolerant;
pub use geometry::{Geometry, LIMBS};
pub use parameters::{InertiaPerMass, Parameters};
pub use parity::LimbSet;
pub use pose::LimbLaw;
pub use rigid::RigidDecoupler;
pub use scheme::Scheme;
pub use settings::{Sensor, Settings, StaticResponse};
pub use signal::Gains;

/// The README's example, compiled and run with the doc tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
