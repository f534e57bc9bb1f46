//! Whole sessions: from recordings, on disk or in memory, to a calibration with its intervals and its grade.
//!
//! One module is one suite of evidence; see [`sixaxis_props::evidence`].

mod blind;
mod high_pass;
mod joint;
mod self_calibration;
mod sessions;
mod still;
mod tap_sessions;
mod unequal_stiffness;

use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_props::blind::judged_by_files;
use sixaxis_reference::laboratory::session::SimulatedSession;

/// Judges a session from its files.
fn judged(played: &SimulatedSession, name: &str) -> CalibratedSession {
    let folder =
        std::env::temp_dir().join(format!("sixaxis-session-{name}-{}", std::process::id()));
    let judged = judged_by_files(played, "npz", &folder).expect("it can be written");
    judged.expect("the session is sound")
}
