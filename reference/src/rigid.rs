//! The rig's runs with limbs that do not give way: closed form, a thousand times faster than [`crate::simulation`].
//!
//! Up to 5 Hz the mass moves against the shell by a millionth of what the shell moves by; where instruments are good to 1 %,
//! that is nothing. Campaigns by the hundred, to try a verdict on, are made this way; the test `ref_rigid_runs_are_mujocos`
//! holds it against MuJoCo. The stiffness of the limbs has no effect here but for its ratios, which say how a load is shared.

use glam::{DQuat, DVec3};
use nalgebra::{SMatrix, SVector, Vector6};
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS};

use crate::mjcf::limb_jacobian;
use crate::recording::{SimulatedRun, TrueMotion};
use crate::rig::Run;

/// A sensor without compliance.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidSensor {
    /// Forces per mass over acceleration and torque per mass.
    shares: SMatrix<f64, LIMBS, 6>,
    inertia: InertiaPerMass,
}

impl RigidSensor {
    /// A sensor whose limbs' stiffnesses stand in the given ratio. None for limbs that do not hold the mass.
    #[must_use]
    pub fn new(
        geometry: &Geometry,
        inertia: &InertiaPerMass,
        stiffness_ratio: &[f64; LIMBS],
    ) -> Option<Self> {
        let jacobian = limb_jacobian(geometry);
        let stiffness = SMatrix::from_diagonal(&SVector::from(*stiffness_ratio));
        let weighted = stiffness * jacobian;
        let shares = weighted * (jacobian.transpose() * weighted).try_inverse()?;
        Some(Self {
            shares,
            inertia: *inertia,
        })
    }

    /// Limb forces per mass, m/s^2, that an acceleration (less gravity) and a torque per mass ask for, shell axes.
    #[must_use]
    pub fn forces_m_s2(&self, acceleration: DVec3, torque_m2_s2: DVec3) -> [f64; LIMBS] {
        let (a, m) = (acceleration, torque_m2_s2);
        (self.shares * Vector6::new(a.x, a.y, a.z, m.x, m.y, m.z)).into()
    }

    /// A whole run of the rig. A pinion turns about an axis that is the same in shell and ground.
    #[must_use]
    pub fn play(&self, run: &Run, gravity_ground_m_s2: DVec3, sample_rate_hz: f64) -> SimulatedRun {
        let samples = (run.duration_s() * sample_rate_hz).floor() as usize + 1;
        let axis = run.direction_ground;
        let (travel, rotation) = run.amplitudes();
        let (limb_force_per_mass_m_s2, truth) = (0..samples)
            .map(|sample| {
                let [place, speed, acceleration] = run.stroke_share(sample as f64 / sample_rate_hz);
                let attitude = DQuat::from_axis_angle(axis, rotation * place);
                let linear = axis * (travel * acceleration);
                let rate = axis * (rotation * speed);
                let angular = axis * (rotation * acceleration);
                let specific = attitude.inverse() * (linear - gravity_ground_m_s2);
                let torque = euler_torque(&self.inertia, rate, angular);
                let motion = TrueMotion {
                    linear_ground_m_s2: linear,
                    angular_ground_rad_s2: angular,
                    rate_shell_rad_s: rate,
                    attitude,
                };
                (self.forces_m_s2(specific, torque), motion)
            })
            .unzip();
        SimulatedRun {
            run: *run,
            gravity_ground_m_s2,
            sample_rate_hz,
            limb_force_per_mass_m_s2,
            truth,
        }
    }
}
