//! What the laboratory does to a recording before the four steps see it.

use sixaxis_calibration::conditioning::{Conditioned, Conditioning};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::Result;
use sixaxis_core::recording::check_channels;
use sixaxis_props::truth::InCore;
use sixaxis_recordings::session::{LowPass, Preprocessing, Role, Stage};
use sixaxis_reference::laboratory::instruments::GYROSCOPE_BANDWIDTH_HZ;
use sixaxis_reference::laboratory::recording::SimulatedRecording;

/// Which preprocessing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// For recordings without errors: leave them alone.
    None,
    /// The gyroscope's lag undone, nothing else.
    LagUndone,
    /// For identification: what a session does unless it is told otherwise.
    Identification,
    /// For comparison with the standards: their second derivative of noise, which undoing the gyroscope's lag amplifies,
    /// must stay out. The drive loses 7e-6, the same on both sides.
    Comparison,
}

impl Preset {
    /// The stages.
    #[must_use]
    pub fn conditioning(self) -> Conditioning {
        let low_pass = match self {
            Self::None | Self::LagUndone => Stage::Switch(false),
            Self::Identification => Stage::On(LowPass::default()),
            Self::Comparison => Stage::On(LowPass {
                times_drive: 4.4,
                plus_hz: 0.0,
                ..LowPass::default()
            }),
        };
        Conditioning {
            stages: Preprocessing {
                low_pass,
                ..Preprocessing::default()
            },
            accelerometer_bandwidth_hz: None,
            gyroscope_bandwidth_hz: (self != Self::None).then_some(GYROSCOPE_BANDWIDTH_HZ),
        }
    }

    /// Cleans a recording as a trial of the given role.
    ///
    /// # Errors
    /// A recording that cannot be worked with: too short, a sample that is not finite, a channel dead or clipped.
    pub fn condition(
        self,
        recording: &SimulatedRecording,
        role: Role,
    ) -> Result<(Trial, Conditioned)> {
        check_channels(&recording.voltage_v, recording.full_scale_v)?;
        let trial = recording.trial(role);
        let conditioned = self.conditioning().condition(&trial)?;
        Ok((trial, conditioned))
    }
}
