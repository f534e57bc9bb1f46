//! Trials from the recordings of a session.

use sixaxis_recordings::ingest::readings;
use sixaxis_recordings::session::SessionFile;

use crate::error::Result;
use crate::trial::{Readings, Trial};

/// Loads one recording of a session.
///
/// # Errors
/// [`crate::Error::Recording`]: those of [`readings::read`].
pub fn trial(file: &SessionFile, index: usize) -> Result<Trial> {
    trial_and_cut(file, index).map(|(trial, _)| trial)
}

/// As [`trial`], with how its file was cut short, if it was.
pub(crate) fn trial_and_cut(file: &SessionFile, index: usize) -> Result<(Trial, Option<String>)> {
    let read = readings::read(file, index)?;
    let rows = read.voltage_v[0].len();
    let readings = Readings {
        sample_rate_hz: read.sample_rate_hz,
        voltage_v: (0..rows)
            .map(|row| core::array::from_fn(|limb| read.voltage_v[limb][row]))
            .collect(),
        accelerometer_m_s2: read.accelerometer_m_s2,
        gyroscope_rad_s: read.gyroscope_rad_s,
        limbs_band_hz: read.limbs_band_hz,
        standards_band_hz: read.standards_band_hz,
    };
    let session = &file.session;
    let trial = Trial::of(session, &session.recording[index], readings);
    Ok((trial, read.cut))
}
