//! What a peer is, and what it is given.

use glam::DVec3;
use sixaxis_props::problem::recorded::Recorded;
use sixaxis_props::problem::recorded::compound_5_hz;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use std::error::Error;
use std::fs;
use std::path::Path;

use crate::problem::Problem;

/// Linear, m/s^2, and angular acceleration, rad/s^2, of one sample, ground axes.
pub type Row = [f64; 6];

/// Force, m/s^2, and torque, m^2/s^2, of the limbs on the mass, per mass, mass axes.
pub type Wrench = [f64; 6];

/// MuJoCo's qpos (14) and qvel (12) of shell and mass, and the shell's part of qacc (6).
pub type State = [f64; 32];

/// Something that works through the whole record.
pub trait Peer {
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
pub struct Decoder<F> {
    pub decode: F,
    pub rows: Vec<Row>,
}

impl<F: FnMut(&mut Vec<Row>) + 'static> Decoder<F> {
    pub fn boxed(samples: usize, decode: F) -> Box<dyn Peer> {
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

pub fn row(linear: DVec3, angular: DVec3) -> Row {
    [
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    ]
}

/// One exported problem, read back.
pub struct Input {
    pub problem: Problem,
    /// Without truth: nobody who serves may look at it.
    pub recorded: Recorded,
    pub states: Vec<State>,
    /// At every decoupled sample.
    pub wrenches: Vec<Wrench>,
}

impl Input {
    pub fn read(dir: &Path) -> Result<Self, Box<dyn Error>> {
        let problem: Problem = serde_json::from_slice(&fs::read(dir.join("problem.json"))?)?;
        let rate_hz = problem.sample_rate_hz;
        let recording = SimulatedRecording {
            gain_n_per_v: problem.gain_n_per_v,
            voltage_v: read_rows(&dir.join("voltage.bin"))?,
            direction_ground: compound_5_hz().direction_ground,
            gravity_ground_m_s2: problem.gravity_ground_m_s2.into(),
            frequency_hz: compound_5_hz().frequency_hz,
            true_gravity_ground_m_s2: problem.gravity_ground_m_s2.into(),
            ..SimulatedRecording::of_nothing("", Role::Validation, rate_hz, f64::INFINITY)
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

    pub fn decoupled_states(&self) -> &[State] {
        &self.states[1..self.states.len() - 1]
    }
}

pub fn read_rows<const N: usize>(path: &Path) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
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
