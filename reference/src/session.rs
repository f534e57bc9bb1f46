//! A campaign as a laboratory would hand it in: recordings and a session file, healthy or with one thing wrong, and, kept
//! apart, the truth.
//!
//! | file | holds |
//! |---|---|
//! | [`plan`] | what is played |
//! | [`plan_file`] | a plan as TOML with comments |
//! | [`defect`] | what may be wrong |
//! | [`effect`] | whether it does harm |
//! | [`check`] | what a plan may not say |
//! | [`schedule`] | the trials that it asks for |
//! | [`play`] | all of it played |
//! | `record` | one trial of it |
//! | `strike` | one tap of it |
//! | [`mod@tumble`] | a recording from the field, after it |
//! | `session_file` | what the laboratory writes down |
//! | [`mod@write`] | all of it on disk |

pub mod check;
pub mod defect;
pub mod effect;
pub mod plan;
pub mod plan_file;
pub mod play;
mod record;
pub mod schedule;
mod session_file;
mod strike;
pub mod tumble;
pub mod write;
