//! What the nine channels should show of a known motion, if the limbs are equally stiff and give way by nothing.
//!
//! Statics leave three of nine forces open; equal stiffness settles them. The forces that a wrench asks for are then
//! P \[a; M\] with P = J (J^T J)^-1 and rows \[e_i^T, (t_i x e_i)^T\] of J: nothing in it was identified. Channel by channel this
//! says more than steps 2 and 3 use, which only add the forces up, and so it can tell *which* channel is wrong.

use glam::DVec3;
use nalgebra::SMatrix;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS};

/// StaticLoadSharing of the nine limbs in a wrench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticLoadSharing {
    /// Force of each limb per mass over the acceleration, shell axes.
    pub linear: [DVec3; LIMBS],
    /// Force of each limb per mass over the torque per mass, 1/m.
    pub torque_per_m: [DVec3; LIMBS],
}

impl StaticLoadSharing {
    /// For a drawing; none for one whose limbs do not hold the mass.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Option<Self> {
        let hinges = geometry.mass_hinges_m();
        let jacobian = SMatrix::<f64, LIMBS, 6>::from_fn(|limb, column| {
            let e = DIRECTIONS_SHELL[limb];
            let m = hinges[limb].cross(e);
            [e.x, e.y, e.z, m.x, m.y, m.z][column]
        });
        let shares = jacobian * (jacobian.transpose() * jacobian).try_inverse()?;
        let part = |limb: usize, from: usize| {
            DVec3::new(
                shares[(limb, from)],
                shares[(limb, from + 1)],
                shares[(limb, from + 2)],
            )
        };
        Some(Self {
            linear: core::array::from_fn(|limb| part(limb, 0)),
            torque_per_m: core::array::from_fn(|limb| part(limb, 3)),
        })
    }

    /// Forces per mass, m/s^2, of an acceleration in shell axes (gravity's share taken off) and the torque of Euler's equation.
    #[must_use]
    pub fn forces_m_s2(
        &self,
        acceleration_shell_m_s2: DVec3,
        inertia: &InertiaPerMass,
        rate_shell_rad_s: DVec3,
        angular_shell_rad_s2: DVec3,
    ) -> [f64; LIMBS] {
        let torque = euler_torque(inertia, rate_shell_rad_s, angular_shell_rad_s2);
        core::array::from_fn(|limb| {
            self.linear[limb].dot(acceleration_shell_m_s2) + self.torque_per_m[limb].dot(torque)
        })
    }
}

/// Change of gravity's share in the limb forces since rest, as an acceleration in shell axes, m/s^2: -(R^T - 1) g after a turn
/// about a fixed axis. Eq. (3) has R sum (f/m) e = a - g.
#[must_use]
pub fn turned_gravity_m_s2(gravity_ground_m_s2: DVec3, axis: DVec3, angle_rad: f64) -> DVec3 {
    let turned = glam::DQuat::from_axis_angle(axis, -angle_rad) * gravity_ground_m_s2;
    gravity_ground_m_s2 - turned
}
