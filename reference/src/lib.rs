//! The truth that the rest of the project is judged by: sensor, rig, laboratory.
//!
//! Nothing here uses `sixaxis-core` or the calibration: what is judged and what it is judged by share no code.
//!
//! | module | holds |
//! |---|---|
//! | [`paper`] | the numbers that the paper prints |
//! | [`geometry`], [`sensor`] | where the limbs are, equations (5) and (6); the true sensor with its 25 parameters |
//! | [`limbs`] | what real limbs have beside one axial stiffness |
//! | [`rig`] | motions prescribed to the shell: the paper's rig, taps, tumbles |
//! | [`motion`] | what every engine takes and what it gives: a motion; limb forces and true motion, sample by sample |
//! | [`mujoco`] | the engine: MuJoCo, limbs and all, behind the feature of that name (on by default) |
//! | [`rigid`], [`compliant`] | closed forms, for campaigns by the thousand and for records by the minute |
//! | [`linear_theory`] | modes and relative motion by linear theory, to hold MuJoCo against |
//! | [`laboratory`] | measuring chain and reference instruments; a whole session, with defects, on disk |
//! | [`smooth_step`] | how a motion starts from rest |

pub mod compliant;
pub mod geometry;
pub mod laboratory;
pub mod limbs;
pub mod linear_theory;
pub mod motion;
#[cfg(feature = "mujoco")]
pub mod mujoco;
pub mod paper;
pub mod rig;
pub mod rigid;
pub mod sensor;
pub mod smooth_step;
