//! One file for each thing the command can be asked to do. Each says its own arguments; what they have in common is here.

pub mod calibrate;
pub mod campaign;
pub mod choices;
pub mod common;
pub mod compare;
pub mod completions;
pub mod decouple;
pub mod inspect;
pub mod man;
#[cfg(feature = "harness")]
pub mod model;
pub mod output;
pub mod panel;
#[cfg(feature = "harness")]
pub mod report;
pub mod self_calibrate;
pub mod simulate;
