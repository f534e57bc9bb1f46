//! The state of the two bodies and its derivative, in MuJoCo's order of coordinates: what a Runge-Kutta step works on.

use glam::{DQuat, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;

/// Degrees of freedom of one free body.
pub const BODY_DOFS: usize = 6;
const BODY_COORDINATES: usize = 7;
const DOFS: usize = 2 * BODY_DOFS;

/// MuJoCo's state with the model that it belongs to.
pub type Data = MjData<Box<MjModel>>;

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

/// Positions and velocities of both bodies.
#[derive(Clone, Copy)]
pub struct State {
    /// Shell.
    pub shell: BodyState,
    /// Mass.
    pub mass: BodyState,
}

impl State {
    pub fn read(data: &Data) -> Self {
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

    pub fn write(&self, data: &mut Data) {
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
    pub fn advanced(&self, slope: &Rates, duration_s: f64) -> Self {
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
pub struct Rates {
    velocity: [f64; DOFS],
    acceleration: [f64; DOFS],
}

impl Rates {
    pub fn read(data: &Data) -> Self {
        let mut rates = Self {
            velocity: [0.0; DOFS],
            acceleration: [0.0; DOFS],
        };
        rates.velocity.copy_from_slice(data.qvel());
        rates.acceleration.copy_from_slice(data.qacc());
        rates
    }

    /// Rotation vectors of both bodies after turning at these rates for `duration_s`, rad.
    pub fn rotations(&self, duration_s: f64) -> [DVec3; 2] {
        [0, BODY_DOFS].map(|body| DVec3::from_slice(&self.velocity[body + 3..]) * duration_s)
    }

    /// The same rates as derivatives of the rotation vectors u that lead from the start of the step to here:
    /// u' = w + u x w/2 + u x (u x w)/12, the right Jacobian's inverse up to the order that a fourth-order step needs.
    pub fn seen_from_start(mut self, rotations: [DVec3; 2]) -> Self {
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
    pub fn weighted([a, b, c, d]: [&Self; 4]) -> Self {
        let mean = |f: fn(&Self) -> &[f64; DOFS]| {
            core::array::from_fn(|i| (f(a)[i] + 2.0 * (f(b)[i] + f(c)[i]) + f(d)[i]) / 6.0)
        };
        Self {
            velocity: mean(|r| &r.velocity),
            acceleration: mean(|r| &r.acceleration),
        }
    }
}
