//! MuJoCo as truth: the sensor with its shell driven exactly along a prescribed motion.
//!
//! The shell is a free body. At every stage of every step its generalized force is set to M a_des + bias - passive,
//! so that it has exactly the wanted acceleration while mass and shell are integrated alike: their difference, 1e-7 m
//! in a motion of 0.1 m, stays clean. MuJoCo's default semi-implicit step would not do: its velocities belong to half
//! steps, and w x I w taken half a step late is an error of first order in the step, by estimate 1e-4 of the angular
//! acceleration at 5 Hz.
//!
//! # The integrator
//! Forces, masses and kinematics are MuJoCo's; the Runge-Kutta step around them is written out here, for two reasons.
//! The drive must be evaluated at every stage. And MuJoCo's own `mj_RungeKutta` averages the angular velocities of the
//! four stages as if they were all seen from one attitude: exact while the axis stands still, but only of second order
//! for a body that tumbles (test `order_mujocos_own_step_is_second_for_a_tumbling_body`). Here the stages are carried
//! back to the attitude at the start of the step by the inverse of the right Jacobian of SO(3) (Munthe-Kaas), which
//! keeps fourth order. About a fixed axis the two agree to rounding (test `ref_fixed_axis_step_is_mujocos_own`).

use glam::{DQuat, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use nalgebra::Vector6;
use thiserror::Error;

use super::model::{SHELL_INERTIA_KG_M2, SHELL_MASS_KG, SensorModel};
use super::state::{BODY_DOFS, BodyState, Data, Rates, State};
use crate::geometry::LIMBS;
use crate::linear_theory::stiffness_per_mass;
use crate::motion::{Motion, TrueMotion};

/// Newton steps to static equilibrium; each gains five digits.
const EQUILIBRIUM_ITERATIONS: usize = 8;

/// Places over which the static limb forces are averaged, and the edge of the cube they fill, m.
const REST_PLACES: u32 = 400;
const REST_SPREAD_M: f64 = 1e-3;

/// What can go wrong with a simulation.
#[derive(Debug, Error)]
pub enum SimulationError {
    /// MuJoCo refuses the model.
    #[error("MuJoCo refused the sensor model: {0}")]
    Model(String),
    /// The step is longer than the integrator's stability limit for the stiffest mode and the damping.
    #[error(
        "step {step_s} s is unstable: the stiffest mode, {highest_mode_hz:.0} Hz, and damping allow at most {limit_s:.2e} s"
    )]
    StepTooLong {
        /// The step asked for.
        step_s: f64,
        /// Highest mode of the sensor.
        highest_mode_hz: f64,
        /// Longest stable step.
        limit_s: f64,
    },
    /// Limbs with mass in a shell that nobody drives: what reaches the mass of their inertia depends on the shell's acceleration.
    #[error("limbs with mass need a shell whose motion is prescribed")]
    MassOfFreeLimbs,
    /// A state is no longer finite.
    #[error("the simulated state is not finite at {time_s} s")]
    Diverged {
        /// Simulated time.
        time_s: f64,
    },
}

/// Everything the simulator knows at one instant. Accelerations are MuJoCo's own, not the motion law's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// Simulated time, s.
    pub time_s: f64,
    /// Shell.
    pub shell: BodyState,
    /// Mass.
    pub mass: BodyState,
    /// Linear acceleration of the shell, ground axes, m/s^2.
    pub shell_acceleration_ground_m_s2: DVec3,
    /// Angular acceleration of the shell, shell axes, rad/s^2.
    pub shell_angular_acceleration_shell_rad_s2: DVec3,
    /// Force in each limb over the mass, spring and damper, positive in compression, m/s^2.
    pub limb_force_per_mass_m_s2: [f64; LIMBS],
    /// l_i - L, m.
    pub limb_elongation_m: [f64; LIMBS],
}

impl Snapshot {
    /// Displacement of the mass in the shell, shell axes, m, and its rotation vector, rad.
    pub fn relative_pose(&self) -> (DVec3, DVec3) {
        let back = self.shell.attitude.inverse();
        let r = back * (self.mass.position_ground_m - self.shell.position_ground_m);
        let q = back * self.mass.attitude;
        // For the 1e-6 rad of a relative rotation, 2 asin(|v|) v/|v| equals 2 v to rounding.
        let sign = if q.w < 0.0 { -2.0 } else { 2.0 };
        (r, DVec3::new(q.x, q.y, q.z) * sign)
    }

    /// The shell's motion.
    pub fn true_motion(&self) -> TrueMotion {
        let attitude = self.shell.attitude;
        TrueMotion {
            linear_ground_m_s2: self.shell_acceleration_ground_m_s2,
            angular_ground_rad_s2: attitude * self.shell_angular_acceleration_shell_rad_s2,
            rate_shell_rad_s: self.shell.rate_body_rad_s,
            attitude,
        }
    }
}

/// A running simulation of one sensor.
pub struct Simulation {
    data: Data,
    model: SensorModel,
    step_s: f64,
    time_s: f64,
}

impl Simulation {
    /// Loads the sensor into MuJoCo and lets it hang at rest in static equilibrium.
    ///
    /// # Errors
    /// [`SimulationError::Model`] or [`SimulationError::StepTooLong`].
    pub fn new(model: &SensorModel, step_s: f64) -> Result<Self, SimulationError> {
        let highest_mode_hz = model.modes()[5].frequency_hz;
        // RK4 is stable up to 2.828 on the imaginary axis, and to 2.785 on the negative real one; a twentieth is left for what
        // damping and stiffness do together and for geometry.
        let fastest = (core::f64::consts::TAU * highest_mode_hz).max(model.fastest_decay_per_s());
        let limit_s = 2.65 / fastest;
        if !(step_s > 0.0 && step_s <= limit_s) {
            return Err(SimulationError::StepTooLong {
                step_s,
                highest_mode_hz,
                limit_s,
            });
        }
        let compiled = MjModel::from_xml_string(&model.to_mjcf(step_s))
            .map_err(|e| SimulationError::Model(e.to_string()))?;
        let mut simulation = Self {
            data: MjData::new(Box::new(compiled)),
            model: *model,
            step_s,
            time_s: 0.0,
        };
        simulation.settle();
        Ok(simulation)
    }

    /// Simulated time, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Newton iteration on MuJoCo's own acceleration of the mass with the shell held still.
    fn settle(&mut self) {
        let k = self.model.stiffness_per_mass_per_s2;
        let tensor = self.model.inertia_per_mass.tensor_m2();
        let SensorModel {
            geometry, limbs, ..
        } = &self.model;
        let Some(cholesky) = stiffness_per_mass(geometry, k, limbs).cholesky() else {
            return;
        };
        let of_limbs = (limbs.mass > 0.0).then(|| limbs.mass_matrix(geometry));
        for _ in 0..EQUILIBRIUM_ITERATIONS {
            self.forward(DVec3::ZERO, DVec3::ZERO);
            let a = self.data.qacc();
            let force = DVec3::new(a[6], a[7], a[8]);
            let torque = tensor * DVec3::new(a[9], a[10], a[11]);
            let mut load = Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
            if let Some(of_limbs) = of_limbs {
                load += of_limbs * Vector6::from_column_slice(&a[BODY_DOFS..]);
            }
            let step = cholesky.solve(&load);
            let mut state = State::read(&self.data);
            state.mass.position_ground_m += DVec3::new(step[0], step[1], step[2]);
            state.mass.attitude = (state.mass.attitude
                * DQuat::from_scaled_axis(DVec3::new(step[3], step[4], step[5])))
            .normalize();
            state.write(&mut self.data);
        }
    }

    /// MuJoCo's forward dynamics of two bodies that nothing but the limbs and gravity acts on.
    fn forward_free(&mut self) {
        let data = &mut self.data;
        data.qfrc_applied_mut().fill(0.0);
        data.fwd_position();
        data.fwd_velocity();
        data.fwd_actuation();
        data.fwd_acceleration();
        data.fwd_constraint();
    }

    /// Sets both bodies moving as one rigid body: velocity of the shell, ground axes, m/s, and rate, shell axes, rad/s.
    pub fn set_moving(&mut self, velocity_ground_m_s: DVec3, rate_shell_rad_s: DVec3) {
        let mut state = State::read(&self.data);
        let rate_ground = state.shell.attitude * rate_shell_rad_s;
        let arm = state.mass.position_ground_m - state.shell.position_ground_m;
        state.shell.velocity_ground_m_s = velocity_ground_m_s;
        state.shell.rate_body_rad_s = rate_shell_rad_s;
        state.mass.velocity_ground_m_s = velocity_ground_m_s + rate_ground.cross(arm);
        state.mass.rate_body_rad_s = state.mass.attitude.inverse() * rate_ground;
        state.write(&mut self.data);
    }

    /// Static limb forces per mass, m/s^2: the mean over [`REST_PLACES`] places near the origin where the shell may stand.
    ///
    /// MuJoCo knows a limb's length to half a unit in its last digit, 2e-18 m, and at rest that error stands still: 1e-9
    /// m/s^2 of a limb force, a torque that a decoupler integrates twice, 1e-6 of a slow run. From place to place it is
    /// another, as it is from sample to sample of a moving sensor.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn mean_rest_force_per_mass_m_s2(
        model: &SensorModel,
        step_s: f64,
    ) -> Result<[f64; LIMBS], SimulationError> {
        let mut simulation = Self::new(model, step_s)?;
        let start = State::read(&simulation.data);
        let mut sum = [0.0; LIMBS];
        for place in 1..=REST_PLACES {
            // Any set of irrational steps will do.
            let offset =
                [2.0_f64, 3.0, 5.0].map(|x| REST_SPREAD_M * (x.sqrt() * f64::from(place)).fract());
            let mut state = start;
            state.shell.position_ground_m += DVec3::from_array(offset);
            state.mass.position_ground_m += DVec3::from_array(offset);
            state.write(&mut simulation.data);
            simulation.settle();
            simulation.forward(DVec3::ZERO, DVec3::ZERO);
            let force = simulation.read_snapshot().limb_force_per_mass_m_s2;
            sum = core::array::from_fn(|i| sum[i] + force[i] / f64::from(REST_PLACES));
        }
        Ok(sum)
    }

    /// Displaces the mass from where it hangs: shell axes, m and rad (rotation vector). For ring-down experiments.
    pub fn displace_mass(&mut self, displacement_m: DVec3, rotation_rad: DVec3) {
        let mut state = State::read(&self.data);
        state.mass.position_ground_m += displacement_m;
        state.mass.attitude =
            (state.mass.attitude * DQuat::from_scaled_axis(rotation_rad)).normalize();
        state.write(&mut self.data);
    }

    /// MuJoCo's forward dynamics with the shell's acceleration prescribed.
    fn forward(&mut self, linear_ground_m_s2: DVec3, angular_shell_rad_s2: DVec3) {
        let data = &mut self.data;
        data.fwd_position();
        data.fwd_velocity();
        let wanted = [
            linear_ground_m_s2 * SHELL_MASS_KG,
            angular_shell_rad_s2 * SHELL_INERTIA_KG_M2,
        ];
        for dof in 0..BODY_DOFS {
            // The shell's mass matrix is diagonal: its centre of mass is its origin and its inertia a multiple of 1.
            let force = wanted[dof / 3][dof % 3] + data.qfrc_bias()[dof] - data.qfrc_passive()[dof];
            data.qfrc_applied_mut()[dof] = force;
        }
        if self.model.limbs.mass > 0.0 {
            self.apply_far_share(linear_ground_m_s2, angular_shell_rad_s2);
        }
        let data = &mut self.data;
        data.fwd_actuation();
        data.fwd_acceleration();
        data.fwd_constraint();
    }

    /// The share of the limbs' inertia and weight that follows their ends on the shell, as a force on the mass.
    fn apply_far_share(&mut self, linear_ground_m_s2: DVec3, angular_shell_rad_s2: DVec3) {
        let State { shell, mass } = State::read(&self.data);
        let rate = shell.rate_body_rad_s;
        let specific = |hinge: DVec3| {
            let turning = angular_shell_rad_s2.cross(hinge) + rate.cross(rate.cross(hinge));
            linear_ground_m_s2 - self.model.gravity_ground_m_s2 + shell.attitude * turning
        };
        let SensorModel { geometry, .. } = &self.model;
        let load =
            self.model.limbs.far_load(geometry, mass.attitude, specific) * self.model.mass_kg;
        self.data.qfrc_applied_mut()[BODY_DOFS..].copy_from_slice(load.as_slice());
    }

    /// The simulator's state now, with the shell driven by `motion`.
    pub fn snapshot(&mut self, motion: &impl Motion) -> Snapshot {
        let (linear, angular) = motion.acceleration(self.time_s);
        self.forward(linear, angular);
        self.read_snapshot()
    }

    fn read_snapshot(&self) -> Snapshot {
        let state = State::read(&self.data);
        let a = self.data.qacc();
        let length = self.data.ten_length();
        let velocity = self.data.ten_velocity();
        let k = self.model.stiffness_per_mass_per_s2;
        let c = self.model.damping_per_mass_per_s();
        let limb_elongation_m: [f64; LIMBS] =
            core::array::from_fn(|i| length[i] - self.model.geometry.limb_length_m);
        Snapshot {
            time_s: self.time_s,
            shell: state.shell,
            mass: state.mass,
            shell_acceleration_ground_m_s2: DVec3::new(a[0], a[1], a[2]),
            shell_angular_acceleration_shell_rad_s2: DVec3::new(a[3], a[4], a[5]),
            limb_force_per_mass_m_s2: core::array::from_fn(|i| {
                -(k * self.model.limbs.stiffness_ratio[i] * limb_elongation_m[i] + c * velocity[i])
            }),
            limb_elongation_m,
        }
    }

    /// Takes one Runge-Kutta step and returns the snapshot at its *start*, which the step needs anyway.
    ///
    /// # Errors
    /// [`SimulationError::Diverged`].
    pub fn step(&mut self, motion: &impl Motion) -> Result<Snapshot, SimulationError> {
        self.step_under(|simulation, time_s| {
            let (linear, angular) = motion.acceleration(time_s);
            simulation.forward(linear, angular);
        })
    }

    /// As [`Self::step`], with nothing holding or driving the shell: two free bodies joined by nine limbs.
    ///
    /// # Errors
    /// [`SimulationError::Diverged`], [`SimulationError::MassOfFreeLimbs`].
    pub fn step_free(&mut self) -> Result<Snapshot, SimulationError> {
        self.refuse_massive_limbs()?;
        self.step_under(|simulation, _| simulation.forward_free())
    }

    /// As [`Self::step_free`], with the step that MuJoCo itself would take (`mj_step`, integrator RK4).
    ///
    /// # Errors
    /// [`SimulationError::Diverged`], [`SimulationError::MassOfFreeLimbs`].
    pub fn step_as_mujoco(&mut self) -> Result<Snapshot, SimulationError> {
        self.refuse_massive_limbs()?;
        self.forward_free();
        let snapshot = self.read_snapshot();
        self.data.step();
        self.time_s += self.step_s;
        self.check_finite()?;
        Ok(snapshot)
    }

    fn refuse_massive_limbs(&self) -> Result<(), SimulationError> {
        match self.model.limbs.mass > 0.0 {
            true => Err(SimulationError::MassOfFreeLimbs),
            false => Ok(()),
        }
    }

    fn step_under(
        &mut self,
        mut evaluate: impl FnMut(&mut Self, f64),
    ) -> Result<Snapshot, SimulationError> {
        let h = self.step_s;
        let start_time = self.time_s;
        evaluate(self, start_time);
        let snapshot = self.read_snapshot();
        let start = State::read(&self.data);
        let a1 = Rates::read(&self.data);

        let mut stage = |offset: f64, slope: &Rates| {
            let moved = slope.rotations(offset);
            start.advanced(slope, offset).write(&mut self.data);
            evaluate(self, start_time + offset);
            Rates::read(&self.data).seen_from_start(moved)
        };
        let a2 = stage(h / 2.0, &a1);
        let a3 = stage(h / 2.0, &a2);
        let a4 = stage(h, &a3);
        let mean = Rates::weighted([&a1, &a2, &a3, &a4]);
        start.advanced(&mean, h).write(&mut self.data);
        self.time_s = start_time + h;
        self.check_finite()?;
        Ok(snapshot)
    }

    fn check_finite(&self) -> Result<(), SimulationError> {
        let data = &self.data;
        let sum: f64 = data.qpos().iter().chain(data.qvel()).sum();
        if sum.is_finite() {
            Ok(())
        } else {
            Err(SimulationError::Diverged {
                time_s: self.time_s,
            })
        }
    }

    /// Sets the clock, so that sample times are exact multiples and not sums of steps.
    pub fn set_time_s(&mut self, time_s: f64) {
        self.time_s = time_s;
    }
}
