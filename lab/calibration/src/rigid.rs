//! How gravity turns in a sensor that turns.

use glam::DVec3;

/// Change of gravity's share in the limb forces since rest, as an acceleration in shell axes, m/s^2: -(R^T - 1) g after a turn
/// about a fixed axis. Eq. (3) has R sum (f/m) e = a - g.
#[must_use]
pub fn turned_gravity_m_s2(gravity_ground_m_s2: DVec3, axis: DVec3, angle_rad: f64) -> DVec3 {
    let turned = glam::DQuat::from_axis_angle(axis, -angle_rad) * gravity_ground_m_s2;
    gravity_ground_m_s2 - turned
}
