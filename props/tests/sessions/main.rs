//! Whole sessions: from recordings, on disk or in memory, to a calibration with its intervals and its grade.
//!
//! One module is one suite of evidence; see [`sixaxis_props::evidence`].

mod blind;
mod joint;
mod self_calibration;
mod sessions;
mod still;
mod tap_sessions;
mod unequal_stiffness;
