//! Limbs that give way, without a simulator: the mass hangs where it is in equilibrium at each instant as the shell moves.
//!
//! That leaves out the mass's own motion against the shell, 1e-5 of a force at 5 Hz. The geometry of the displaced limbs is kept to
//! all orders: parity relations depend on it, and so does a rate that is integrated for minutes. With the directions and arms of
//! the unloaded limbs gravity alone would turn the mass by some 1e-4 rad/s^2 that no sensor feels.

use glam::{DQuat, DVec3};
use nalgebra::{Matrix6, Vector6};

use crate::geometry::{Geometry, LIMBS};
use crate::limbs::Limbs;
use crate::linear_theory::stiffness_per_mass;
use crate::motion::TrueMotion;
use crate::rigid::torque_per_mass;
use crate::sensor::TrueSensor;

/// Steps to the equilibrium, each of which leaves some 1e-5 of its error, a displacement over the length of a limb.
const STEPS: usize = 3;

/// Limb forces per mass, m/s^2, at the pose in which each motion of the shell holds the mass. None for a geometry whose limbs do not
/// hold it.
pub fn compliant_forces_m_s2(
    sensor: &TrueSensor,
    gravity_ground_m_s2: DVec3,
    motions: &[TrueMotion],
) -> Option<Vec<[f64; LIMBS]>> {
    let k = sensor.stiffness_per_mass_per_s2;
    let compliance = stiffness_per_mass(&sensor.geometry, k, &Limbs::IDEAL).try_inverse()?;
    let forces = motions.iter().map(|motion| {
        let pose = equilibrium(sensor, &compliance, gravity_ground_m_s2, motion);
        pose.elongations_m(&sensor.geometry)
            .map(|elongation| -k * elongation)
    });
    Some(forces.collect())
}

/// The pose at which the limbs' forces are those that the motion asks of the mass.
fn equilibrium(
    sensor: &TrueSensor,
    compliance: &Matrix6<f64>,
    gravity_ground_m_s2: DVec3,
    motion: &TrueMotion,
) -> Displaced {
    let mut at = Vector6::zeros();
    for _ in 0..STEPS {
        let pose = Displaced::at(&at);
        let missing = pose.asked(sensor, gravity_ground_m_s2, motion) - pose.resultant(sensor);
        // Compression pushes along e, so the mass gives way against the load.
        at -= compliance * missing;
    }
    Displaced::at(&at)
}

/// A mass displaced in its shell.
struct Displaced {
    displacement_m: DVec3,
    rotation_rad: DVec3,
}

impl Displaced {
    fn at(six: &Vector6<f64>) -> Self {
        Self {
            displacement_m: DVec3::new(six[0], six[1], six[2]),
            rotation_rad: DVec3::new(six[3], six[4], six[5]),
        }
    }

    /// Force and torque about the cube's centre, over the mass, with which it stays at this pose in the shell: m/s^2 and m^2/s^2, shell
    /// axes.
    fn asked(
        &self,
        sensor: &TrueSensor,
        gravity_ground_m_s2: DVec3,
        motion: &TrueMotion,
    ) -> Vector6<f64> {
        let rate = motion.rate_shell_rad_s;
        let angular = motion.attitude.inverse() * motion.angular_ground_rad_s2;
        let turned = DQuat::from_scaled_axis(self.rotation_rad);
        let centre_m = turned * DVec3::from_array(sensor.mass_centre_m);
        let force = motion.specific_force_shell_m_s2(gravity_ground_m_s2)
            + motion.carried_m_s2(self.displacement_m + centre_m);
        let back = turned.inverse();
        let torque =
            turned * torque_per_mass(&sensor.inertia_per_mass, back * rate, back * angular);
        six(force, torque + centre_m.cross(force))
    }

    /// Force and torque of the limbs on the mass, as [`Self::asked`].
    fn resultant(&self, sensor: &TrueSensor) -> Vector6<f64> {
        let (k, length) = (
            sensor.stiffness_per_mass_per_s2,
            sensor.geometry.limb_length_m,
        );
        let elongations = self.elongations_m(&sensor.geometry);
        let moved = self.hinges_moved_m(&sensor.geometry);
        let directions = Geometry::directions_shell();
        let arms = sensor.geometry.mass_hinges_m();
        (0..LIMBS)
            .map(|limb| {
                let along =
                    (length * directions[limb] + moved[limb]) / (length + elongations[limb]);
                let force = -k * elongations[limb] * along;
                let arm = arms[limb] + (moved[limb] - self.displacement_m);
                six(force, arm.cross(force))
            })
            .sum()
    }

    /// What the hinges on the mass have moved by, m, without loss of digits where it is small.
    fn hinges_moved_m(&self, geometry: &Geometry) -> [DVec3; LIMBS] {
        // R - 1 = sin(a)/a [phi]x + 2 (sin(a/2)/a)^2 [phi]x^2 for an angle a = |phi|.
        let angle = self.rotation_rad.length();
        let (once, twice) = if angle > 0.0 {
            let half = (0.5 * angle).sin() / angle;
            (angle.sin() / angle, 2.0 * half * half)
        } else {
            (1.0, 0.5)
        };
        geometry.mass_hinges_m().map(|hinge| {
            let turned = self.rotation_rad.cross(hinge);
            self.displacement_m + once * turned + twice * self.rotation_rad.cross(turned)
        })
    }

    fn elongations_m(&self, geometry: &Geometry) -> [f64; LIMBS] {
        let directions = Geometry::directions_shell();
        let length = geometry.limb_length_m;
        let moved = self.hinges_moved_m(geometry);
        core::array::from_fn(|limb| {
            // l^2 - L^2 over l + L.
            let squares = moved[limb].dot(2.0 * length * directions[limb] + moved[limb]);
            squares / ((directions[limb] * length + moved[limb]).length() + length)
        })
    }
}

fn six(force: DVec3, torque: DVec3) -> Vector6<f64> {
    Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
}

/// l_i - L of every limb, m, with the mass displaced by `displacement_m` and turned by the rotation vector `rotation_rad`, shell
/// axes. Exact for any pose and without loss of digits for a small one.
pub fn elongations_m(
    geometry: &Geometry,
    displacement_m: DVec3,
    rotation_rad: DVec3,
) -> [f64; LIMBS] {
    Displaced {
        displacement_m,
        rotation_rad,
    }
    .elongations_m(geometry)
}
