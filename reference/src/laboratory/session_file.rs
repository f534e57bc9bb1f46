//! The session file of a simulated session: what the laboratory knows, defects of its bookkeeping included, never the truth.

use sixaxis_recordings::session::{
    Accelerometer, Channels, Design, Gyroscope, Limits, PerLimb, Preprocessing, Rig, SensorCard,
    Session,
};

use super::STATIC_GAIN_N_PER_V;
use super::defect::{Defect, Kind};
use super::instruments::GAIN_SHARE;
use super::plan::SessionPlan;
use super::recording::{SimulatedRecording, tidy};
use super::spoil::size_of;
use crate::geometry::Geometry;
use crate::paper;

/// The session file of recordings that were made to a plan.
pub fn session(
    plan: &SessionPlan,
    defect: Option<&Defect>,
    recordings: &[SimulatedRecording],
) -> Session {
    let size = |kind| size_of(defect, kind);
    let stated_bandwidth = match defect {
        Some(defect) if defect.kind == Kind::GyroscopeLag => None,
        _ => (plan.instruments.gyroscope_bandwidth_hz > 0.0)
            .then_some(plan.instruments.gyroscope_bandwidth_hz),
    };
    Session {
        title: format!("Simulated session, seed {}", plan.seed),
        sensor: SensorCard {
            serial: format!("simulated-{}", plan.seed),
            limb_length_mm: tidy(
                Geometry::PAPER.limb_length_m * 1e3 * size(Kind::WrongLimbLength).exp(),
            ),
            half_edge_mm: tidy(Geometry::PAPER.half_edge_m * 1e3 * size(Kind::WrongHalfEdge).exp()),
            full_scale_v: plan.chain.full_scale_v,
            gain_n_per_v: PerLimb::All(STATIC_GAIN_N_PER_V),
            design: Design {
                scale_per_mass_per_kg: PerLimb::All(paper::DESIGN_SCALE_PER_MASS_PER_KG),
                inertia_per_mass_mm2: paper::DESIGN_INERTIA_PER_MASS_MM2,
                stiffness_per_mass_per_s2: paper::DESIGN_STIFFNESS_PER_MASS_PER_S2,
            },
        },
        accelerometer: Accelerometer {
            sensitivity_mv_per_g: None,
            class_percent: plan.instruments.class_percent,
            gain_percent: Some(tidy(GAIN_SHARE * plan.instruments.class_percent)),
            bandwidth_hz: None,
            delay_ms: None,
        },
        gyroscope: Gyroscope {
            sensitivity_mv_per_deg_s: None,
            class_percent: plan.instruments.class_percent,
            gain_percent: Some(tidy(GAIN_SHARE * plan.instruments.class_percent)),
            bandwidth_hz: stated_bandwidth,
            delay_ms: None,
        },
        rig: Some(Rig {
            stroke_mm: Some(tidy(2e3 * plan.rig.slider_amplitude_m)),
            rotation_amplitude_deg: Some(tidy(plan.rig.rotation_amplitude_rad.to_degrees())),
            // A tilt evenly spread up to its largest, towards anywhere: each of two angles has a sixth of its square.
            wedge_deg: (plan.rig.wedge_error_deg > 0.0)
                .then(|| tidy(plan.rig.wedge_error_deg / 6.0_f64.sqrt())),
            gravity_m_s2: Some(paper::GRAVITY_M_S2),
        }),
        channels: Channels::default(),
        preprocessing: Preprocessing {
            amplifier_high_pass_hz: (plan.chain.amplifier_high_pass_hz > 0.0)
                .then_some(plan.chain.amplifier_high_pass_hz),
            ..Preprocessing::default()
        },
        limits: Limits::default(),
        recording: recordings.iter().map(SimulatedRecording::entry).collect(),
    }
}
