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
use nalgebra::{Matrix6, Vector6};
use sixaxis_core::LIMBS;
use thiserror::Error;

use crate::mjcf::{SensorModel, limb_jacobian};

/// Degrees of freedom and coordinates of one free body.
const BODY_DOFS: usize = 6;
const BODY_COORDINATES: usize = 7;
const DOFS: usize = 2 * BODY_DOFS;

type Data = MjData<Box<MjModel>>;

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
    /// The step is longer than the integrator's stability limit for the stiffest mode.
    #[error(
        "step {step_s} s is unstable: the stiffest mode, {highest_mode_hz:.0} Hz, allows at most {limit_s:.2e} s"
    )]
    StepTooLong {
        /// The step asked for.
        step_s: f64,
        /// Highest mode of the sensor.
        highest_mode_hz: f64,
        /// Longest stable step.
        limit_s: f64,
    },
    /// A state is no longer finite.
    #[error("the simulated state is not finite at {time_s} s")]
    Diverged {
        /// Simulated time.
        time_s: f64,
    },
}

/// Position law of the shell: acceleration as a function of time, from rest at the origin with axes along the
/// ground's.
pub trait Motion: Sync {
    /// Linear acceleration of the shell, ground axes, m/s^2, and angular acceleration, shell axes, rad/s^2.
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3);
}

/// One body's state as the simulator holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState {
    /// Position, ground axes, m.
    pub position_ground_m: DVec3,
    /// Attitude: body axes to ground axes.
    pub attitude: DQuat,
    /// Velocity, ground axes, m/s.
    pub velocity_ground_m_s: DVec3,
    /// Angular velocity, body axes, rad/s.
    pub rate_body_rad_s: DVec3,
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
    #[must_use]
    pub fn relative_pose(&self) -> (DVec3, DVec3) {
        let back = self.shell.attitude.inverse();
        let r = back * (self.mass.position_ground_m - self.shell.position_ground_m);
        let q = back * self.mass.attitude;
        // For the 1e-6 rad of a relative rotation, 2 asin(|v|) v/|v| equals 2 v to rounding.
        let sign = if q.w < 0.0 { -2.0 } else { 2.0 };
        (r, DVec3::new(q.x, q.y, q.z) * sign)
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
        let highest_mode_hz = crate::modes::mode_frequencies_hz(
            &model.geometry,
            &model.inertia_per_mass,
            model.stiffness_per_mass_per_s2,
        )[5];
        // RK4 is stable up to 2.785 on the imaginary axis; a twentieth is left for damping and geometry.
        let limit_s = 2.65 / (core::f64::consts::TAU * highest_mode_hz);
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
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Newton iteration on MuJoCo's own acceleration of the mass with the shell held still.
    fn settle(&mut self) {
        let k = self.model.stiffness_per_mass_per_s2;
        let jacobian = limb_jacobian(&self.model.geometry);
        let stiffness: Matrix6<f64> = jacobian.transpose() * jacobian * k;
        let tensor = self.model.inertia_per_mass.matrix_mass_m2();
        let Some(cholesky) = stiffness.cholesky() else {
            return;
        };
        for _ in 0..EQUILIBRIUM_ITERATIONS {
            self.forward(DVec3::ZERO, DVec3::ZERO);
            let a = self.data.qacc();
            let force = DVec3::new(a[6], a[7], a[8]);
            let torque = tensor * DVec3::new(a[9], a[10], a[11]);
            let step = cholesky.solve(&Vector6::new(
                force.x, force.y, force.z, torque.x, torque.y, torque.z,
            ));
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
            linear_ground_m_s2 * crate::mjcf::SHELL_MASS_KG,
            angular_shell_rad_s2 * crate::mjcf::SHELL_INERTIA_KG_M2,
        ];
        for dof in 0..BODY_DOFS {
            // The shell's mass matrix is diagonal: its centre of mass is its origin and its inertia a multiple of 1.
            let force = wanted[dof / 3][dof % 3] + data.qfrc_bias()[dof] - data.qfrc_passive()[dof];
            data.qfrc_applied_mut()[dof] = force;
        }
        data.fwd_actuation();
        data.fwd_acceleration();
        data.fwd_constraint();
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
                -(k * limb_elongation_m[i] + c * velocity[i])
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
    /// [`SimulationError::Diverged`].
    pub fn step_free(&mut self) -> Result<Snapshot, SimulationError> {
        self.step_under(|simulation, _| simulation.forward_free())
    }

    /// As [`Self::step_free`], with the step that MuJoCo itself would take (`mj_step`, integrator RK4).
    ///
    /// # Errors
    /// [`SimulationError::Diverged`].
    pub fn step_as_mujoco(&mut self) -> Result<Snapshot, SimulationError> {
        self.forward_free();
        let snapshot = self.read_snapshot();
        self.data.step();
        self.time_s += self.step_s;
        self.check_finite()?;
        Ok(snapshot)
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

/// Positions and velocities of both bodies.
#[derive(Clone, Copy)]
struct State {
    shell: BodyState,
    mass: BodyState,
}

impl State {
    fn read(data: &Data) -> Self {
        let body = |index: usize| {
            let q = &data.qpos()[index * BODY_COORDINATES..];
            let v = &data.qvel()[index * BODY_DOFS..];
            BodyState {
                position_ground_m: DVec3::new(q[0], q[1], q[2]),
                attitude: DQuat::from_xyzw(q[4], q[5], q[6], q[3]),
                velocity_ground_m_s: DVec3::new(v[0], v[1], v[2]),
                rate_body_rad_s: DVec3::new(v[3], v[4], v[5]),
            }
        };
        Self {
            shell: body(0),
            mass: body(1),
        }
    }

    fn write(&self, data: &mut Data) {
        for (index, body) in [self.shell, self.mass].into_iter().enumerate() {
            let p = body.position_ground_m;
            let a = body.attitude;
            let v = body.velocity_ground_m_s;
            let w = body.rate_body_rad_s;
            data.qpos_mut()[index * BODY_COORDINATES..][..BODY_COORDINATES]
                .copy_from_slice(&[p.x, p.y, p.z, a.w, a.x, a.y, a.z]);
            data.qvel_mut()[index * BODY_DOFS..][..BODY_DOFS]
                .copy_from_slice(&[v.x, v.y, v.z, w.x, w.y, w.z]);
        }
    }

    /// This state moved along `slope` for `duration_s`: positions on the manifold, velocities linearly.
    fn advanced(&self, slope: &Rates, duration_s: f64) -> Self {
        let body = |start: &BodyState, offset: usize| {
            let part = |values: &[f64; DOFS], from: usize| {
                DVec3::new(
                    values[offset + from],
                    values[offset + from + 1],
                    values[offset + from + 2],
                ) * duration_s
            };
            BodyState {
                position_ground_m: start.position_ground_m + part(&slope.velocity, 0),
                attitude: (start.attitude * DQuat::from_scaled_axis(part(&slope.velocity, 3)))
                    .normalize(),
                velocity_ground_m_s: start.velocity_ground_m_s + part(&slope.acceleration, 0),
                rate_body_rad_s: start.rate_body_rad_s + part(&slope.acceleration, 3),
            }
        };
        Self {
            shell: body(&self.shell, 0),
            mass: body(&self.mass, BODY_DOFS),
        }
    }
}

/// Time derivative of a state, in MuJoCo's order of degrees of freedom.
#[derive(Clone, Copy)]
struct Rates {
    velocity: [f64; DOFS],
    acceleration: [f64; DOFS],
}

impl Rates {
    fn read(data: &Data) -> Self {
        let mut rates = Self {
            velocity: [0.0; DOFS],
            acceleration: [0.0; DOFS],
        };
        rates.velocity.copy_from_slice(data.qvel());
        rates.acceleration.copy_from_slice(data.qacc());
        rates
    }

    /// Rotation vectors of both bodies after turning at these rates for `duration_s`, rad.
    fn rotations(&self, duration_s: f64) -> [DVec3; 2] {
        [0, BODY_DOFS].map(|body| DVec3::from_slice(&self.velocity[body + 3..]) * duration_s)
    }

    /// The same rates as derivatives of the rotation vectors u that lead from the start of the step to here:
    /// u' = w + u x w/2 + u x (u x w)/12, the right Jacobian's inverse up to the order that a fourth-order step needs.
    fn seen_from_start(mut self, rotations: [DVec3; 2]) -> Self {
        for (body, u) in [0, BODY_DOFS].into_iter().zip(rotations) {
            let w = &mut self.velocity[body + 3..body + BODY_DOFS];
            let rate = DVec3::from_slice(w);
            let once = u.cross(rate);
            let seen = rate + 0.5 * once + u.cross(once) / 12.0;
            w.copy_from_slice(&seen.to_array());
        }
        self
    }

    /// Runge-Kutta's mean slope: (k1 + 2 k2 + 2 k3 + k4)/6.
    fn weighted([a, b, c, d]: [&Self; 4]) -> Self {
        let mean = |f: fn(&Self) -> &[f64; DOFS]| {
            core::array::from_fn(|i| (f(a)[i] + 2.0 * (f(b)[i] + f(c)[i]) + f(d)[i]) / 6.0)
        };
        Self {
            velocity: mean(|r| &r.velocity),
            acceleration: mean(|r| &r.acceleration),
        }
    }
}
