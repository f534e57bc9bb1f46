//! A judged session as the file that is kept of it.

use sixaxis_core::parameter::PARAMETERS;
use std::path::Path;

use sixaxis_core::{LIMBS, Parameters};

use super::{Estimator, Grade};
use crate::calibration::{
    CalibratedParameters, CalibratedSensor, Calibration, Covariance, FORMAT, PropagatedCovariance,
    Provenance,
};
use crate::interval::ParameterReport;
use crate::propagation::{Propagated, Sources};
use crate::steps::FourSteps;
use crate::suspicion::Finding;
use sixaxis_recordings::session::SessionFile;

/// What a calibration is made of.
pub(super) struct Kept<'a> {
    pub grade: Grade,
    pub findings: &'a [Finding],
    pub estimator: Estimator,
    pub used: &'a Parameters,
    pub parameters: &'a [ParameterReport],
    pub covariance: Covariance,
}

pub(super) fn to_file(file: &SessionFile, kept: Kept) -> Calibration {
    let used = kept.used;
    let size = |path: &Path| std::fs::metadata(file.resolve(path)).map_or(0, |m| m.len());
    Calibration {
        format: FORMAT.to_owned(),
        verdict: kept.grade,
        findings: kept.findings.to_vec(),
        sensor: CalibratedSensor {
            serial: file.session.sensor.serial.clone(),
            limb_length_m: file.session.sensor.geometry().limb_length_m,
            half_edge_m: file.session.sensor.geometry().half_edge_m,
            full_scale_v: file.session.sensor.full_scale_v,
            gain_n_per_v: file.session.sensor.gain_n_per_v.each(),
            amplifier_high_pass_hz: file.session.preprocessing.amplifier_high_pass_hz,
        },
        estimator: kept.estimator,
        parameters: CalibratedParameters {
            zero_drift_v: used.zero_drift_v,
            scale_per_mass_per_kg: used.scale_per_mass_per_kg,
            inertia_per_mass_m2: used.inertia_per_mass.to_paper_order(),
            stiffness_per_mass_per_s2: used.stiffness_per_mass_per_s2,
        },
        intervals: kept.parameters.to_vec(),
        covariance: kept.covariance,
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

/// Covariances of the four steps.
pub(super) fn covariance(
    steps: &FourSteps,
    propagated: Option<&(Sources, Propagated)>,
) -> Covariance {
    let matrix = |rows: usize, get: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..rows)
            .map(|i| (0..rows).map(|j| get(i, j)).collect())
            .collect()
    };
    Covariance {
        zero_drift_v2: steps.drift.standard_error_v.map(|s| s * s),
        scale_per_mass_per_kg2: matrix(LIMBS, &|i, j| steps.scale.estimate.covariance[(i, j)]),
        inertia_per_mass_m4: matrix(6, &|i, j| steps.inertia.estimate.covariance[(i, j)]),
        propagated: propagated.map(|(sources, propagated)| PropagatedCovariance {
            noise: matrix(PARAMETERS, &|i, j| propagated.noise[(i, j)]),
            standards: matrix(PARAMETERS, &|i, j| propagated.standards[(i, j)]),
            channel_noise_v: sources.typical_noise_v(),
        }),
    }
}
