//! Adversarial input: a typed error that names its cause or a finite answer, never a panic, never a silent NaN.
//!
//! Counter-examples found are kept in `proptest-regressions`, one file a module.

mod decoder;
mod identify;
mod input;
mod preprocess;
mod recording;
mod sensor;
mod stiffness;
