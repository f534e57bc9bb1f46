//! The sensor with rigid limbs: what nine forces a motion asks for when nothing gives way.

use glam::DVec3;
use sixaxis_core::LIMBS;
use sixaxis_reference::rigid::{Load, RigidSensor};
use sixaxis_reference::sensor::TrueSensor;

/// Limb forces per mass of the paper's drawing, J (J^T J)^-1 \[a; torque\]: m/s^2 from m/s^2 and m^2/s^2, shell axes.
///
/// # Panics
/// Never: three nodes hold a body.
pub fn forces(acceleration: DVec3, torque: DVec3) -> [f64; LIMBS] {
    // The inertia has no part in it: the torque is given.
    RigidSensor::new(&TrueSensor::design(), &[1.0; LIMBS])
        .expect("three nodes hold a body")
        .forces_m_s2(&Load {
            specific_force_m_s2: acceleration,
            torque_m2_s2: torque,
        })
}
