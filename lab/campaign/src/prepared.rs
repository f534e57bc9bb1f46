//! A played session as the calibration has it, without a detour by files.

use sixaxis_calibration::prepare::PreparedSession;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::trial::Trial;
use sixaxis_recordings::ingest::averaged::Averaged;
use sixaxis_recordings::ingest::readings::Readings;
use sixaxis_recordings::session::{Role, Session};
use sixaxis_reference::laboratory::recording::SimulatedRecording;

/// Sorts and conditions a played session's recordings, all but validation runs: these are held against the standards, never
/// fitted.
pub fn prepare(session: &Session, recordings: Vec<SimulatedRecording>) -> PreparedSession {
    let trials = recordings
        .into_iter()
        .filter(|recording| recording.role != Role::Validation)
        .map(|recording| trial(session, recording))
        .collect();
    PreparedSession::of(session, trials, &NoProgress)
}

fn trial(session: &Session, recording: SimulatedRecording) -> Trial {
    let entry = recording.entry();
    let voltage_v = core::array::from_fn(|limb| {
        let column = recording.voltage_v.iter().map(|row| row[limb]);
        if recording.role == Role::Static {
            averaged(column)
        } else {
            column.collect()
        }
    });
    let readings = Readings {
        sample_rate_hz: recording.sample_rate_hz,
        voltage_v,
        accelerometer_m_s2: recording.accelerometer_m_s2,
        gyroscope_rad_s: recording.gyroscope_rad_s,
        limbs_band_hz: f64::INFINITY,
        standards_band_hz: f64::INFINITY,
        cut: None,
    };
    Trial::of(session, &entry, readings)
}

/// A static record of any length in as many rows as a reader of files keeps.
fn averaged(voltage_v: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut averaged = Averaged::default();
    voltage_v.for_each(|voltage_v| averaged.push(voltage_v));
    averaged.finish()
}
