//! What the study's laboratory writes into its session file, and its recordings prepared as `sixaxis calibrate` prepares them.

use anyhow::Result;
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioning;
use sixaxis_calibration::prepare::PreparedSession;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_core::Geometry;
use sixaxis_core::recording::check_channels;
use sixaxis_props::truth::{self, InCore};
use sixaxis_recordings::session::{LowPass, Preprocessing, Role, Session, Stage};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::instruments::{
    GAIN_SHARE, GYROSCOPE_BANDWIDTH_HZ, INSTRUMENT_CLASS,
};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::schedule::PlannedTrial;
use sixaxis_reference::motion::SimulatedRun;

/// Largest gain error of either standard: what its certificate says.
pub const GAIN_LIMIT: f64 = GAIN_SHARE * INSTRUMENT_CLASS;

/// What is done to the recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// For recordings without errors: leave them alone.
    None,
    /// The gyroscope's lag undone, nothing else.
    LagUndone,
    /// What a session does unless it is told otherwise.
    Session,
}

impl Preset {
    fn conditioning(self) -> Conditioning {
        Conditioning {
            level_samples: None,
            stages: Preprocessing {
                low_pass: match self {
                    Self::None | Self::LagUndone => Stage::Switch(false),
                    Self::Session => Stage::On(LowPass::default()),
                },
                ..Preprocessing::default()
            },
            accelerometer_bandwidth_hz: None,
            gyroscope_bandwidth_hz: (self != Self::None).then_some(GYROSCOPE_BANDWIDTH_HZ),
        }
    }
}

/// The session file: certificates, the gyroscope's data sheet, and a workshop's word on its wedges. That the wedges of the
/// simulation are right to the last digit the laboratory does not know.
///
/// # Errors
/// None, unless the format changes.
pub fn session() -> Result<Session> {
    let percent = 100.0 * GAIN_LIMIT;
    let geometry = Geometry::PAPER;
    let design = truth::design_parameters();
    Ok(toml::from_str(&format!(
        "recording = []
        [sensor]
        serial = \"the paper's\"
        limb_length_mm = {}
        half_edge_mm = {}
        full_scale_v = 10.0
        gain_n_per_v = 1.0
        [sensor.design]
        scale_per_mass_per_kg = {:?}
        inertia_per_mass_mm2 = {:?}
        stiffness_per_mass_per_s2 = {:?}
        [accelerometer]
        class_percent = {percent:?}
        [gyroscope]
        class_percent = {percent:?}
        bandwidth_hz = {GYROSCOPE_BANDWIDTH_HZ:?}
        [rig]
        wedge_deg = {:?}
        gravity_m_s2 = {:?}",
        1e3 * geometry.limb_length_m,
        1e3 * geometry.half_edge_m,
        design.scale_per_mass_per_kg[0],
        design.inertia_per_mass.to_paper_order().map(|i| 1e6 * i),
        design.stiffness_per_mass_per_s2,
        sixaxis_calibration::joint::WEDGE_DEG,
        sixaxis_reference::paper::GRAVITY_M_S2,
    ))?)
}

/// Records and prepares simulated runs, each with its purpose, and the static record.
///
/// # Errors
/// A recording that cannot be worked with: too short, a sample that is not finite, a channel dead or clipped.
pub fn record(
    laboratory: &Laboratory,
    simulated: &[(PlannedTrial, SimulatedRun)],
    preset: Preset,
) -> Result<PreparedSession> {
    let mut recordings: Vec<_> = simulated
        .par_iter()
        .enumerate()
        .map(|(index, (trial, run))| (laboratory.record(run, index), trial.role))
        .collect();
    recordings.push((laboratory.record_static(), Role::Static));
    prepare(recordings, preset)
}

/// Prepares recordings, each with its purpose.
///
/// # Errors
/// As [`record`].
pub fn prepare(
    recordings: impl IntoIterator<Item = (SimulatedRecording, Role)>,
    preset: Preset,
) -> Result<PreparedSession> {
    let mut trials = Vec::new();
    for (recording, role) in recordings {
        if role != Role::Static {
            check_channels(&recording.voltage_v, recording.full_scale_v)?;
        }
        trials.push(recording.trial(role));
    }
    let prepared = PreparedSession::new(
        preset.conditioning(),
        Geometry::PAPER,
        truth::design_parameters(),
        trials,
        &NoProgress,
    );
    if let Some(finding) = prepared.findings.first() {
        anyhow::bail!("{}: {}", finding.recordings.join(", "), finding.evidence);
    }
    Ok(prepared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_calibration::joint::Knowledge;

    #[test]
    fn inv_the_file_says_what_the_laboratory_knows() {
        let session = session().expect("it can be parsed");
        let known = Knowledge::of(&session);
        assert_eq!(known.accelerometer_gain_limit, GAIN_LIMIT);
        let deviation = known.certificates.gyroscope_gain_deviation;
        assert_eq!(deviation, GAIN_LIMIT / 3.0_f64.sqrt());
        let lag = known.certificates.gyroscope_lag_s.expect("a data sheet");
        assert_eq!(
            lag.value,
            1.0 / (core::f64::consts::TAU * GYROSCOPE_BANDWIDTH_HZ)
        );
    }
}
