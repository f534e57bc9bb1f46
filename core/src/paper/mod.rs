//! Section 2 of the paper as printed, in the order in which a voltage passes it: equations (1) to (11), but for the sign of (2).
//!
//! | module | equation | from | to |
//! |---|---|---|---|
//! | [`signal`] | (10), (1), (11) | nine voltages, V | limb forces per mass f_i/m, m/s^2 |
//! | [`limb_law`] | (2) | limb forces per mass | limb elongations, m |
//! | [`pose`] | the paper's reference \[10\] | elongations | r and R_r, pose of the mass in the shell |
//! | [`relative_motion`] | as there | three poses | v, w_r, a_r, eps, motion of the mass in the shell |
//! | [`wrench`] | sums of (3), (4), (8) | limb forces and pose | force and torque on the mass, per mass |
//! | [`dynamics`] | (3), (8) | motion in the shell and wrench | R^T (a - g) and w*' of the shell |
//! | [`attitude`] | (9) | w* | R |
//! | [`decoder`] | all of them | nine voltages | [`crate::SixAxis`] |
//!
//! (4) is the torque balance that (8) is solved from; (5) and (6) are the drawing, [`crate::geometry`]; (7) defines the auxiliary
//! rate w* = R^T w. [`preload`] adds the static limb forces that a tared piezo does not show, [`limb_stream`] runs the first four
//! rows along a recording.
//!
//! Nothing here is rearranged for speed. [`Decoder`] is what every other decoder, the tests and the benches are compared with.

pub mod attitude;
pub mod decoder;
pub mod dynamics;
pub mod limb_law;
pub mod limb_stream;
pub mod pose;
pub mod preload;
pub mod relative_motion;
pub mod signal;
pub mod wrench;

#[cfg(feature = "alloc")]
pub use decoder::decouple;
pub use decoder::{Decoder, RateVariable};
