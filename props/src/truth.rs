//! The truth in core's terms: the one conversion between the reference's types and those of what is judged.
//!
//! `sixaxis-reference` shares no code with `sixaxis-core`, so that a sensor, a drawing or a recording of one has to be handed
//! over to the other number by number. All suites, benches and the report do it here.

use glam::DVec3;
use rand_pcg::Pcg64;
use sixaxis_calibration::trial::Trial;
use sixaxis_core::{Gains, Geometry, InertiaPerMass, LIMBS, Parameters, Scheme, Sensor, Settings};
use sixaxis_recordings::session::Role;
use sixaxis_reference::geometry;
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::sensor::{self, TrueSensor};

/// The 25 parameters of a true sensor.
pub fn parameters(sensor: &TrueSensor) -> Parameters {
    Parameters {
        zero_drift_v: sensor.zero_drift_v,
        scale_per_mass_per_kg: sensor.scale_per_mass_per_kg,
        inertia_per_mass: InertiaPerMass::from_paper_order(
            sensor.inertia_per_mass.to_paper_order(),
        ),
        stiffness_per_mass_per_s2: sensor.stiffness_per_mass_per_s2,
    }
}

/// The true sensor with these parameters and the paper's drawing.
pub fn sensor(parameters: &Parameters) -> TrueSensor {
    TrueSensor {
        geometry: geometry::Geometry::PAPER,
        zero_drift_v: parameters.zero_drift_v,
        scale_per_mass_per_kg: parameters.scale_per_mass_per_kg,
        inertia_per_mass: sensor::InertiaPerMass::from_paper_order(
            parameters.inertia_per_mass.to_paper_order(),
        ),
        stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
        mass_centre_m: [0.0; 3],
    }
}

/// The MuJoCo model of the sensor with these parameters and the paper's drawing under gravity in ground axes, m/s^2.
pub fn model(parameters: &Parameters, gravity_ground_m_s2: DVec3) -> SensorModel {
    SensorModel::new(&sensor(parameters), gravity_ground_m_s2)
}

/// The paper's sensor as designed.
pub fn design_parameters() -> Parameters {
    parameters(&TrueSensor::design())
}

/// The paper's sensor as identified.
pub fn identified_parameters() -> Parameters {
    parameters(&TrueSensor::identified())
}

/// A sensor scattered about the design.
pub fn random_parameters(rng: &mut Pcg64) -> Parameters {
    parameters(&TrueSensor::random(rng))
}

/// The amplifier ranges, of a tared chain of +-10 V, that fit the limb forces per mass, m/s^2.
pub fn amplifier_ranges(
    limb_force_per_mass_m_s2: &[[f64; LIMBS]],
    parameters: &Parameters,
) -> Gains {
    let sensor = sensor(parameters);
    Gains {
        gain_n_per_v: Chain::noise_free().amplifier_ranges(limb_force_per_mass_m_s2, &sensor),
    }
}

/// A simulated recording as what is judged takes it.
pub trait InCore {
    /// Its amplifier ranges.
    fn gains(&self) -> Gains;
    /// What a laboratory knows of the sensor behind it: the paper's drawing, these amplifier ranges.
    fn sensor(&self) -> Sensor;
    /// Decoupler settings that go with it: from rest, tared, with its gravity.
    fn settings(&self, scheme: Scheme) -> Settings;
    /// As a trial of a session.
    fn trial(&self, role: Role) -> Trial;
}

impl InCore for SimulatedRecording {
    fn gains(&self) -> Gains {
        Gains {
            gain_n_per_v: self.gain_n_per_v,
        }
    }

    fn sensor(&self) -> Sensor {
        Sensor {
            geometry: Geometry::PAPER,
            gains: self.gains(),
        }
    }

    fn settings(&self, scheme: Scheme) -> Settings {
        Settings {
            scheme,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            ..Settings::new(self.sample_rate_hz)
        }
    }

    fn trial(&self, role: Role) -> Trial {
        Trial {
            name: self.name.clone(),
            role,
            sample_rate_hz: self.sample_rate_hz,
            gains: self.gains(),
            full_scale_v: self.full_scale_v,
            voltage_v: self.voltage_v.clone(),
            accelerometer_m_s2: self.accelerometer_m_s2.clone(),
            gyroscope_rad_s: self.gyroscope_rad_s.clone(),
            limbs_band_hz: f64::INFINITY,
            standards_band_hz: f64::INFINITY,
            direction_ground: self.direction_ground,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            frequency_hz: self.frequency_hz,
        }
    }
}
