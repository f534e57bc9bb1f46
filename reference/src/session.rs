//! A campaign as a laboratory would hand it in: recordings and a session file, healthy or with one thing wrong, and, kept
//! apart, the truth.
//!
//! [`plan`] says what is played, [`defect`] what may be wrong with it, [`play`] plays it, [`mod@write`] puts it on disk.

pub mod defect;
pub mod plan;
pub mod play;
pub mod write;
