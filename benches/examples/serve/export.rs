//! The problem written out for peers in other tools, from one simulation.

use glam::DMat3;
use serde::Deserialize;
use serde::Serialize;
use sixaxis_core::Geometry;
use sixaxis_core::LIMBS;
use sixaxis_core::SixAxis;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::preload::static_preload_m_s2;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_props::problem::recorded as problem;
use sixaxis_props::problem::recorded::DECOUPLE_RATE_HZ;
use sixaxis_props::problem::recorded::Recorded;
use sixaxis_props::problem::recorded::STEP_S;
use sixaxis_props::problem::recorded::compound_5_hz;
use sixaxis_props::problem::recorded::true_parameters;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::mujoco::model::SHELL_INERTIA_KG_M2;
use sixaxis_reference::mujoco::model::SHELL_MASS_KG;
use std::error::Error;
use std::fs;
use std::path::Path;

use crate::engines::attitude;
use crate::peer::{Row, State, Wrench, row};

/// The record is cut to this many samples, or kept whole if it is shorter.
pub const SAMPLES: usize = 10_000;

/// What the peers know beside the voltages. The order of the fields is that of the numbers in `problem.bin`.
#[derive(Serialize, Deserialize)]
pub struct Problem {
    pub samples: usize,
    pub sample_rate_hz: f64,
    pub limb_length_m: f64,
    pub half_edge_m: f64,
    pub direction_shell: [[f64; 3]; LIMBS],
    pub mass_hinge_m: [[f64; 3]; LIMBS],
    pub shell_hinge_m: [[f64; 3]; LIMBS],
    pub gain_n_per_v: [f64; LIMBS],
    pub zero_drift_v: [f64; LIMBS],
    pub scale_per_mass_per_kg: [f64; LIMBS],
    pub inertia_per_mass_m2: [[f64; 3]; 3],
    pub stiffness_per_mass_per_s2: f64,
    pub preload_per_mass_m_s2: [f64; LIMBS],
    pub gravity_ground_m_s2: [f64; 3],
    /// R at the first decoupled sample, by rows.
    pub initial_attitude: [[f64; 3]; 3],
    /// For engines, which think in kilograms.
    pub mass_kg: f64,
    pub shell_mass_kg: f64,
    pub shell_inertia_kg_m2: f64,
}

impl Problem {
    pub fn of(recording: &SimulatedRecording) -> Result<Self, Box<dyn Error>> {
        let (geometry, parameters) = (Geometry::PAPER, true_parameters());
        let gravity = recording.gravity_ground_m_s2;
        let stiffness = parameters.stiffness_per_mass_per_s2;
        Ok(Self {
            samples: recording.voltage_v.len(),
            sample_rate_hz: recording.sample_rate_hz,
            limb_length_m: geometry.limb_length_m,
            half_edge_m: geometry.half_edge_m,
            direction_shell: DIRECTIONS_SHELL.map(Into::into),
            mass_hinge_m: geometry.mass_hinges_m().map(Into::into),
            shell_hinge_m: geometry.shell_hinges_m().map(Into::into),
            gain_n_per_v: recording.gains().gain_n_per_v,
            zero_drift_v: parameters.zero_drift_v,
            scale_per_mass_per_kg: parameters.scale_per_mass_per_kg,
            inertia_per_mass_m2: parameters
                .inertia_per_mass
                .matrix_mass_m2()
                .to_cols_array_2d(),
            stiffness_per_mass_per_s2: stiffness,
            preload_per_mass_m_s2: static_preload_m_s2(&geometry, stiffness, gravity)?,
            gravity_ground_m_s2: gravity.into(),
            initial_attitude: DMat3::IDENTITY.to_cols_array_2d(),
            mass_kg: sixaxis_reference::sensor::MASS_KG,
            shell_mass_kg: SHELL_MASS_KG,
            shell_inertia_kg_m2: SHELL_INERTIA_KG_M2,
        })
    }

    pub fn inertia(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.inertia_per_mass_m2)
    }

    /// The same numbers one after the other, for peers that read no JSON.
    pub fn flat(&self) -> Vec<f64> {
        [
            &[
                self.samples as f64,
                self.sample_rate_hz,
                self.limb_length_m,
                self.half_edge_m,
            ],
            self.direction_shell.as_flattened(),
            self.mass_hinge_m.as_flattened(),
            self.shell_hinge_m.as_flattened(),
            &self.gain_n_per_v,
            &self.zero_drift_v,
            &self.scale_per_mass_per_kg,
            self.inertia_per_mass_m2.as_flattened(),
            &[self.stiffness_per_mass_per_s2],
            &self.preload_per_mass_m_s2,
            &self.gravity_ground_m_s2,
            self.initial_attitude.as_flattened(),
            &[self.mass_kg, self.shell_mass_kg, self.shell_inertia_kg_m2],
        ]
        .concat()
    }
}

pub fn write_rows(path: &Path, numbers: &[f64]) -> std::io::Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(path, bytes)
}

/// MuJoCo's state at every sample of the run: the same simulation once more, since a recording does not keep it.
pub fn states(samples: usize) -> Result<Vec<State>, Box<dyn Error>> {
    let run = compound_5_hz();
    let steps_per_sample = (1.0 / (DECOUPLE_RATE_HZ * STEP_S)).round() as usize;
    let mut simulation = problem::simulation(&run);
    let mut states = Vec::with_capacity(samples);
    for step in 0..samples * steps_per_sample {
        simulation.set_time_s(step as f64 * STEP_S);
        let now = simulation.step(&run)?;
        if step % steps_per_sample == 0 {
            let bodies = [now.shell, now.mass];
            let qpos = bodies.iter().flat_map(|body| {
                let (p, q) = (body.position_ground_m, body.attitude);
                [p.x, p.y, p.z, q.w, q.x, q.y, q.z]
            });
            let qvel = bodies
                .iter()
                .flat_map(|body| row(body.velocity_ground_m_s, body.rate_body_rad_s));
            let qacc = row(
                now.shell_acceleration_ground_m_s2,
                now.shell_angular_acceleration_shell_rad_s2,
            );
            let state: Vec<f64> = qpos.chain(qvel).chain(qacc).collect();
            states.push(state.try_into().expect("32 numbers"));
        }
    }
    Ok(states)
}

/// What the voltages say of the limbs' wrench on the mass at every decoupled sample.
pub fn wrenches(problem: &Problem, recording: &SimulatedRecording) -> Vec<Wrench> {
    let chain = SignalChain::new(&recording.gains(), &true_parameters());
    let wrench = |voltage_v: &[f64; LIMBS]| {
        let tared = chain.force_per_mass_m_s2(voltage_v);
        let force = core::array::from_fn(|i| tared[i] + problem.preload_per_mass_m_s2[i]);
        let elongation_m = force.map(|f| -f / problem.stiffness_per_mass_per_s2);
        let pose =
            Pose::from_elongations(&Geometry::PAPER, &elongation_m).expect("limbs that meet");
        let wrench = LimbWrench::at_pose(&Geometry::PAPER, &pose, &force);
        let to_mass = pose.rotation_matrix().transpose();
        row(
            to_mass * wrench.force_shell_m_s2,
            to_mass * wrench.torque_shell_m2_s2,
        )
    };
    recording.voltage_v[1..recording.voltage_v.len() - 1]
        .iter()
        .map(wrench)
        .collect()
}

pub fn export(dir: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(dir)?;
    let mut recorded = Recorded::play(&compound_5_hz(), DECOUPLE_RATE_HZ);
    let played = recorded.truth.len();
    recorded.recording.voltage_v.truncate(SAMPLES);
    recorded.truth.truncate(SAMPLES);
    let samples = recorded.truth.len();

    let problem = Problem::of(&recorded.recording)?;
    fs::write(
        dir.join("problem.json"),
        serde_json::to_vec_pretty(&problem)?,
    )?;
    write_rows(&dir.join("problem.bin"), &problem.flat())?;
    write_rows(
        &dir.join("voltage.bin"),
        recorded.recording.voltage_v.as_flattened(),
    )?;

    write_rows(
        &dir.join("wrench.bin"),
        wrenches(&problem, &recorded.recording).as_flattened(),
    )?;
    let states = states(samples)?;
    let same = |(state, truth): (&State, &TrueMotion)| attitude(state) == truth.attitude;
    if !states.iter().zip(&recorded.truth).all(same) {
        return Err("MuJoCo did not play the same run twice".into());
    }
    write_rows(&dir.join("states.bin"), states.as_flattened())?;

    let truth: Vec<Row> = recorded.truth[1..samples - 1]
        .iter()
        .map(|t| row(t.linear_ground_m_s2, t.angular_ground_rad_s2))
        .collect();
    write_rows(&dir.join("truth.bin"), truth.as_flattened())?;
    let mut oracle = Vec::new();
    let sink = |s: &SixAxis| oracle.push(row(s.linear_ground_m_s2, s.angular_ground_rad_s2));
    recorded
        .paper_decoder(&true_parameters())
        .push_all(&recorded.recording.voltage_v, sink)?;
    write_rows(&dir.join("oracle.bin"), oracle.as_flattened())?;
    println!("{samples} of the run's {played} samples");
    Ok(())
}
