//! From a session's recordings to 25 parameters, their intervals and a grade; and from a recording to accelerations.
//!
//! What a laboratory has is a folder of recordings and knowledge that is in no recording: which wedge was under the sensor,
//! which range the amplifier was switched to, what the standard instruments' certificates say. The session file
//! ([`sixaxis_recordings::session`]) holds the latter. One pipeline, [`calibrate`](mod@calibrate), leads from there to a
//! calibration, through these files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`trial`] | one recording in SI units on one clock |
//! | [`conditioning`] | what is done to recordings beforehand, in one order |
//! | [`drive`] | the frequency that the session states against the one that was recorded |
//! | `frequency` | the frequency of a drive, as a series shows it |
//! | `set_aside` | copies of other trials, trials with absurd readings, and trials that are not whole |
//! | [`reference_clock`] | standards in files of their own, whose clock runs a little otherwise |
//! | [`prepare`] | a session's recordings, sorted and conditioned |
//! | [`response`] | what each channel shows of a known motion |
//! | [`diagnosis`] | what is wrong, named as [`finding`]s |
//! | [`steps`], [`iteration`] | the paper's four steps, once and repeated |
//! | [`propagation`], [`interval`] | how well each parameter is known, and what limits it |
//! | [`tap`] | k/m from taps on the shell |
//! | [`joint`], [`gain_prior`] | all 25 parameters at once, with what the session knows beforehand |
//! | [`estimate`](mod@estimate) | both estimators on a prepared session |
//! | [`grade`](mod@grade) | good, good with reservations, not good |
//! | [`report`], [`calibration`] | the result as plain data and as a file |
//! | `series` | small statistics of a series |
//! | [`apply`] | recordings decoupled with that file |
//! | [`compare`] | a decoupled motion against the truth |
//! | [`page`] | the pages of a calibration and of a comparison |

pub mod apply;
pub mod calibrate;
pub mod calibration;
pub mod compare;
pub mod conditioning;
pub mod diagnosis;
pub mod drive;
pub mod error;
pub mod estimate;
pub mod finding;
mod frequency;
pub mod gain_prior;
pub mod grade;
pub mod interval;
pub mod iteration;
pub mod joint;
pub mod page;
pub mod prepare;
pub mod progress;
pub mod propagation;
pub mod reference_clock;
pub mod report;
pub mod response;
pub mod self_calibrate;
mod series;
mod set_aside;
pub mod steps;
pub mod tap;
pub mod trial;

pub use error::{Error, Result};
