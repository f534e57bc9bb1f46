//! From a session's recordings to 25 parameters, their intervals and a verdict.
//!
//! What a laboratory has is a folder of recordings and knowledge that is in no recording: which wedge was under the sensor,
//! which range the amplifier was switched to, what the standard instruments' certificates say. The session file
//! ([`sixaxis_recordings::session`]) holds the latter. From there data flow through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`trial`] | one recording in SI units on one clock |
//! | [`load`] | trials from files |
//! | [`conditioning`] | the preprocessing that the session asks for |
//! | [`steps`] | the four steps, first pass, repeated, on some of the trials |
//! | [`iteration`] | steps 2 to 4 repeated until k/m stands still, or it is clear that it will not |
//! | [`rigid`] | what nine channels should show of a known motion |
//! | [`response`] | what each channel did show in each trial |
//! | [`suspicion`] | what is wrong, named |
//! | [`joint`] | all 25 at once, with what the session knows beforehand |
//! | [`certified`] | a normal error and one that a certificate bounds, together |
//! | [`tap`] | k/m from blows on the shell |
//! | [`propagation`] | the instruments' errors through the four steps, in closed form |
//! | [`interval`] | how well each parameter is known, and what limits it |
//! | [`verdict`] | all of it judged |
//! | [`calibration`] | the result as a file |
//! | [`apply`] | recordings decoupled with that file |
//! | [`compare`] | a decoupled motion against the truth |
//! | [`page`] | the pages of a calibration and of a comparison |

pub mod apply;
pub mod calibration;
pub mod certified;
pub mod compare;
pub mod conditioning;
pub mod error;
pub mod interval;
pub mod iteration;
pub mod joint;
pub mod load;
pub mod page;
pub mod propagation;
pub mod response;
pub mod rigid;
pub mod steps;
pub mod suspicion;
pub mod tap;
pub mod trial;
pub mod verdict;

pub use error::{Error, Result};
