//! Detection and isolation of failed limbs from the three parity rows.
//!
//! A sample flows through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`class`] | the six directions that nine limbs fail along |
//! | [`noise`] | the covariance of the rows; whitening |
//! | [`moments`] | sums over a stretch of whitened rows |
//! | [`detector`] | whether: tests, thresholds, alarms |
//! | [`isolation`] | which: evidence for each class |
//! | [`swap`] | evidence for each swapped pair |
//! | [`history`], [`step`] | the course of the failure and of each channel |
//! | [`kind`] | how, and which of two twins |
//! | [`gathering`] | what is asked when, until class, kind and limb are known |
//! | [`verdict`] | what is said of it |
//! | [`monitor`] | all of it as a stream |

pub mod class;
pub mod detector;
pub mod gathering;
pub mod history;
pub mod isolation;
pub mod kind;
pub mod moments;
pub mod monitor;
pub mod noise;
pub mod step;
pub mod swap;
pub mod verdict;

pub use detector::{Alarm, CalibrationErrors, Detector, Test};
pub use monitor::{Event, Monitor, Watch};
pub use noise::RowNoise;
pub use verdict::{Kind, Verdict};
