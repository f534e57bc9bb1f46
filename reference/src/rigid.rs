//! The sensor with limbs that do not give way: closed form, a thousand times faster than MuJoCo.
//!
//! At 5 Hz the mass moves against the shell by some five millionths of what the shell moves by (omega^2 over k/m); where instruments are good to
//! 1 %, that is nothing. Campaigns by the hundred, to try a verdict on, are made this way; the test `ref_rigid_runs_are_mujocos`
//! holds it against MuJoCo. The stiffness of the limbs has no effect here but for its ratios, which say how a load is shared.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{SMatrix, SVector, Vector6};

use crate::geometry::LIMBS;
use crate::motion::{Motion, SimulatedRun, TrueMotion};
use crate::rig::run::Run;
use crate::sensor::{InertiaPerMass, TrueSensor};

/// What an instant asks of the limbs, over the mass, shell axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Acceleration of the mass's centre less gravity, m/s^2.
    pub specific_force_m_s2: DVec3,
    /// Torque about that centre, m^2/s^2.
    pub torque_m2_s2: DVec3,
}

impl Load {
    /// As six components, force first.
    pub fn wrench(&self) -> Vector6<f64> {
        let (a, m) = (self.specific_force_m_s2, self.torque_m2_s2);
        Vector6::new(a.x, a.y, a.z, m.x, m.y, m.z)
    }
}

/// Torque over mass, m^2/s^2, that turns the mass at a rate w, rad/s, and an angular acceleration alpha, rad/s^2, mass axes.
///
/// D'Alembert's principle: each element at r needs the force of its acceleration alpha x r + w x (w x r), and the sum of the
/// torques r x a is tr(S) alpha - S alpha - w x S w with the mass's second moments S, the mean of r r^T.
pub fn torque_per_mass(
    inertia: &InertiaPerMass,
    rate_rad_s: DVec3,
    angular_rad_s2: DVec3,
) -> DVec3 {
    // The tensor of inertia is tr(S) - S, and so tr(S) is half of its trace.
    let trace_m2 = 0.5 * (inertia.xx_m2 + inertia.yy_m2 + inertia.zz_m2);
    let second_m2 = DMat3::from_diagonal(DVec3::splat(trace_m2)) - inertia.tensor_m2();
    trace_m2 * angular_rad_s2
        - second_m2 * angular_rad_s2
        - rate_rad_s.cross(second_m2 * rate_rad_s)
}

/// A sensor without compliance.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidSensor {
    /// Forces per mass over acceleration and torque per mass.
    load_sharing: SMatrix<f64, LIMBS, 6>,
    inertia: InertiaPerMass,
    centre_m: DVec3,
}

impl RigidSensor {
    /// A sensor whose limbs' stiffnesses stand in the given ratio. None for limbs that do not hold the mass.
    pub fn new(sensor: &TrueSensor, stiffness_ratio: &[f64; LIMBS]) -> Option<Self> {
        let wrenches = sensor.geometry.limb_wrenches();
        let weighted = SMatrix::from_diagonal(&SVector::from(*stiffness_ratio)) * wrenches;
        Some(Self {
            load_sharing: weighted * (wrenches.transpose() * weighted).try_inverse()?,
            inertia: sensor.inertia_per_mass,
            centre_m: DVec3::from_array(sensor.mass_centre_m),
        })
    }

    /// Limb forces per mass, m/s^2, under a load.
    pub fn forces_m_s2(&self, load: &Load) -> [f64; LIMBS] {
        // The limbs hold the cube about its centre.
        let about_the_cube = Load {
            torque_m2_s2: load.torque_m2_s2 + self.centre_m.cross(load.specific_force_m_s2),
            ..*load
        };
        (self.load_sharing * about_the_cube.wrench()).into()
    }

    /// A whole run of the rig. A pinion turns about an axis that is the same in shell and ground.
    pub fn simulate(
        &self,
        run: &Run,
        gravity_ground_m_s2: DVec3,
        sample_rate_hz: f64,
    ) -> SimulatedRun {
        let samples = (run.duration_s() * sample_rate_hz).floor() as usize + 1;
        let axis = run.direction_ground;
        let (_, rotation) = run.amplitudes();
        let (limb_force_per_mass_m_s2, truth) = (0..samples)
            .map(|sample| {
                let time_s = sample as f64 / sample_rate_hz;
                let [place, speed, _] = run.stroke_share(time_s);
                let (linear_ground_m_s2, angular_ground_rad_s2) = run.acceleration(time_s);
                let motion = TrueMotion {
                    linear_ground_m_s2,
                    angular_ground_rad_s2,
                    rate_shell_rad_s: axis * (rotation * speed),
                    attitude: DQuat::from_axis_angle(axis, rotation * place),
                };
                let specific = motion.linear_ground_m_s2 - gravity_ground_m_s2;
                let load = Load {
                    specific_force_m_s2: motion.attitude.inverse() * specific
                        + motion.carried_m_s2(self.centre_m),
                    torque_m2_s2: torque_per_mass(
                        &self.inertia,
                        motion.rate_shell_rad_s,
                        motion.angular_ground_rad_s2,
                    ),
                };
                (self.forces_m_s2(&load), motion)
            })
            .unzip();
        SimulatedRun {
            motion: *run,
            gravity_ground_m_s2,
            sample_rate_hz,
            limb_force_per_mass_m_s2,
            truth,
        }
    }
}
