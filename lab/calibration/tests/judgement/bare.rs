//! A session of which nothing is known but its recordings.

use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::report::{Estimator, Grade};
use sixaxis_calibration::tap::Taps;
use sixaxis_calibration::trial::Trial;

pub fn calibrated(recordings: Vec<(Trial, Option<Conditioned>)>) -> CalibratedSession {
    CalibratedSession {
        grade: Grade::Bad,
        sentence: String::new(),
        findings: Vec::new(),
        reservations: Vec::new(),
        remarks: Vec::new(),
        next: Vec::new(),
        steps: None,
        obstacle: None,
        iteration: None,
        estimator: Estimator::FourSteps,
        parameters: Vec::new(),
        four_steps: Vec::new(),
        joint: None,
        taps: Taps::default(),
        trials: Vec::new(),
        validation_runs: Vec::new(),
        table: None,
        recordings,
        calibration: None,
    }
}
