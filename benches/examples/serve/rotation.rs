//! The crate `ode_solvers` on the rotational equation, the torque given.

use glam::DMat3;
use glam::DQuat;
use glam::DVec3;
use ode_solvers::Dopri5;
use ode_solvers::Rk4;
use ode_solvers::System;
use ode_solvers::Vector3;
use std::hint::black_box;

use crate::engines::{MASS_QPOS, attitude};
use crate::peer::{Input, Peer, Row, row};

/// Relative and absolute tolerance of Dopri5: its error is then below that of the torque between samples.
pub const DOPRI5_TOLERANCE: (f64, f64) = (1e-8, 1e-8);

/// Euler's equation of the mass in its own axes with the recorded torque, straight lines between samples.
pub struct Rotation {
    pub rate_hz: f64,
    /// Torque per mass at every decoupled sample, mass axes, m^2/s^2.
    pub torque: Vec<Vector3<f64>>,
    pub inertia: [[f64; 3]; 3],
    pub inverse: [[f64; 3]; 3],
}

/// ode_solvers has a nalgebra of its own, older than ours, so matrices are written out.
pub fn times(m: &[[f64; 3]; 3], v: &Vector3<f64>) -> Vector3<f64> {
    let line = |r: &[f64; 3]| r[0] * v.x + r[1] * v.y + r[2] * v.z;
    Vector3::new(line(&m[0]), line(&m[1]), line(&m[2]))
}

impl Rotation {
    pub fn derivative(&self, torque: &Vector3<f64>, w: &Vector3<f64>) -> Vector3<f64> {
        times(&self.inverse, &(torque - w.cross(&times(&self.inertia, w))))
    }

    pub fn end_s(&self) -> f64 {
        (self.torque.len() - 1) as f64 / self.rate_hz
    }
}

impl System<f64, Vector3<f64>> for &Rotation {
    fn system(&self, time_s: f64, w: &Vector3<f64>, derivative: &mut Vector3<f64>) {
        let at = (time_s * self.rate_hz).max(0.0);
        let before = (at as usize).min(self.torque.len() - 2);
        let share = at - before as f64;
        let torque = self.torque[before] * (1.0 - share) + self.torque[before + 1] * share;
        *derivative = self.derivative(&torque, w);
    }
}

pub type Solve = fn(&Rotation) -> Vec<Vector3<f64>>;

pub fn rk4(rotation: &Rotation) -> Vec<Vector3<f64>> {
    let step_s = 1.0 / rotation.rate_hz;
    let mut solver = Rk4::new(rotation, 0.0, Vector3::zeros(), rotation.end_s(), step_s);
    solver.integrate().expect("Rk4 to reach the end");
    solver.y_out().clone()
}

pub fn dopri5(rotation: &Rotation) -> Vec<Vector3<f64>> {
    let (relative, absolute) = DOPRI5_TOLERANCE;
    let (start, end_s, step_s) = (Vector3::zeros(), rotation.end_s(), 1.0 / rotation.rate_hz);
    let mut solver = Dopri5::new(rotation, 0.0, end_s, step_s, start, relative, absolute);
    solver.integrate().expect("Dopri5 to reach the end");
    solver.y_out().clone()
}

/// The rotational equation alone, by the crate ode_solvers.
pub struct OdeSolvers {
    pub rotation: Rotation,
    pub solve: Solve,
    /// Attitude of the mass at every decoupled sample: for the answer, not for the solver.
    pub attitudes: Vec<DQuat>,
    pub rates: Vec<Vector3<f64>>,
}

impl OdeSolvers {
    pub fn new(input: &Input, solve: Solve) -> Self {
        let inertia = input.problem.inertia();
        let rows = |m: DMat3| m.transpose().to_cols_array_2d();
        Self {
            rotation: Rotation {
                rate_hz: input.problem.sample_rate_hz,
                torque: (input.wrenches.iter())
                    .map(|w| Vector3::new(w[3], w[4], w[5]))
                    .collect(),
                inertia: rows(inertia),
                inverse: rows(inertia.inverse()),
            },
            solve,
            attitudes: input
                .decoupled_states()
                .iter()
                .map(|state| attitude(&state[MASS_QPOS..]))
                .collect(),
            rates: Vec::new(),
        }
    }
}

impl Peer for OdeSolvers {
    fn decode(&mut self) {
        self.rates = (self.solve)(black_box(&self.rotation));
    }

    fn rows(&self) -> Vec<Row> {
        let known = self.rotation.torque.iter().zip(&self.attitudes);
        // A solver that counts its steps in floating point may append one sample, or lack the last.
        known
            .zip(&self.rates)
            .map(|((torque, attitude), rate)| {
                let w_dot = self.rotation.derivative(torque, rate);
                row(
                    DVec3::ZERO,
                    *attitude * DVec3::new(w_dot.x, w_dot.y, w_dot.z),
                )
            })
            .collect()
    }
}
