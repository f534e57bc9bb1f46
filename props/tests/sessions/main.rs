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

use sixaxis_calibration::calibrate::{CalibratedSession, Options, calibrate};
use sixaxis_calibration::progress::NoProgress;
use sixaxis_recordings::session::SessionFile;
use sixaxis_reference::laboratory::session::SimulatedSession;
use sixaxis_reference::laboratory::write::write;

/// Judges a session from its files.
fn judged(played: &SimulatedSession, name: &str) -> CalibratedSession {
    let folder =
        std::env::temp_dir().join(format!("sixaxis-session-{name}-{}", std::process::id()));
    let session = write(played, &folder, "npz").expect("it can be written");
    let judgement = SessionFile::read(&session)
        .map_err(Into::into)
        .and_then(|file| calibrate(&file, &Options::default(), &NoProgress));
    std::fs::remove_dir_all(&folder).expect("it can be cleared away");
    judgement.expect("the session is sound")
}
