//! What the measured work is given: made by the parent, read by the processes that are measured.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sixaxis_calibration::calibrate::{Options, calibrate};
use sixaxis_calibration::calibration::{CalibratedParameters, Calibration};
use sixaxis_calibration::progress::NoProgress;
use sixaxis_core::{LIMBS, Scheme};
use sixaxis_props::problem::recorded::{self, DECOUPLE_RATE_HZ, Recorded, true_parameters};
use sixaxis_props::results::Work;
use sixaxis_recordings::session::SessionFile;
use sixaxis_recordings::{Block, Layout, create};
use sixaxis_reference::laboratory::plan::{Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::laboratory::write::write;

/// Scheme of long records: Heun's rate runs away after 1.3e7 samples of a run that is repeated, this one's does not.
pub const LONG_SCHEME: Scheme = Scheme::AdamsMoulton4;
/// Samples of a stream in lanes.
pub const STREAM_SAMPLES: usize = 1_000;

/// The run that is repeated, and what is known of it.
#[derive(Serialize, Deserialize)]
pub struct Motion {
    pub voltage_v: Vec<[f64; LIMBS]>,
    pub gravity_ground_m_s2: [f64; 3],
    pub sample_rate_hz: f64,
}

/// A folder of inputs, gone when it is dropped.
pub struct Given {
    folder: PathBuf,
    motion: Motion,
}

pub fn calibration_file(folder: &Path) -> PathBuf {
    folder.join("calibration.json")
}

pub fn motion_file(folder: &Path) -> PathBuf {
    folder.join("motion.json")
}

pub fn recording_file(folder: &Path) -> PathBuf {
    folder.join("recording.parquet")
}

pub fn session_folder(folder: &Path) -> PathBuf {
    folder.join("session")
}

/// The paper's trials, played in closed form.
fn session(trials_per_step: usize) -> SessionPlan {
    SessionPlan {
        engine: Engine::Rigid,
        trials_per_step,
        ..SessionPlan::default()
    }
}

/// Sessions of a campaign are short, so that a thousand take less than a minute of two cores.
pub fn campaign_plan() -> SessionPlan {
    SessionPlan {
        sensor: SensorChoice::Random,
        sample_rate_hz: 200.0,
        ..session(3)
    }
}

/// Fitted trials of a session of the campaign, and their sample rate, Hz.
pub fn campaign_session() -> (usize, f64) {
    let plan = campaign_plan();
    (3 * plan.trials_per_step, plan.sample_rate_hz)
}

impl Given {
    pub fn new(folder: &Path) -> Result<Self, Box<dyn Error>> {
        // What a killed run left.
        let _ = fs::remove_dir_all(folder);
        fs::create_dir_all(folder)?;
        let Recorded { recording, .. } =
            Recorded::play(&recorded::compound_5_hz(), DECOUPLE_RATE_HZ);
        let motion = Motion {
            gravity_ground_m_s2: recording.gravity_ground_m_s2.to_array(),
            sample_rate_hz: recording.sample_rate_hz,
            voltage_v: recording.voltage_v,
        };
        fs::write(motion_file(folder), serde_json::to_vec(&motion)?)?;
        let given = Self {
            folder: folder.to_owned(),
            motion,
        };
        // A calibration's file with the true parameters: with others an open loop would run away over hours of repeated motion.
        given.write_session(3)?;
        let file = SessionFile::read(&session_folder(folder).join("session.toml"))?;
        let calibrated = calibrate(&file, &Options::default(), &NoProgress)?;
        let mut calibration: Calibration = calibrated.calibration.ok_or("no calibration")?;
        calibration.parameters = CalibratedParameters::from(true_parameters());
        calibration.sensor.gain_n_per_v = recording.gain_n_per_v;
        fs::write(calibration_file(folder), serde_json::to_vec(&calibration)?)?;
        Ok(given)
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn write_session(&self, trials_per_step: usize) -> Result<(), Box<dyn Error>> {
        let simulated = simulate_session(&session(trials_per_step))?;
        write(&simulated, &session_folder(&self.folder), "parquet")?;
        Ok(())
    }

    /// The run over and over, as a file.
    fn write_recording(&self, samples: usize) -> Result<(), Box<dyn Error>> {
        let rate_hz = self.motion.sample_rate_hz;
        let layout = Layout::of_a_sensor(Some(rate_hz), false);
        let mut sink = create(&recording_file(&self.folder), &layout)?;
        let rows = &self.motion.voltage_v;
        let mut left = samples;
        while left > 0 {
            let rows = &rows[..rows.len().min(left)];
            left -= rows.len();
            let column = |limb: usize| rows.iter().map(|row| row[limb]).collect();
            sink.write(&Block {
                columns: (0..LIMBS).map(column).collect(),
            })?;
        }
        Ok(sink.finish()?)
    }

    /// Makes what work of this size reads.
    pub fn prepare(&self, work: Work, size: u64) -> Result<(), Box<dyn Error>> {
        match work {
            Work::Decouple => self.write_recording(size as usize),
            Work::Calibrate => self.write_session(size as usize / 3),
            Work::PushRecord | Work::PushLanes | Work::Campaign => Ok(()),
        }
    }

    /// Removes it, and what the work has written.
    pub fn clear(&self, work: Work) -> Result<(), Box<dyn Error>> {
        match work {
            Work::Decouple => fs::remove_file(recording_file(&self.folder))?,
            Work::Calibrate => fs::remove_dir_all(session_folder(&self.folder))?,
            Work::PushRecord | Work::PushLanes | Work::Campaign => {}
        }
        Ok(())
    }
}

impl Drop for Given {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}
