//! The sensor, its 25 parameters and the settings of a run, validated once.
//!
//! Both the plain decoder ([`crate::paper`]) and the constants of the fast one are made from a [`Model`], so that neither
//! checks anything again.

mod cross_talk;
pub(crate) mod limb_mass;
mod parameters;
mod sensor;
mod settings;

pub use cross_talk::CrossTalk;
pub use parameters::{InertiaPerMass, Parameters, STIFFNESS_PER_MASS_RANGE_PER_S2};
pub use sensor::{Gains, Sensor};
pub use settings::{LimbLaw, Settings, StaticResponse};

use crate::error::Result;

/// A sensor, its parameters and settings that have passed every check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    sensor: Sensor,
    parameters: Parameters,
    settings: Settings,
}

impl Model {
    /// Checks the three by themselves and together.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] or [`crate::Error::ImpossibleInertia`] for values without a physical meaning, and for a gain and a scale
    /// factor whose product no f64 holds.
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        sensor.geometry.validate()?;
        sensor.gains.validate()?;
        parameters.validate()?;
        settings.validate()?;
        sensor.gains.validate_with(parameters)?;
        Ok(Self {
            sensor: *sensor,
            parameters: *parameters,
            settings: *settings,
        })
    }

    /// Drawing and amplifier gains.
    #[must_use]
    pub const fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The 25 identified parameters.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// How the recording is decoupled.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }
}
