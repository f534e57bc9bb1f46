//! What real limbs have beside the one axial stiffness of equation (2): unequal stiffnesses, flexures that bend, a mass.
//!
//! # Flexures
//! A limb is a rod between two flexures, each with a bending stiffness b about the two axes square to the limb. With u, the
//! displacement of the limb's end square to the limb, the rod tilts by u/L, and the flexure at the shell bends by as much; the one at the
//! mass bends by the tilt less the mass's own rotation, which is the displacement, over L, of the point of the mass that at rest lies at
//! the limb's hinge on the *shell*. So the energy of both is that of two springs of stiffness b/L^2, square to the limb, at the
//! two ends of the limb. This is exact for small displacements; the mass moves by 1e-6 m and so the error is of order 1e-4 of the
//! effect. Torsion of the limbs is left out: round flexures of steel would add 0.38 b about each limb's axis, some 1/16 to 1/11 of what
//! bending opposes to a rotation of the mass.
//!
//! # Mass
//! A limb is a slender, uniform rod whose points move as a straight line between its ends does. Its inertia and weight reach
//! the mass by the shape functions of such a rod: a third of its mass moves with its end on the mass, a sixth of it is felt there
//! with the acceleration of its end on the shell. What a piezo senses is the mean force along the rod, and that is the stiffness times the
//! elongation, as without mass. An element at the shell's end shows besides what accelerates half of the rod along itself
//! ([`shown_of_rods_m_s2`]). What is left out are vibrations of the rod itself, far above the sensor's.

use glam::{DQuat, DVec3};
use nalgebra::{Matrix3x6, Matrix6, SMatrix, SVector, Vector6};
use serde::Serialize;

use crate::geometry::{Geometry, LIMBS};
use crate::motion::TrueMotion;

/// Shares of a rod's mass that its end on the mass carries: with its own acceleration, and with that of the other end.
pub const NEAR_SHARE: f64 = 1.0 / 3.0;
/// See [`NEAR_SHARE`].
pub const FAR_SHARE: f64 = 1.0 / 6.0;

/// The limbs beside their mean axial stiffness; all pure numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limbs {
    /// Axial stiffness of each limb over k.
    pub stiffness_ratio: [f64; LIMBS],
    /// Stiffness of a limb against displacement of its end square to it over its axial stiffness: 2 b/(L^2 k).
    pub lateral_stiffness: f64,
    /// Damping of a limb in the same directions over the critical damping of one limb under the whole mass, 2 sqrt(k m).
    pub lateral_damping: f64,
    /// Mass of one limb over the seismic mass.
    pub mass: f64,
}

/// What each limb's element at the shell shows of half its rod, `rod_mass` over the seismic mass: the force over that mass, m/s^2, which
/// accelerates it along the rod with the shell.
#[must_use]
pub fn shown_of_rods_m_s2(
    geometry: &Geometry,
    rod_mass: f64,
    motion: &TrueMotion,
    gravity_ground_m_s2: DVec3,
) -> [f64; LIMBS] {
    let (near, far) = (geometry.mass_hinges_m(), geometry.shell_hinges_m());
    let directions = Geometry::directions_shell();
    let centre = motion.specific_force_shell_m_s2(gravity_ground_m_s2);
    core::array::from_fn(|limb| {
        let middle_m = 0.5 * (near[limb] + far[limb]);
        rod_mass * directions[limb].dot(centre + motion.carried_m_s2(middle_m))
    })
}

impl Default for Limbs {
    fn default() -> Self {
        Self::IDEAL
    }
}

impl Limbs {
    /// Equal limbs without mass between hinges that do not resist.
    pub const IDEAL: Self = Self {
        stiffness_ratio: [1.0; LIMBS],
        lateral_stiffness: 0.0,
        lateral_damping: 0.0,
        mass: 0.0,
    };

    /// Whether the flexures do anything.
    pub fn bend(&self) -> bool {
        self.lateral_stiffness > 0.0 || self.lateral_damping > 0.0
    }

    /// The points where limb `limb` resists displacement square to it, from the origin of the mass, m, and the two directions.
    pub fn lateral_points(geometry: &Geometry, limb: usize) -> ([DVec3; 2], [DVec3; 2]) {
        let (u, v) = Geometry::directions_shell()[limb].any_orthonormal_pair();
        let points = [
            geometry.mass_hinges_m()[limb],
            geometry.shell_hinges_m()[limb],
        ];
        (points, [u, v])
    }

    /// Stiffness over k of the mass's six degrees of freedom in the shell: 1, m and m^2.
    pub fn stiffness(&self, geometry: &Geometry) -> Matrix6<f64> {
        let wrenches = geometry.limb_wrenches();
        let weighted = SMatrix::from_diagonal(&SVector::from(self.stiffness_ratio)) * wrenches;
        let mut stiffness = wrenches.transpose() * weighted;
        if self.lateral_stiffness > 0.0 {
            for limb in 0..LIMBS {
                let (points, directions) = Self::lateral_points(geometry, limb);
                for point in points {
                    for direction in directions {
                        let moment = point.cross(direction);
                        let row = Vector6::new(
                            direction.x,
                            direction.y,
                            direction.z,
                            moment.x,
                            moment.y,
                            moment.z,
                        );
                        stiffness += row * row.transpose() * (0.5 * self.lateral_stiffness);
                    }
                }
            }
        }
        stiffness
    }

    /// What the limbs add to the mass matrix of the mass about its origin, over the seismic mass: 1, m and m^2.
    pub fn mass_matrix(&self, geometry: &Geometry) -> Matrix6<f64> {
        let mut sum = Matrix6::zeros();
        for end in geometry.mass_hinges_m() {
            // Velocity of the end: v + w x t.
            let velocity = Matrix3x6::new(
                1.0, 0.0, 0.0, 0.0, end.z, -end.y, //
                0.0, 1.0, 0.0, -end.z, 0.0, end.x, //
                0.0, 0.0, 1.0, end.y, -end.x, 0.0,
            );
            sum += velocity.transpose() * velocity * (NEAR_SHARE * self.mass);
        }
        sum
    }

    /// What reaches the mass of the limbs' inertia by their ends on the shell, over the seismic mass: force, ground axes, m/s^2, and
    /// torque about the mass's origin, mass axes, m^2/s^2. `specific` is the acceleration of a point of the shell, given in shell
    /// axes, less gravity, ground axes.
    pub fn far_load(
        &self,
        geometry: &Geometry,
        mass_to_ground: DQuat,
        specific: impl Fn(DVec3) -> DVec3,
    ) -> Vector6<f64> {
        let back = mass_to_ground.inverse();
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        let hinges = geometry.shell_hinges_m();
        for (hinge, end) in hinges.into_iter().zip(geometry.mass_hinges_m()) {
            let here = specific(hinge) * (-FAR_SHARE * self.mass);
            force += here;
            torque += end.cross(back * here);
        }
        Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
    }
}
