//! The world that sixaxis-core is judged by: sensor, rig and instruments, simulated with MuJoCo.
//!
//! [`paper`] holds the printed numbers and [`mjcf`] the sensor as a MuJoCo model. [`simulation`] runs it with its
//! shell driven exactly along a motion, be it one of the [`rig`], a [`tumble`] beyond it or the [`tap`] of a hammer; [`recording`] keeps what a laboratory would have on disk apart
//! from the truth, after the [`chain`] and the standard [`instruments`] have had their say; [`campaign`] is the
//! paper's plan of runs. [`threshold`] repeats Fig. 7; [`modes`] is linear theory and [`ringdown`] what it is held
//! against.

pub mod campaign;
pub mod chain;
pub mod field;
pub mod instruments;
pub mod mjcf;
pub mod modes;
pub mod paper;
pub mod recording;
pub mod rig;
pub mod rigid;
pub mod ringdown;
pub mod session;
pub mod simulation;
pub mod smooth_step;
pub mod tap;
pub mod threshold;
pub mod tumble;
