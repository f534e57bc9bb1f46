//! The two ordinary rooms that a calibration has to hold in: a laboratory that takes care, and one as it usually is.

use serde::{Deserialize, Serialize};

use super::plan::{ChainPlan, InstrumentPlan, RigPlan, SessionPlan};
use crate::rig::run::Mounting;

/// A room.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Room {
    /// 66 dB, wedges 0.05 degrees, axis 0.02 degrees, centre 0.05 mm, stiffness 0.5 %, gains 1 %, cross-talk 0.3 %, rod 1:8,
    /// hum 1 mV, zeros 20 uV, sensitivity 2e-4 a day.
    Gentle,
    /// 60 dB, wedges 0.1 degrees, axis 0.1 degrees, centre 0.3 mm, stiffness 1 %, gains 1 %, cross-talk 0.5 %, rod 1:5, hum 5 mV,
    /// zeros 0.1 mV, sensitivity 5e-4 a day.
    Usual,
}

impl Room {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Gentle, Self::Usual];

    /// The plan moved into this room: its rig, measuring chain and instruments, nothing else.
    pub fn holding(self, plan: SessionPlan) -> SessionPlan {
        let gentle = self == Self::Gentle;
        let pick = |a: f64, b: f64| if gentle { a } else { b };
        let signal_to_noise_db = pick(66.0, 60.0);
        SessionPlan {
            rig: RigPlan {
                mounting: Mounting::AxisVertical,
                wedge_error_deg: pick(0.05, 0.1),
                axis_tilt_deg: pick(0.02, 0.1),
                centre_offset_mm: pick(0.05, 0.3),
                crank_over_rod: pick(1.0 / 8.0, 1.0 / 5.0),
                ..plan.rig
            },
            chain: ChainPlan {
                signal_to_noise_db,
                stiffness_spread: pick(0.005, 0.01),
                cross_talk: pick(0.003, 0.005),
                hum_v: pick(1e-3, 5e-3),
                zero_spread_v: pick(20e-6, 0.1e-3),
                sensitivity_drift: pick(2e-4, 5e-4),
                ..plan.chain
            },
            instruments: InstrumentPlan {
                // Half of the class is the gain's: within 1 %.
                class_percent: 2.0,
                signal_to_noise_db,
                ..plan.instruments
            },
            ..plan
        }
    }
}
