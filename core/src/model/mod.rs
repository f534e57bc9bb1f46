//! The sensor, its parameters and the settings of a run.

mod parameters;
mod settings;

pub use parameters::{InertiaPerMass, PARAMETERS, Parameters, STIFFNESS_PER_MASS_RANGE_PER_S2};
pub use settings::{Sensor, Settings, StaticResponse};
