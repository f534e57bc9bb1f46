//! MuJoCo's inverse dynamics and step on the recorded states.

use glam::DQuat;
use glam::DVec3;
use sixaxis_benches::free_sensor::FreeSensor;
use sixaxis_props::problem::recorded::STEP_S;
use sixaxis_props::problem::recorded::compound_5_hz;
use sixaxis_reference::mujoco::model::SHELL_INERTIA_KG_M2;
use sixaxis_reference::mujoco::model::SHELL_MASS_KG;

use crate::peer::{Input, Peer, Row, State, row};

/// Where those three begin, and where the mass's share of the first two does.
pub const QVEL: usize = 14;

pub const QACC: usize = 26;

pub const MASS_QPOS: usize = 7;

pub const MASS_DOF: usize = 6;

/// One MuJoCo call a sample on the recorded state of both bodies.
pub struct Mujoco<C, R> {
    pub sensor: FreeSensor,
    /// States of the samples that are decoupled: all but the first and the last.
    pub states: Vec<State>,
    /// Force that drives the shell at each of them.
    pub drive: Vec<Row>,
    /// Calls MuJoCo and returns what is kept of the outcome.
    pub call: C,
    pub outcome: Vec<Row>,
    /// Accelerations from a state and the outcome of its call; not timed.
    pub to_row: R,
}

impl<C, R> Peer for Mujoco<C, R>
where
    C: Fn(&mut FreeSensor) -> Row,
    R: Fn(&State, &Row) -> Row,
{
    fn decode(&mut self) {
        self.outcome.clear();
        for (state, drive) in self.states.iter().zip(&self.drive) {
            let data = &mut self.sensor.data;
            data.qpos_mut().copy_from_slice(&state[..QVEL]);
            data.qvel_mut().copy_from_slice(&state[QVEL..QACC]);
            // Shell and mass are fed the same acceleration.
            let (shell, mass) = data.qacc_mut().split_at_mut(MASS_DOF);
            shell.copy_from_slice(&state[QACC..]);
            mass.copy_from_slice(&state[QACC..]);
            data.qfrc_applied_mut()[..MASS_DOF].copy_from_slice(drive);
            self.outcome.push((self.call)(&mut self.sensor));
        }
    }

    fn rows(&self) -> Vec<Row> {
        let pairs = self.states.iter().zip(&self.outcome);
        pairs
            .map(|(state, outcome)| (self.to_row)(state, outcome))
            .collect()
    }
}

pub fn six(values: &[f64]) -> Row {
    values.try_into().expect("six numbers")
}

/// Linear and angular part of six numbers.
pub fn halves(values: &[f64]) -> (DVec3, DVec3) {
    (DVec3::from_slice(values), DVec3::from_slice(&values[3..]))
}

/// Attitude of the body whose coordinates these are, as MuJoCo orders them.
pub fn attitude(qpos: &[f64]) -> DQuat {
    DQuat::from_xyzw(qpos[4], qpos[5], qpos[6], qpos[3])
}

pub fn mujoco_inverse(input: &Input) -> Box<dyn Peer> {
    let mass_kg = input.problem.mass_kg;
    let inverse = (input.problem.inertia() * mass_kg).inverse();
    let states = input.decoupled_states().to_vec();
    Box::new(Mujoco {
        sensor: FreeSensor::new(&compound_5_hz()),
        drive: vec![Row::default(); states.len()],
        states,
        call: |sensor: &mut FreeSensor| {
            sensor.data.inverse();
            six(&sensor.data.qfrc_inverse()[MASS_DOF..])
        },
        outcome: Vec::new(),
        // What the mass would need beside its limbs and gravity to accelerate as it was fed. Less that, the fed
        // acceleration is the one that limbs and gravity give it: of the mass, whatever was fed.
        to_row: move |state: &State, missing: &Row| {
            let (a, w_dot) = halves(&state[QACC..]);
            let (force, torque_mass) = halves(missing);
            let angular_mass = w_dot - inverse * torque_mass;
            row(
                a - force / mass_kg,
                attitude(&state[MASS_QPOS..]) * angular_mass,
            )
        },
    })
}

pub fn mujoco_step(input: &Input) -> Box<dyn Peer> {
    let mut sensor = FreeSensor::new(&compound_5_hz());
    let states = input.decoupled_states().to_vec();
    let drive = states
        .iter()
        .map(|state| drive(&mut sensor, state))
        .collect();
    Box::new(Mujoco {
        sensor,
        states,
        drive,
        call: |sensor: &mut FreeSensor| {
            sensor.data.step();
            six(&sensor.data.qvel()[..MASS_DOF])
        },
        outcome: Vec::new(),
        // Mean acceleration of the driven shell over one of MuJoCo's steps.
        to_row: |state: &State, after: &Row| {
            let (v, w) = halves(&state[QVEL..]);
            let (v_after, w_after) = halves(after);
            row(
                (v_after - v) / STEP_S,
                attitude(state) * ((w_after - w) / STEP_S),
            )
        },
    })
}

/// Force and torque that give the shell its recorded acceleration.
pub fn drive(sensor: &mut FreeSensor, state: &State) -> Row {
    let data = &mut sensor.data;
    data.qpos_mut().copy_from_slice(&state[..QVEL]);
    data.qvel_mut().copy_from_slice(&state[QVEL..QACC]);
    data.forward();
    core::array::from_fn(|dof| {
        let inertia = if dof < 3 {
            SHELL_MASS_KG
        } else {
            SHELL_INERTIA_KG_M2
        };
        inertia * state[QACC + dof] + data.qfrc_bias()[dof] - data.qfrc_passive()[dof]
    })
}
