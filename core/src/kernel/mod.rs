//! The decoupling equations once, for every number type and every way of running through a recording.
//!
//! A sample passes four stages, one file each. Only the second remembers anything but its neighbours:
//!
//! | stage | from | to | file |
//! |---|---|---|---|
//! | placement | nine voltages | pose of the mass, force and torque of the limbs on it | [`placement`] |
//! | rate | torque | the mass's own rate, integrated | [`rate`] |
//! | shell | three placements and that rate | rate, its derivative, specific force of the shell | [`shell`] |
//! | attitude | two motions of the shell | attitude, by which all is turned to ground axes | [`attitude`] |
//!
//! # Why this is the paper's decoupling
//! (2), (3), (8) and (9) as printed ask for a pose by iteration, a 3 x 3 inverse and the second difference eps inside the
//! integrated equation. Three substitutions, each exact, remove all that: the sensor's signed axes are written out
//! (closed form of the pose, [`placement`]), the state is the mass's own rate in principal axes instead of the shell's
//! ([`rate`]), and lengths and times are counted in limb lengths and sample intervals ([`constants`]). Series in the
//! strain, 1e-5, replace roots and quotients; their dropped terms are below rounding at the rig's accelerations, and a
//! sample for which they would not be goes by the closed form.
//!
//! The version with none of this, as one writes it down from the paper, is [`crate::paper::Decoder`]; tests hold the two
//! together.

pub mod attitude;
pub mod channel_mask;
pub mod constants;
pub mod number;
pub mod order;
#[cfg(any(target_feature = "avx", all(feature = "std", target_arch = "x86_64")))]
mod packed_vec3;
pub mod parity;
pub mod placement;
pub mod rate;
pub mod reconstruct;
pub mod shell;
pub mod simd;
pub mod vec3;
pub mod weights;
pub mod wider;
