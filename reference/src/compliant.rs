//! Limbs that give way, without a simulator: the mass hangs where the load of each instant would hold it at rest.
//!
//! That leaves out the mass's own motion against the shell, 1e-5 of a force at 5 Hz, and keeps the geometry of the displaced
//! limbs to all orders, on which the parity relations depend.

use glam::DVec3;
use nalgebra::Vector6;

use crate::geometry::{Geometry, LIMBS};
use crate::limbs::Limbs;
use crate::linear_theory::stiffness_per_mass;
use crate::rigid::Load;
use crate::sensor::TrueSensor;

/// Limb forces per mass, m/s^2, at the pose in which each load holds the mass. None for a geometry whose limbs do not hold it.
#[must_use]
pub fn compliant_forces_m_s2(sensor: &TrueSensor, loads: &[Load]) -> Option<Vec<[f64; LIMBS]>> {
    let k = sensor.stiffness_per_mass_per_s2;
    let compliance = stiffness_per_mass(&sensor.geometry, k, &Limbs::IDEAL).try_inverse()?;
    let forces = loads.iter().map(|load| {
        // Compression pushes along e, so the mass gives way against the load.
        let moved: Vector6<f64> = -(compliance * load.wrench());
        let displacement = DVec3::new(moved[0], moved[1], moved[2]);
        let rotation = DVec3::new(moved[3], moved[4], moved[5]);
        elongations_m(&sensor.geometry, displacement, rotation).map(|elongation| -k * elongation)
    });
    Some(forces.collect())
}

/// l_i - L of every limb, m, with the mass displaced by `displacement_m` and turned by the rotation vector `rotation_rad`, shell
/// axes. Exact for any pose and without loss of digits for a small one.
#[must_use]
pub fn elongations_m(
    geometry: &Geometry,
    displacement_m: DVec3,
    rotation_rad: DVec3,
) -> [f64; LIMBS] {
    let directions = Geometry::directions_shell();
    let length = geometry.limb_length_m;
    // R - 1 = sin(a)/a [phi]x + 2 (sin(a/2)/a)^2 [phi]x^2 for an angle a = |phi|.
    let angle = rotation_rad.length();
    let (once, twice) = if angle > 0.0 {
        let half = (0.5 * angle).sin() / angle;
        (angle.sin() / angle, 2.0 * half * half)
    } else {
        (1.0, 0.5)
    };
    let ends = geometry.mass_hinges_m();
    core::array::from_fn(|limb| {
        let turned = rotation_rad.cross(ends[limb]);
        let moved = displacement_m + once * turned + twice * rotation_rad.cross(turned);
        // l^2 - L^2 over l + L.
        let squares = moved.dot(2.0 * length * directions[limb] + moved);
        squares / ((directions[limb] * length + moved).length() + length)
    })
}
