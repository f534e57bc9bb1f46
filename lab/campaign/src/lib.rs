//! Calibrations by the thousand, to ask of the method what no single one can say: is it biased, and do its intervals hold?
//!
//! A case is a simulated session that is calibrated in memory; its seed says everything about it, whichever machine, thread or
//! shard it falls to. Cases go through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`plan`] | what is varied, which seeds, which shard of them |
//! | [`prepared`] | a played session as the calibration has it |
//! | [`case`] | one calibration |
//! | [`row`] | what is kept of it |
//! | [`part`] | a few dozen rows in a Parquet file that is there whole or not at all |
//! | [`folder`] | the parts of a campaign side by side |
//! | [`run`] | seeds that no part has yet, worked off by all cores |
//! | [`statistics`] | all parts, in the order of their seeds |
//!
//! Parts are the only state there is: a run that was killed goes on where the parts end, and shards are merged by putting
//! their parts side by side.

pub mod case;
pub mod error;
pub mod folder;
pub mod part;
pub mod plan;
pub mod prepared;
pub mod row;
pub mod run;
pub mod statistics;

pub use error::{Error, Result};
