//! MuJoCo's inverse dynamics on the recorded states, by the smallest model that answers.
//!
//! The question is what a decoder answers last: which acceleration do the limbs give the mass? With state and limb wrench given it
//! needs one free body: no shell, whose motion is in the state, and no tendons, whose forces are in the wrench.

use glam::{DMat3, DQuat, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;

use crate::peer::{Input, Peer, Row, State, Wrench, row};
use crate::problem::Problem;

/// Where velocities and accelerations begin in a state, and where the mass's share of coordinates and velocities does.
const QVEL: usize = 14;
const QACC: usize = 26;
const MASS_QPOS: usize = 7;
const MASS_QVEL: usize = QVEL + 6;

/// One `mj_inverse` a sample on the mass as a free body.
struct MujocoInverse {
    data: MjData<Box<MjModel>>,
    /// States of the samples that are decoupled: all but the first and the last.
    states: Vec<State>,
    wrenches: Vec<Wrench>,
    mass_kg: f64,
    inverse_inertia: DMat3,
    /// Force and torque that the acceleration fed needs, N and N m.
    needed: Vec<Row>,
}

/// The mass as MuJoCo's XML.
fn mjcf(problem: &Problem) -> String {
    let mass = problem.mass_kg;
    let i = problem.inertia_per_mass_m2;
    let inertia = [i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]].map(|i| i * mass);
    let text = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>();
    format!(
        r#"<mujoco>
  <option gravity="{gravity}"><flag contact="disable" constraint="disable"/></option>
  <worldbody>
    <body><freejoint/><inertial pos="0 0 0" mass="{mass}" fullinertia="{inertia}"/></body>
  </worldbody>
</mujoco>"#,
        gravity = text(&problem.gravity_ground_m_s2).join(" "),
        inertia = text(&inertia).join(" "),
    )
}

impl Peer for MujocoInverse {
    fn decode(&mut self) {
        self.needed.clear();
        for state in &self.states {
            let data = &mut self.data;
            data.qpos_mut().copy_from_slice(&state[MASS_QPOS..QVEL]);
            data.qvel_mut().copy_from_slice(&state[MASS_QVEL..QACC]);
            // The shell's acceleration.
            data.qacc_mut().copy_from_slice(&state[QACC..]);
            data.inverse();
            let needed = data.qfrc_inverse().try_into().expect("six numbers");
            self.needed.push(needed);
        }
    }

    fn rows(&self) -> Vec<Row> {
        let given = self.states.iter().zip(&self.wrenches);
        // What is needed beyond the limbs' wrench was fed too much. The acceleration fed less that is the mass's, whatever was fed.
        given
            .zip(&self.needed)
            .map(|((state, wrench), needed)| {
                let turn = attitude(&state[MASS_QPOS..]);
                let ([a, w_dot], [force, torque]) = (halves(&state[QACC..]), halves(needed));
                let [limb_force, limb_torque] = halves(wrench);
                let beyond = force / self.mass_kg - turn * limb_force;
                let angular_beyond = self.inverse_inertia * (torque / self.mass_kg - limb_torque);
                row(a - beyond, turn * (w_dot - angular_beyond))
            })
            .collect()
    }
}

/// Linear and angular part of six numbers.
fn halves(values: &[f64]) -> [DVec3; 2] {
    [DVec3::from_slice(values), DVec3::from_slice(&values[3..])]
}

/// Attitude of the body whose coordinates these are, as MuJoCo orders them.
pub fn attitude(qpos: &[f64]) -> DQuat {
    DQuat::from_xyzw(qpos[4], qpos[5], qpos[6], qpos[3])
}

pub fn mujoco_inverse(input: &Input) -> Box<dyn Peer> {
    let model = MjModel::from_xml_string(&mjcf(&input.problem)).expect("MuJoCo's model of a body");
    let states = input.decoupled_states().to_vec();
    Box::new(MujocoInverse {
        data: MjData::new(Box::new(model)),
        needed: Vec::with_capacity(states.len()),
        states,
        wrenches: input.wrenches.clone(),
        mass_kg: input.problem.mass_kg,
        inverse_inertia: input.problem.inertia().inverse(),
    })
}
