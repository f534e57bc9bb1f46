//! What the three redundant channels are good for: nine limbs, six accelerations.
//!
//! [`parity`] has the three relations that the limb forces of any motion obey, [`reconstruction`] the strains of excluded limbs,
//! [`self_calibration`] eight of the nine scale ratios without a reference, [`fault`] a monitor that detects and isolates a
//! failed limb, and [`tolerant`] a decoupler that excludes it.

pub mod fault;
pub mod parity;
pub mod reconstruction;
mod residual;
pub mod self_calibration;
pub mod tolerant;

pub use residual::residual;
pub use tolerant::FaultTolerant;
