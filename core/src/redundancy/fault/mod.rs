//! Detection and isolation of failed limbs from the three parity rows.
//!
//! A sample passes through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`strains`] | strains of nine voltages, each limb giving way by its own stiffness |
//! | [`class`] | the six directions in the parity rows along which nine limbs fail |
//! | [`noise`] | the covariance of the rows, their whitening, and the relations that excluded limbs leave |
//! | [`moments`], [`window`] | sums over a stretch of whitened rows, and what calibration's errors add to them |
//! | [`calibration_errors`] | the errors that calibration leaves, by themselves and in an energy |
//! | [`detector`] | detection: tests, thresholds, alarms |
//! | [`held`] | channels that stand still to the last bit |
//! | [`misfit`] | what a hypothesis leaves of the rows |
//! | [`likelihood`] | the likelihood of a failure of each class |
//! | [`swap`] | the likelihood that two channels are exchanged |
//! | [`silent`] | sets of two or three limbs that are dead at once |
//! | [`history`], [`step`] | statistics of the failure's course and of each channel |
//! | [`kind`] | the kind of failure, and the limb among those that share a signature |
//! | [`isolation`] | the sequence of decisions after an alarm: hypotheses, kind, limb |
//! | [`verdict`] | events, and the result of an isolation |
//! | [`recovery`] | when a failure is over |
//! | `untold` | a failure of which it cannot be told which limbs it is |
//! | [`settings`] | what the monitor is told of noise and of calibration's errors |
//! | [`monitor`] | all of it as a stream |

mod calibration_errors;
pub mod class;
pub mod detector;
mod held;
pub mod history;
pub mod isolation;
pub mod kind;
pub mod likelihood;
mod misfit;
pub mod moments;
pub mod monitor;
pub mod noise;
mod recovery;
mod settings;
mod silent;
pub mod step;
mod strains;
pub mod swap;
mod untold;
pub mod verdict;
mod window;

pub use calibration_errors::CalibrationErrors;
pub use detector::{Alarm, Detector, Test};
pub use monitor::{Event, Monitor, Watch};
pub use noise::RowNoise;
pub use verdict::{Kind, Verdict};
