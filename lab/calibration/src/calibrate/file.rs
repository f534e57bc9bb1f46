//! A calibrated session as the file that is kept of it.

use std::path::Path;

use super::choice::Chosen;
use super::covariance;
use crate::calibration::{CalibratedParameters, CalibratedSensor, Calibration, FORMAT, Provenance};
use crate::finding::Finding;
use crate::report::Grade;
use sixaxis_recordings::session::SessionFile;

/// What a calibration is made of.
pub(super) struct Contents<'a> {
    pub grade: Grade,
    pub findings: &'a [Finding],
    pub chosen: &'a Chosen,
}

pub(super) fn to_file(file: &SessionFile, contents: Contents) -> Calibration {
    let chosen = contents.chosen;
    let used = &chosen.used;
    let size = |path: &Path| std::fs::metadata(file.resolve(path)).map_or(0, |m| m.len());
    Calibration {
        format: FORMAT.to_owned(),
        verdict: contents.grade,
        findings: contents.findings.to_vec(),
        sensor: CalibratedSensor {
            serial: file.session.sensor.serial.clone(),
            limb_length_m: file.session.sensor.geometry().limb_length_m,
            half_edge_m: file.session.sensor.geometry().half_edge_m,
            full_scale_v: file.session.sensor.full_scale_v,
            gain_n_per_v: file.session.sensor.gain_n_per_v.each(),
            amplifier_high_pass_hz: file.session.preprocessing.amplifier_high_pass_hz,
        },
        estimator: chosen.estimator,
        parameters: CalibratedParameters {
            zero_drift_v: used.zero_drift_v,
            scale_per_mass_per_kg: used.scale_per_mass_per_kg,
            inertia_per_mass_m2: used.inertia_per_mass.to_paper_order(),
            stiffness_per_mass_per_s2: used.stiffness_per_mass_per_s2,
        },
        intervals: chosen.parameters.to_vec(),
        covariance: covariance::of(chosen),
        channels: file.session.channels.clone(),
        provenance: Provenance {
            sixaxis_version: env!("CARGO_PKG_VERSION").to_owned(),
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
