//! Equations (1) to (11) of the paper.

pub mod attitude;
pub mod limb_stream;
pub mod pose;
pub mod preload;
pub mod signal;
pub mod wrench;
