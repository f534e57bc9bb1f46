//! The sensor with rigid limbs: what nine forces a motion asks for when nothing gives way.

use glam::DVec3;
use nalgebra::Vector6;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_reference::mjcf::limb_jacobian;

/// Limb forces per mass of the paper's drawing, J (J^T J)^-1 \[a; torque\]: m/s^2 from m/s^2 and m^2/s^2, shell axes.
///
/// # Panics
/// Never: three nodes hold a body.
#[must_use]
pub fn forces(acceleration: DVec3, torque: DVec3) -> [f64; LIMBS] {
    let jacobian = limb_jacobian(&Geometry::PAPER);
    let normal = (jacobian.transpose() * jacobian)
        .try_inverse()
        .expect("three nodes hold a body");
    let (a, m) = (acceleration, torque);
    (jacobian * normal * Vector6::new(a.x, a.y, a.z, m.x, m.y, m.z)).into()
}
