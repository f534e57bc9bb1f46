//! A calibrated session as the file that is kept of it.

use std::path::Path;

use super::choice::Chosen;
use super::covariance;
use crate::calibration::{CalibratedSensor, Calibration, FORMAT, Provenance};
use crate::finding::Finding;
use crate::joint::JointReport;
use crate::report::Grade;
use sixaxis_recordings::session::SessionFile;

pub(super) fn to_file(
    file: &SessionFile,
    verdict: Grade,
    findings: &[Finding],
    chosen: &Chosen,
) -> Calibration {
    let size = |path: &Path| std::fs::metadata(file.resolve(path)).map_or(0, |m| m.len());
    Calibration {
        format: FORMAT.to_owned(),
        verdict,
        findings: findings.to_vec(),
        sensor: CalibratedSensor {
            serial: file.session.sensor.serial.clone(),
            limb_length_m: file.session.sensor.geometry().limb_length_m,
            half_edge_m: file.session.sensor.geometry().half_edge_m,
            full_scale_v: file.session.sensor.full_scale_v,
            gain_n_per_v: file.session.sensor.gain_n_per_v.each(),
            amplifier_high_pass_hz: file.session.preprocessing.amplifier_high_pass_hz,
        },
        estimator: chosen.estimator,
        parameters: chosen.used.into(),
        intervals: chosen.parameters.to_vec(),
        covariance: covariance::of(chosen),
        limbs: chosen.used_joint().map(JointReport::limbs),
        channels: file.session.channels.clone(),
        provenance: Provenance {
            sixaxis_version: env!("CARGO_PKG_VERSION").to_owned(),
            gravity_m_s2: file.session.stated_gravity_m_s2(),
            session: file.text.clone(),
            recordings: file
                .session
                .recording
                .iter()
                .map(|entry| (entry.file.display().to_string(), size(&entry.file)))
                .collect(),
        },
    }
}
