//! What becomes of the instruments' errors: through the four steps, and on to every decoupled acceleration.
//!
//! The paper leaves this to another study. To first order everything is linear in every raw sample, so that nothing has to
//! be drawn at random:
//!
//! | file | holds |
//! |---|---|
//! | [`influence`] | how an estimate answers to a change of one of its rows: steps 2, 3 and 4 |
//! | [`parameters`] | the chain: each step uses the earlier ones, and their errors with them |
//! | [`error_model`] | what errors of parameters and rate do to force and torque at once |
//! | [`samples`] | the stream: the accelerations' standard deviations, sample by sample |
//! | [`zero_wander`] | what undoing amplifiers' high-pass makes of noise |
//!
//! The preprocessing between raw samples and rows is linear, too; its transposes are in `dsp::transposed`.
//!
//! First order leaves out what noise does twice: it biases an estimate by the square of the noise over the signal, 1e-6 at
//! 60 dB. Compliance enters where noise is differentiated twice, and not in the sensitivities, which it changes by some
//! six millionths at 5 Hz.

pub mod error_model;
pub mod influence;
pub mod parameters;
mod root;
pub mod samples;
pub mod zero_wander;

pub use error_model::{ChannelNoise, ErrorModel};
pub use parameters::{Chain, Covariance};
pub use samples::{SampleUncertainty, Spread};
pub use zero_wander::ZeroWander;
