//! What moves the sensor: motions prescribed to the shell, in closed form. Nothing here simulates.
//!
//! [`run`] is the paper's rig, a crank-slider with rack and pinion on wedges; [`tap`] the tap of a hammer on the shell that the
//! rig holds; [`tumble`] a motion about all six axes at once, beyond the rig; [`field`] such a tumble by hand, under gravity.

pub mod field;
pub mod journey;
pub mod run;
pub mod tap;
pub mod tumble;
