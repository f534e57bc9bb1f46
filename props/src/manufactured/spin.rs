//! The core's integrator alone: exact torques in, the mass's rate out.

use glam::DVec3;
use sixaxis_core::kernel::constants::Constants;
use sixaxis_core::kernel::rate::{RateIntegrator, Torques};
use sixaxis_core::kernel::vec3::{Vec3, vec3};
use sixaxis_core::{Gains, Model, Scheme, Sensor, Settings};

use super::motion::Manufactured;

/// W and W' in mass axes, rad/s and rad/s^2, at every step from `start`, with the torque known exactly at each.
///
/// # Panics
/// If the sensor is no sound one.
pub fn spin(
    sensor: &Manufactured,
    scheme: Scheme,
    step_s: f64,
    steps: usize,
    start: DVec3,
) -> Vec<[DVec3; 2]> {
    let drawn = Sensor {
        geometry: sensor.geometry,
        gains: Gains::uniform(1.0),
    };
    let settings = Settings::new(1.0 / step_s);
    let constants = Model::new(&drawn, &sensor.parameters, &settings)
        .and_then(|model| Constants::new(&model))
        .expect("a sound sensor");
    // The kernel's torques are over chi nu, lengths in L, times in steps.
    let length = sensor.geometry.limb_length_m;
    let unit = step_s * step_s / (length * length * constants.chi * constants.nu);
    let torque = |step: usize| {
        let t = sensor.at(step as f64 * step_s).torque_mass_m2_s2 * unit;
        constants.torque_to_principal(vec3(t.x, t.y, t.z))
    };
    let si = |v: Vec3<f64>, scale: f64| {
        let v = constants.principal_to_mass(v);
        DVec3::from(v.components()) * scale
    };
    let w = start * step_s;
    let w = constants.mass_to_principal(vec3(w.x, w.y, w.z));
    let mut state = RateIntegrator::start(constants.gyroscopic, w, torque(0));
    let mut result = Vec::with_capacity(steps + 1);
    for step in 0..=steps {
        if step > 0 {
            let torques = Torques {
                now: torque(step),
                next: torque(step + 1),
            };
            let next = state.step(scheme, constants.gyroscopic, torques);
            state.take(scheme, next);
        }
        let per_s = 1.0 / step_s;
        result.push([si(state.rate, per_s), si(state.derivative, per_s * per_s)]);
    }
    result
}
