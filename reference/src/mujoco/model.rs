//! The 9-SPS sensor as a MuJoCo model, in MuJoCo's own XML.
//!
//! Shell and mass are two free bodies; nine spatial tendons with stiffness, damping and rest length are the limbs. Flexures that bend
//! are four more tendons a limb, as [`crate::limbs`] derives them; a limb's mass is partly on the mass, partly a force
//! that [`super::simulation`] applies.
//! Geoms are there to be looked at and take no part in the dynamics.

use core::f64::consts::TAU;
use std::fmt::Write as _;

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, Quaternion, Rotation3, SymmetricEigen, UnitQuaternion};

use crate::geometry::{Geometry, LIMBS};
use crate::limbs::{Limbs, NEAR_SHARE};
use crate::linear_theory::{NaturalMode, modes};
use crate::sensor::{InertiaPerMass, MASS_KG, TrueSensor};

/// What MuJoCo needs to know of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorModel {
    /// Lengths from the drawing.
    pub geometry: Geometry,
    /// Seismic mass, kg. Only ratios to it matter; the paper's design s/m at s = 1 makes it 0.187 kg.
    pub mass_kg: f64,
    /// I/m about the mass's centre, mass axes.
    pub inertia_per_mass: InertiaPerMass,
    /// From the cube's centre to the mass's, mass axes, m.
    pub mass_centre_m: DVec3,
    /// k/m, s^-2: of every limb, or what [`Limbs::stiffness_ratio`] is over.
    pub stiffness_per_mass_per_s2: f64,
    /// What the limbs have beside that.
    pub limbs: Limbs,
    /// Damping of every limb as a fraction of the critical damping of one limb under the whole mass.
    ///
    /// The paper neglects damping; a little of it keeps rounding noise from walking into the modes.
    pub damping_ratio: f64,
    /// Gravity in ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
}

/// Mass of the shell, kg: its motion is prescribed, so any will do.
pub const SHELL_MASS_KG: f64 = 0.5;
/// Its inertia about any axis, kg m^2.
pub const SHELL_INERTIA_KG_M2: f64 = 1e-3;

/// Limb damping of the reference: 2 % of critical keeps rounding noise out of the modes and changes a limb's length at
/// 5 Hz by 1e-4 of its micrometre, 1e-9 of an acceleration.
pub const DAMPING_RATIO: f64 = 0.02;

impl SensorModel {
    /// A true sensor of ideal limbs with the design's mass and the reference's [`DAMPING_RATIO`] under gravity in ground axes, m/s^2.
    pub fn new(sensor: &TrueSensor, gravity_ground_m_s2: DVec3) -> Self {
        Self {
            geometry: sensor.geometry,
            mass_kg: MASS_KG,
            inertia_per_mass: sensor.inertia_per_mass,
            mass_centre_m: DVec3::from_array(sensor.mass_centre_m),
            stiffness_per_mass_per_s2: sensor.stiffness_per_mass_per_s2,
            limbs: Limbs::IDEAL,
            damping_ratio: DAMPING_RATIO,
            gravity_ground_m_s2,
        }
    }

    /// The six modes by linear theory.
    pub(super) fn modes(&self) -> [NaturalMode; 6] {
        let k = self.stiffness_per_mass_per_s2;
        modes(&self.geometry, &self.inertia_per_mass, k, &self.limbs)
    }

    /// Fastest decay that damping alone would make, the largest eigenvalue of C over M, 1/s.
    pub(super) fn fastest_decay_per_s(&self) -> f64 {
        let damping = Limbs {
            stiffness_ratio: [self.damping_ratio; LIMBS],
            lateral_stiffness: self.limbs.lateral_damping,
            ..self.limbs
        };
        let unit_per_s = 2.0 * self.stiffness_per_mass_per_s2.sqrt();
        let [.., last] = modes(&self.geometry, &self.inertia_per_mass, unit_per_s, &damping);
        (TAU * last.frequency_hz).powi(2)
    }

    /// Damping of one limb over the mass, c/m, 1/s.
    pub fn damping_per_mass_per_s(&self) -> f64 {
        2.0 * self.damping_ratio * self.stiffness_per_mass_per_s2.sqrt()
    }

    /// The model as MJCF. `python -m mujoco.viewer --mjcf=FILE` opens it.
    pub fn to_mjcf(&self, step_s: f64) -> String {
        let mut xml = String::new();
        self.write_mjcf(&mut xml, step_s)
            .expect("writing to a String cannot fail");
        xml
    }

    fn write_mjcf(&self, xml: &mut String, step_s: f64) -> std::fmt::Result {
        let g = self.gravity_ground_m_s2;
        let n = self.geometry.half_edge_m;
        let (mass_kg, centre, tensor) = self.inertial();
        let (principal, quaternion) = principal_inertia_kg_m2(&tensor);
        writeln!(xml, "<mujoco model=\"sixaxis 9-SPS accelerometer\">")?;
        writeln!(xml, "  <compiler angle=\"radian\" autolimits=\"true\"/>")?;
        writeln!(
            xml,
            "  <option integrator=\"RK4\" timestep=\"{step_s}\" gravity=\"{} {} {}\">",
            g.x, g.y, g.z
        )?;
        writeln!(
            xml,
            "    <flag contact=\"disable\" constraint=\"disable\" warmstart=\"disable\"/>\n  </option>"
        )?;
        writeln!(xml, "  <visual><map znear=\"0.001\"/></visual>")?;
        writeln!(xml, "  <statistic extent=\"0.15\" center=\"0 0 0\"/>")?;
        writeln!(xml, "  <default><site size=\"0.0015\"/></default>")?;
        writeln!(xml, "  <worldbody>")?;
        writeln!(xml, "    <light pos=\"0.2 -0.2 0.4\"/>")?;

        writeln!(
            xml,
            "    <body name=\"shell\">\n      <freejoint name=\"shell\"/>"
        )?;
        writeln!(
            xml,
            "      <inertial pos=\"0 0 0\" mass=\"{SHELL_MASS_KG}\" diaginertia=\"{SHELL_INERTIA_KG_M2} {SHELL_INERTIA_KG_M2} {SHELL_INERTIA_KG_M2}\"/>"
        )?;
        let wall = n + self.geometry.limb_length_m + 0.002;
        writeln!(
            xml,
            "      <geom type=\"box\" size=\"{wall} {wall} {wall}\" rgba=\"0.5 0.6 0.8 0.15\" contype=\"0\" conaffinity=\"0\"/>"
        )?;
        for (limb, hinge) in self.geometry.shell_hinges_m().iter().enumerate() {
            let i = limb + 1;
            writeln!(
                xml,
                "      <site name=\"shell_hinge_{i}\" pos=\"{} {} {}\" rgba=\"0.2 0.4 0.8 1\"/>",
                hinge.x, hinge.y, hinge.z
            )?;
        }
        if self.limbs.bend() {
            self.write_flexure_sites(xml, "shell", self.geometry.limb_length_m)?;
        }
        writeln!(xml, "    </body>")?;

        writeln!(
            xml,
            "    <body name=\"mass\">\n      <freejoint name=\"mass\"/>"
        )?;
        writeln!(
            xml,
            "      <inertial pos=\"{} {} {}\" mass=\"{}\" quat=\"{} {} {} {}\" diaginertia=\"{} {} {}\"/>",
            centre.x,
            centre.y,
            centre.z,
            mass_kg,
            quaternion.w,
            quaternion.i,
            quaternion.j,
            quaternion.k,
            principal[0],
            principal[1],
            principal[2]
        )?;
        writeln!(
            xml,
            "      <geom type=\"box\" size=\"{n} {n} {n}\" rgba=\"0.85 0.55 0.25 0.9\" contype=\"0\" conaffinity=\"0\"/>"
        )?;
        for (limb, hinge) in self.geometry.mass_hinges_m().iter().enumerate() {
            let i = limb + 1;
            writeln!(
                xml,
                "      <site name=\"mass_hinge_{i}\" pos=\"{} {} {}\" rgba=\"0.9 0.3 0.2 1\"/>",
                hinge.x, hinge.y, hinge.z
            )?;
        }
        if self.limbs.bend() {
            self.write_flexure_sites(xml, "mass", 0.0)?;
        }
        writeln!(xml, "    </body>\n  </worldbody>\n  <tendon>")?;

        let stiffness_n_per_m = self.stiffness_per_mass_per_s2 * self.mass_kg;
        let damping_n_s_per_m = self.damping_per_mass_per_s() * self.mass_kg;
        for (limb, ratio) in self.limbs.stiffness_ratio.into_iter().enumerate() {
            let i = limb + 1;
            writeln!(
                xml,
                "    <spatial name=\"limb_{i}\" stiffness=\"{}\" damping=\"{damping_n_s_per_m}\" springlength=\"{}\" width=\"0.001\"><site site=\"shell_hinge_{i}\"/><site site=\"mass_hinge_{i}\"/></spatial>",
                stiffness_n_per_m * ratio,
                self.geometry.limb_length_m
            )?;
        }
        if self.limbs.bend() {
            self.write_flexures(xml)?;
        }
        writeln!(xml, "  </tendon>\n</mujoco>")
    }

    /// Damping of a limb square to it over the mass, 1/s.
    fn lateral_damping_per_mass_per_s(&self) -> f64 {
        2.0 * self.limbs.lateral_damping * self.stiffness_per_mass_per_s2.sqrt()
    }

    /// A site for each end of a limb and each direction square to it, on one of the bodies; `away` is how far off the springs begin, m.
    fn write_flexure_sites(&self, xml: &mut String, body: &str, away_m: f64) -> std::fmt::Result {
        self.for_each_flexure(|name, point, direction| {
            let site = point + direction * away_m;
            writeln!(
                xml,
                "      <site name=\"{body}_{name}\" pos=\"{} {} {}\" rgba=\"0 0 0 0\"/>",
                site.x, site.y, site.z
            )
        })
    }

    /// Springs and dampers square to the limbs: half of each at either end.
    fn write_flexures(&self, xml: &mut String) -> std::fmt::Result {
        let lateral = self.limbs.lateral_stiffness * self.stiffness_per_mass_per_s2;
        let stiffness = 0.5 * lateral * self.mass_kg;
        let damping = 0.5 * self.lateral_damping_per_mass_per_s() * self.mass_kg;
        let length_m = self.geometry.limb_length_m;
        self.for_each_flexure(|name, _, _| {
            writeln!(
                xml,
                "    <spatial name=\"{name}\" stiffness=\"{stiffness}\" damping=\"{damping}\" springlength=\"{length_m}\" width=\"0.0001\"><site site=\"shell_{name}\"/><site site=\"mass_{name}\"/></spatial>"
            )
        })
    }

    fn for_each_flexure(
        &self,
        mut write: impl FnMut(&str, DVec3, DVec3) -> std::fmt::Result,
    ) -> std::fmt::Result {
        for limb in 0..LIMBS {
            let (points, directions) = Limbs::lateral_points(&self.geometry, limb);
            for (end, point) in ["mass", "shell"].into_iter().zip(points) {
                for (side, direction) in ["u", "v"].into_iter().zip(directions) {
                    let name = format!("flexure_{}_{end}_{side}", limb + 1);
                    write(&name, point, direction)?;
                }
            }
        }
        Ok(())
    }

    /// Mass, kg, its centre, m, and its inertia about that, kg m^2, of the mass with what moves with it of the limbs.
    fn inertial(&self) -> (f64, DVec3, DMat3) {
        let tensor = self.inertia_per_mass.tensor_m2() * self.mass_kg;
        if self.limbs.mass == 0.0 {
            return (self.mass_kg, self.mass_centre_m, tensor);
        }
        let added_kg = NEAR_SHARE * self.limbs.mass * self.mass_kg;
        let ends = self.geometry.mass_hinges_m();
        let mass_kg = self.mass_kg + LIMBS as f64 * added_kg;
        let moments =
            self.mass_centre_m * self.mass_kg + ends.into_iter().sum::<DVec3>() * added_kg;
        let centre = moments / mass_kg;
        let about = |point: DVec3, mass_kg: f64| {
            let outer = DMat3::from_cols(point * point.x, point * point.y, point * point.z);
            (DMat3::from_diagonal(DVec3::splat(point.length_squared())) - outer) * mass_kg
        };
        let origin = ends.into_iter().fold(
            tensor + about(self.mass_centre_m, self.mass_kg),
            |sum, end| sum + about(end, added_kg),
        );
        (mass_kg, centre, origin - about(centre, mass_kg))
    }
}

/// Principal moments, kg m^2, and the quaternion of the principal axes in mass axes, of a tensor of inertia.
///
/// MuJoCo would diagonalise a full tensor itself, but only down to an absolute 1e-12 kg m^2, 2e-8 of this
/// tensor; handing it the principal axes keeps the truth at rounding.
fn principal_inertia_kg_m2(tensor_kg_m2: &DMat3) -> ([f64; 3], Quaternion<f64>) {
    let eigen = SymmetricEigen::new(Matrix3::from_column_slice(&tensor_kg_m2.to_cols_array()));
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let rotation = Rotation3::from_matrix_unchecked(axes);
    let q = UnitQuaternion::from_rotation_matrix(&rotation);
    let [a, b, c] = [0, 1, 2].map(|i| eigen.eigenvalues[i]);
    ([a, b, c], q.into_inner())
}
