//! The Rust side of `benches/peers`: hands out the problem, and answers and times it on request.
//!
//! `serve export DIR` plays the compound run at 5 Hz and writes what every peer reads, in whatever language:
//! `problem.json` (and its numbers as `problem.bin`) and `voltage.bin`; for engines, which do not decode, `states.bin`
//! and `wrench.bin`; and two answers, `oracle.bin` from [`peer`] and `truth.bin` from MuJoCo. `serve NAME DIR` stays
//! resident and obeys lines on its standard input:
//!
//! * `answer FILE` decodes once and writes six numbers a sample: linear, then angular acceleration, ground axes;
//! * `time R` decodes the record R times and prints the mean seconds of one;
//! * `quit`.
//!
//! Binary files are rows of little-endian f64. An implementation is one line in [`PEERS`].

use std::array::from_fn;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use glam::{DMat3, DQuat, DVec3};
use ode_solvers::{Dopri5, Rk4, System, Vector3};
use serde::{Deserialize, Serialize};
use sixaxis_benches::peer::{self, PeerDecoupler, PeerGeometry, PeerPose};
use sixaxis_benches::problem::{
    self, Answer, DECOUPLE_RATE_HZ, FreeSensor, Recorded, STEP_S, compound_5_hz, true_parameters,
};
use sixaxis_core::dynamics::LimbWrench;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::kernel::wide::LANES;
use sixaxis_core::lanes::{LaneSample, push_lanes};
use sixaxis_core::pose::Pose;
use sixaxis_core::preload::static_preload_m_s2;
use sixaxis_core::signal::SignalChain;
use sixaxis_core::{Decoupler, Gains, Geometry, LIMBS, RigidDecoupler, Scheme};
use sixaxis_reference::mjcf::{SHELL_INERTIA_KG_M2, SHELL_MASS_KG};
use sixaxis_reference::recording::{Recording, TrueMotion};

/// Linear, m/s^2, and angular acceleration, rad/s^2, of one sample, ground axes.
type Row = [f64; 6];
/// Force, m/s^2, and torque, m^2/s^2, of the limbs on the mass, per mass, mass axes.
type Wrench = [f64; 6];
/// MuJoCo's qpos (14) and qvel (12) of shell and mass, and the shell's part of qacc (6).
type State = [f64; 32];
/// Where those three begin, and where the mass's share of the first two does.
const QVEL: usize = 14;
const QACC: usize = 26;
const MASS_QPOS: usize = 7;
const MASS_DOF: usize = 6;

/// The record is cut to this many samples, or kept whole if it is shorter.
const SAMPLES: usize = 10_000;
/// Relative and absolute tolerance of Dopri5: its error is then below that of the torque between samples.
const DOPRI5_TOLERANCE: (f64, f64) = (1e-8, 1e-8);

/// How an implementation is made ready for a record.
type Ready = fn(&Input) -> Box<dyn Peer>;

/// Every implementation by its name.
const PEERS: &[(&str, Ready)] = &[
    ("push", push),
    ("record", |input| record(input, false)),
    ("record_portable", |input| record(input, true)),
    ("lanes", lanes),
    ("rigid", rigid),
    ("nalgebra", nalgebra),
    ("mujoco_inverse", mujoco_inverse),
    ("mujoco_step", mujoco_step),
    ("ode_solvers_rk4", |input| {
        Box::new(OdeSolvers::new(input, rk4))
    }),
    ("ode_solvers_dopri5", |input| {
        Box::new(OdeSolvers::new(input, dopri5))
    }),
];

/// Something that works through the whole record.
trait Peer {
    /// What is timed.
    fn decode(&mut self);
    /// Records decoded at once, each of which counts.
    fn records(&self) -> u32 {
        1
    }
    /// The result of the last [`Self::decode`], as far as it has accelerations; zero where it has none.
    fn rows(&self) -> Vec<Row>;
}

/// A [`Peer`] whose timed part itself leaves the rows, in memory that is there already.
struct Decoder<F> {
    decode: F,
    rows: Vec<Row>,
}

impl<F: FnMut(&mut Vec<Row>) + 'static> Decoder<F> {
    fn boxed(samples: usize, decode: F) -> Box<dyn Peer> {
        let rows = Vec::with_capacity(samples);
        Box::new(Self { decode, rows })
    }
}

impl<F: FnMut(&mut Vec<Row>)> Peer for Decoder<F> {
    fn decode(&mut self) {
        self.rows.clear();
        (self.decode)(&mut self.rows);
    }

    fn rows(&self) -> Vec<Row> {
        self.rows.clone()
    }
}

fn row(linear: DVec3, angular: DVec3) -> Row {
    [
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    ]
}

fn push(input: &Input) -> Box<dyn Peer> {
    let ready = input.recorded.decoupler(Scheme::Heun);
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        problem::decouple(black_box(&ready), black_box(&voltage_v), |s| {
            rows.push(row(s.linear_ground_m_s2, s.angular_ground_rad_s2));
        });
    })
}

fn record(input: &Input, portable: bool) -> Box<dyn Peer> {
    let ready = input.recorded.decoupler(Scheme::Heun);
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        let mut decoupler = black_box(&ready).clone();
        let mut sink = |done: &[Row]| rows.extend_from_slice(done);
        let voltage_v = black_box(&voltage_v);
        let done = if portable {
            decoupler.push_record_portable(voltage_v, &mut sink)
        } else {
            decoupler.push_record(voltage_v, &mut sink)
        };
        done.expect("a recorded run");
    })
}

/// Eight streams of the same record; the rows are the last one's.
struct Lanes {
    ready: Decoupler,
    voltage_v: Vec<[f64; LIMBS]>,
    samples: Vec<LaneSample>,
}

impl Peer for Lanes {
    fn decode(&mut self) {
        let mut streams: [Decoupler; LANES] = from_fn(|_| black_box(&self.ready).clone());
        let rows = black_box([&self.voltage_v[..]; LANES]);
        self.samples.clear();
        let samples = &mut self.samples;
        push_lanes(&mut streams, rows, &mut |done| {
            samples.extend_from_slice(done)
        })
        .expect("a recorded run");
    }

    fn records(&self) -> u32 {
        LANES as u32
    }

    fn rows(&self) -> Vec<Row> {
        let last = |sample: &LaneSample| from_fn(|i| sample[i].0[LANES - 1]);
        self.samples.iter().map(last).collect()
    }
}

fn lanes(input: &Input) -> Box<dyn Peer> {
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Box::new(Lanes {
        ready: input.recorded.decoupler(Scheme::Heun),
        samples: Vec::with_capacity(voltage_v.len()),
        voltage_v,
    })
}

fn rigid(input: &Input) -> Box<dyn Peer> {
    let recorded = &input.recorded;
    let settings = recorded.settings(Scheme::Heun);
    let ready = RigidDecoupler::new(&recorded.sensor(), &true_parameters(), &settings)
        .expect("a decoupler of the true sensor");
    let voltage_v = recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        let mut decoupler = black_box(&ready).clone();
        for voltage in black_box(&voltage_v) {
            if let Some(s) = decoupler.push(voltage).expect("a recorded run") {
                // The others begin with the second sample.
                if s.sample > 0 {
                    rows.push(row(s.linear_ground_m_s2, s.angular_ground_rad_s2));
                }
            }
        }
    })
}

fn nalgebra(input: &Input) -> Box<dyn Peer> {
    let ready = PeerDecoupler::new(&input.recorded, &true_parameters());
    let voltage_v = input.recorded.recording.voltage_v.clone();
    Decoder::boxed(voltage_v.len(), move |rows| {
        peer::decouple(black_box(&ready), black_box(&voltage_v), |s| {
            rows.push([
                s.a.x,
                s.a.y,
                s.a.z,
                s.w_dot_ground.x,
                s.w_dot_ground.y,
                s.w_dot_ground.z,
            ]);
        });
    })
}

/// One MuJoCo call a sample on the recorded state of both bodies.
struct Mujoco<C, R> {
    sensor: FreeSensor,
    /// States of the samples that are decoupled: all but the first and the last.
    states: Vec<State>,
    /// Force that drives the shell at each of them.
    drive: Vec<Row>,
    /// Calls MuJoCo and returns what is kept of the outcome.
    call: C,
    outcome: Vec<Row>,
    /// Accelerations from a state and the outcome of its call; not timed.
    to_row: R,
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

fn six(values: &[f64]) -> Row {
    values.try_into().expect("six numbers")
}

/// Linear and angular part of six numbers.
fn halves(values: &[f64]) -> (DVec3, DVec3) {
    (DVec3::from_slice(values), DVec3::from_slice(&values[3..]))
}

/// Attitude of the body whose coordinates these are, as MuJoCo orders them.
fn attitude(qpos: &[f64]) -> DQuat {
    DQuat::from_xyzw(qpos[4], qpos[5], qpos[6], qpos[3])
}

fn mujoco_inverse(input: &Input) -> Box<dyn Peer> {
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

fn mujoco_step(input: &Input) -> Box<dyn Peer> {
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
fn drive(sensor: &mut FreeSensor, state: &State) -> Row {
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

/// Euler's equation of the mass in its own axes with the recorded torque, straight lines between samples.
struct Rotation {
    rate_hz: f64,
    /// Torque per mass at every decoupled sample, mass axes, m^2/s^2.
    torque: Vec<Vector3<f64>>,
    inertia: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
}

/// ode_solvers has a nalgebra of its own, older than ours, so matrices are written out.
fn times(m: &[[f64; 3]; 3], v: &Vector3<f64>) -> Vector3<f64> {
    let line = |r: &[f64; 3]| r[0] * v.x + r[1] * v.y + r[2] * v.z;
    Vector3::new(line(&m[0]), line(&m[1]), line(&m[2]))
}

impl Rotation {
    fn derivative(&self, torque: &Vector3<f64>, w: &Vector3<f64>) -> Vector3<f64> {
        times(&self.inverse, &(torque - w.cross(&times(&self.inertia, w))))
    }

    fn end_s(&self) -> f64 {
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

type Solve = fn(&Rotation) -> Vec<Vector3<f64>>;

fn rk4(rotation: &Rotation) -> Vec<Vector3<f64>> {
    let step_s = 1.0 / rotation.rate_hz;
    let mut solver = Rk4::new(rotation, 0.0, Vector3::zeros(), rotation.end_s(), step_s);
    solver.integrate().expect("Rk4 to reach the end");
    solver.y_out().clone()
}

fn dopri5(rotation: &Rotation) -> Vec<Vector3<f64>> {
    let (relative, absolute) = DOPRI5_TOLERANCE;
    let (start, end_s, step_s) = (Vector3::zeros(), rotation.end_s(), 1.0 / rotation.rate_hz);
    let mut solver = Dopri5::new(rotation, 0.0, end_s, step_s, start, relative, absolute);
    solver.integrate().expect("Dopri5 to reach the end");
    solver.y_out().clone()
}

/// The rotational equation alone, by the crate ode_solvers.
struct OdeSolvers {
    rotation: Rotation,
    solve: Solve,
    /// Attitude of the mass at every decoupled sample: for the answer, not for the solver.
    attitudes: Vec<DQuat>,
    rates: Vec<Vector3<f64>>,
}

impl OdeSolvers {
    fn new(input: &Input, solve: Solve) -> Self {
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

/// What the peers know beside the voltages. The order of the fields is that of the numbers in `problem.bin`.
#[derive(Serialize, Deserialize)]
struct Problem {
    samples: usize,
    sample_rate_hz: f64,
    limb_length_m: f64,
    half_edge_m: f64,
    direction_shell: [[f64; 3]; LIMBS],
    mass_hinge_m: [[f64; 3]; LIMBS],
    shell_hinge_m: [[f64; 3]; LIMBS],
    gain_n_per_v: [f64; LIMBS],
    zero_drift_v: [f64; LIMBS],
    scale_per_mass_per_kg: [f64; LIMBS],
    inertia_per_mass_m2: [[f64; 3]; 3],
    stiffness_per_mass_per_s2: f64,
    preload_per_mass_m_s2: [f64; LIMBS],
    gravity_ground_m_s2: [f64; 3],
    /// R at the first decoupled sample, by rows.
    initial_attitude: [[f64; 3]; 3],
    /// For engines, which think in kilograms.
    mass_kg: f64,
    shell_mass_kg: f64,
    shell_inertia_kg_m2: f64,
}

impl Problem {
    fn of(recording: &Recording) -> Result<Self, Box<dyn Error>> {
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
            gain_n_per_v: recording.gains.gain_n_per_v,
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
            mass_kg: compound_5_hz().model(&parameters).mass_kg,
            shell_mass_kg: SHELL_MASS_KG,
            shell_inertia_kg_m2: SHELL_INERTIA_KG_M2,
        })
    }

    fn inertia(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.inertia_per_mass_m2)
    }

    /// The same numbers one after the other, for peers that read no JSON.
    fn flat(&self) -> Vec<f64> {
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

/// One exported problem, read back.
struct Input {
    problem: Problem,
    /// Without truth: nobody who serves may look at it.
    recorded: Recorded,
    states: Vec<State>,
    /// At every decoupled sample.
    wrenches: Vec<Wrench>,
}

impl Input {
    fn read(dir: &Path) -> Result<Self, Box<dyn Error>> {
        let problem: Problem = serde_json::from_slice(&fs::read(dir.join("problem.json"))?)?;
        let recording = Recording {
            sample_rate_hz: problem.sample_rate_hz,
            gains: Gains {
                gain_n_per_v: problem.gain_n_per_v,
            },
            full_scale_v: f64::INFINITY,
            voltage_v: read_rows(&dir.join("voltage.bin"))?,
            accelerometer_m_s2: Vec::new(),
            gyroscope_rad_s: Vec::new(),
            direction_ground: compound_5_hz().run.direction_ground,
            gravity_ground_m_s2: problem.gravity_ground_m_s2.into(),
            frequency_hz: compound_5_hz().run.frequency_hz,
        };
        Ok(Self {
            problem,
            recorded: Recorded {
                recording,
                truth: Vec::new(),
            },
            states: read_rows(&dir.join("states.bin"))?,
            wrenches: read_rows(&dir.join("wrench.bin"))?,
        })
    }

    fn decoupled_states(&self) -> &[State] {
        &self.states[1..self.states.len() - 1]
    }
}

fn read_rows<const N: usize>(path: &Path) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
    let bytes = fs::read(path)?;
    let (numbers, []) = bytes.as_chunks::<8>() else {
        return Err(format!("{} is no file of f64", path.display()).into());
    };
    let numbers: Vec<f64> = numbers.iter().copied().map(f64::from_le_bytes).collect();
    let (rows, []) = numbers.as_chunks::<N>() else {
        return Err(format!("{} has no rows of {N}", path.display()).into());
    };
    Ok(rows.to_vec())
}

fn write_rows(path: &Path, numbers: &[f64]) -> std::io::Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(path, bytes)
}

/// MuJoCo's state at every sample of the run: the same simulation once more, since a recording does not keep it.
fn states(samples: usize) -> Result<Vec<State>, Box<dyn Error>> {
    let trial = compound_5_hz();
    let steps_per_sample = (1.0 / (DECOUPLE_RATE_HZ * STEP_S)).round() as usize;
    let mut simulation = problem::simulation(&trial);
    let mut states = Vec::with_capacity(samples);
    for step in 0..samples * steps_per_sample {
        simulation.set_time_s(step as f64 * STEP_S);
        let now = simulation.step(&trial.run)?;
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
fn wrenches(problem: &Problem, recording: &Recording) -> Vec<Wrench> {
    let chain = SignalChain::new(&recording.gains, &true_parameters());
    let geometry = PeerGeometry::new(&Geometry::PAPER);
    let mut last = PeerPose::unloaded();
    let wrench = |voltage_v: &[f64; LIMBS]| {
        let tared = chain.force_per_mass_m_s2(voltage_v);
        let force = core::array::from_fn(|i| tared[i] + problem.preload_per_mass_m_s2[i]);
        let elongation_m = force.map(|f| -f / problem.stiffness_per_mass_per_s2);
        last = geometry.pose(&elongation_m, last);
        let (position_shell_m, rotation_rad) = last.to_glam();
        let pose = Pose {
            position_shell_m,
            rotation_rad,
        };
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

fn export(dir: &Path) -> Result<(), Box<dyn Error>> {
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
    let ready = PeerDecoupler::new(&recorded, &true_parameters());
    peer::decouple(&ready, &recorded.recording.voltage_v, |sample| {
        let answer = Answer::from(sample);
        oracle.push(row(answer.linear_ground_m_s2, answer.angular_ground_rad_s2));
    });
    write_rows(&dir.join("oracle.bin"), oracle.as_flattened())?;
    println!("{samples} of the run's {played} samples");
    Ok(())
}

fn serve(mut peer: Box<dyn Peer>) -> Result<(), Box<dyn Error>> {
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_once(' ') {
            Some(("answer", file)) => {
                peer.decode();
                let rows = peer.rows();
                write_rows(Path::new(file), rows.as_flattened())?;
                println!("{}", rows.len());
            }
            Some(("time", repeats)) => {
                let repeats: u32 = repeats.parse()?;
                let start = Instant::now();
                for _ in 0..repeats {
                    peer.decode();
                }
                println!(
                    "{:e}",
                    start.elapsed().as_secs_f64() / f64::from(repeats * peer.records())
                );
            }
            None if line == "quit" => break,
            _ => return Err(format!("no such request: {line}").into()),
        }
        std::io::stdout().flush()?;
    }
    Ok(())
}

fn run(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let names = || {
        PEERS
            .iter()
            .map(|(name, _)| *name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let [task, dir] = arguments else {
        return Err(format!(
            "usage: serve export DIR | serve NAME DIR, NAME one of {}",
            names()
        )
        .into());
    };
    let dir = Path::new(dir);
    if task == "export" {
        return export(dir);
    }
    let Some((_, ready)) = PEERS.iter().find(|(name, _)| name == task) else {
        return Err(format!("no implementation {task}: there are {}", names()).into());
    };
    serve(ready(&Input::read(dir)?))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("serve: {error}");
            ExitCode::FAILURE
        }
    }
}
