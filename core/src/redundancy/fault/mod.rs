//! Detection and isolation of failed limbs from the three parity rows.
//!
//! A sample passes through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`class`] | the six directions in the parity rows along which nine limbs fail |
//! | [`noise`] | the covariance of the rows, and their whitening |
//! | [`moments`] | sums over a stretch of whitened rows |
//! | [`detector`] | detection: tests, thresholds, alarms |
//! | [`likelihood`] | the likelihood of a failure of each class |
//! | [`swap`] | the likelihood that two channels are exchanged |
//! | [`history`], [`step`] | statistics of the failure's course and of each channel |
//! | [`kind`] | the kind of failure, and the limb of an ambiguous pair |
//! | [`isolation`] | the sequence of decisions after an alarm: class, kind, limb |
//! | [`verdict`] | the result of an isolation |
//! | [`monitor`] | all of it as a stream |

pub mod class;
pub mod detector;
pub mod history;
pub mod isolation;
pub mod kind;
pub mod likelihood;
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
