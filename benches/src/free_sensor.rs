//! The sensor in MuJoCo with nobody driving the shell, for what MuJoCo's own steps cost.

use glam::{DQuat, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use sixaxis_core::Geometry;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_props::problem::recorded::{STEP_S, model};
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::rig::run::Run;

/// Coordinates and degrees of freedom of a free body in MuJoCo.
const FREE_BODY_COORDINATES: usize = 7;
const FREE_BODY_DOFS: usize = 6;

/// The sensor in MuJoCo by itself, nobody driving the shell: both bodies free, at rest, the mass displaced.
pub struct FreeSensor {
    /// MuJoCo's state.
    pub data: MjData<Box<MjModel>>,
    model: SensorModel,
}

/// Displacement of the mass in [`FreeSensor`], m and rad: the size of a fast run's.
const DISPLACEMENT: (DVec3, DVec3) = (DVec3::new(2e-7, -3e-7, 4e-7), DVec3::new(-5e-6, 1e-5, 7e-6));

impl FreeSensor {
    /// Loads the sensor of a run and displaces its mass.
    ///
    /// # Panics
    /// If MuJoCo refuses the sensor.
    pub fn new(run: &Run) -> Self {
        let model = model(run);
        let compiled =
            MjModel::from_xml_string(&model.to_mjcf(STEP_S)).expect("MuJoCo's model of the sensor");
        let mut data = MjData::new(Box::new(compiled));
        let (position, rotation) = DISPLACEMENT;
        let q = DQuat::from_scaled_axis(rotation);
        data.qpos_mut()[FREE_BODY_COORDINATES..]
            .copy_from_slice(&[position.x, position.y, position.z, q.w, q.x, q.y, q.z]);
        Self { data, model }
    }

    /// Linear, m/s^2, and angular acceleration, rad/s^2, of the mass: MuJoCo's beside Newton's and Euler's with the
    /// core's limb directions. For the state in which it was created, where nothing moves yet.
    #[must_use]
    pub fn accelerations(&mut self) -> [(DVec3, DVec3); 2] {
        self.data.forward();
        let a = &self.data.qacc()[FREE_BODY_DOFS..];
        let (position_shell_m, rotation_rad) = DISPLACEMENT;
        let pose = Pose {
            position_shell_m,
            rotation_rad,
        };
        let geometry = &Geometry::PAPER;
        let force = pose
            .elongations_m(geometry)
            .map(|dl| -self.model.stiffness_per_mass_per_s2 * dl);
        let wrench = LimbWrench::at_pose(geometry, &pose, &force);
        let torque_mass = pose.rotation_matrix().transpose() * wrench.torque_shell_m2_s2;
        let inertia = self.model.inertia_per_mass.tensor_m2();
        [
            (
                DVec3::new(a[0], a[1], a[2]),
                wrench.force_shell_m_s2 + self.model.gravity_ground_m_s2,
            ),
            (
                DVec3::new(a[3], a[4], a[5]),
                inertia.inverse() * torque_mass,
            ),
        ]
    }

    /// Takes `steps` of MuJoCo's own steps and returns how far the common centre of mass has fallen, m, beside
    /// g t^2/2: limbs are internal and cannot change it.
    #[must_use]
    pub fn fall(&mut self, steps: u32) -> (DVec3, DVec3) {
        let start = self.centre_of_mass_m();
        for _ in 0..steps {
            self.data.step();
        }
        let time_s = f64::from(steps) * STEP_S;
        (
            self.centre_of_mass_m() - start,
            self.model.gravity_ground_m_s2 * (0.5 * time_s * time_s),
        )
    }

    fn centre_of_mass_m(&self) -> DVec3 {
        let q = self.data.qpos();
        let place = |body: usize| DVec3::from_slice(&q[body * FREE_BODY_COORDINATES..]);
        // World, shell, mass.
        let masses = self.data.model().body_mass();
        (place(0) * masses[1] + place(1) * masses[2]) / (masses[1] + masses[2])
    }
}
