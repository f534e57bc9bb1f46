//! A sound sensor for unit tests.

use crate::{
    Decoupler, Gains, Geometry, InertiaPerMass, LIMBS, Model, Parameters, Scheme, Sensor, Settings,
};

pub const SENSOR: Sensor = Sensor {
    geometry: Geometry::PAPER,
    gains: Gains::uniform(10.0),
};

pub fn parameters() -> Parameters {
    let inertia = [191e-6, 236e-6, 327e-6, 0.1e-6, -0.4e-6, 1.6e-6];
    Parameters {
        zero_drift_v: [0.01; LIMBS],
        scale_per_mass_per_kg: [5.0; LIMBS],
        inertia_per_mass: InertiaPerMass::from_paper_order(inertia),
        stiffness_per_mass_per_s2: 2e8,
    }
}

/// At 10 kHz.
pub fn model() -> Model {
    Model::new(&SENSOR, &parameters(), &Settings::new(1e4)).expect("a sound sensor")
}

/// At 10 kHz.
pub fn decoupler(scheme: Scheme) -> Decoupler {
    let settings = Settings {
        scheme,
        ..Settings::new(1e4)
    };
    Decoupler::new(&SENSOR, &parameters(), &settings).expect("a sound sensor")
}

/// A sample of a slow vibration, V: another one for each `phase`.
pub fn row(sample: usize, phase: usize) -> [f64; LIMBS] {
    core::array::from_fn(|limb| 0.01 + 0.2 * (3e-3 * sample as f64 + (phase + limb) as f64).sin())
}
