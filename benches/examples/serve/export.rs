//! The problem written out for peers in other tools, from one simulation.

use sixaxis_core::SixAxis;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_props::problem::recorded as problems;
use sixaxis_props::problem::recorded::DECOUPLE_RATE_HZ;
use sixaxis_props::problem::recorded::Recorded;
use sixaxis_props::problem::recorded::STEP_S;
use sixaxis_props::problem::recorded::compound_5_hz;
use sixaxis_props::problem::recorded::true_parameters;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::TrueMotion;
use std::error::Error;
use std::fs;
use std::path::Path;

use crate::engines::attitude;
use crate::peer::{Row, State, Wrench, row};
use crate::problem::Problem;

/// The record is cut to this many samples, or kept whole if it is shorter.
pub const SAMPLES: usize = 10_000;

pub fn write_rows(path: &Path, numbers: &[f64]) -> std::io::Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(path, bytes)
}

/// MuJoCo's state at every sample of the run: the same simulation once more, since a recording does not keep it.
pub fn states(samples: usize) -> Result<Vec<State>, Box<dyn Error>> {
    let run = compound_5_hz();
    let steps_per_sample = (1.0 / (DECOUPLE_RATE_HZ * STEP_S)).round() as usize;
    let mut simulation = problems::simulation(&run);
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
