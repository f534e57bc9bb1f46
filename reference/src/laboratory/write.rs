//! A simulated session on disk: recordings, session file and, in a folder of its own, the truth.

use std::path::{Path, PathBuf};

use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::motion::MOTION_CHANNELS;
use sixaxis_recordings::{Block, Channel, Layout, create};

use super::plan_file::with_comments;
use super::recording::SimulatedRecording;
use super::session::SimulatedSession;
use crate::geometry::LIMBS;

/// Name of the session file.
pub const SESSION_FILE: &str = "session.toml";
/// The plan that was simulated, in the folder of the truth: simulates the same session again.
pub const PLAN_FILE: &str = "plan.toml";
/// Folder of the truth, which a laboratory does not have.
pub const TRUTH_FOLDER: &str = "truth";

/// Rows of a block.
const BLOCK: usize = 1 << 16;

/// Writes a session into a folder, recordings with the given extension (`csv`, `csv.gz`, `parquet`, `tdms`, `npz`). A session
/// file that is there already goes first and the new one comes last: a folder that has one is complete, whenever writing was
/// cut short. Recordings of the same names are replaced, other files stay.
///
/// # Errors
/// Those of writing.
pub fn write(
    simulated: &SimulatedSession,
    folder: &Path,
    extension: &str,
) -> sixaxis_recordings::Result<PathBuf> {
    let path = folder.join(SESSION_FILE);
    let truth_folder = folder.join(TRUTH_FOLDER);
    match std::fs::remove_file(&path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            return Err(sixaxis_recordings::Error::io(&path, e));
        }
        _ => {}
    }
    let mut session = simulated.session.clone();
    for (recording, entry) in simulated.recordings.iter().zip(&mut session.recording) {
        let name = format!("{}.{extension}", entry.file.display());
        write_recording(recording, &folder.join(&name))?;
        if !recording.truth.is_empty() {
            write_truth(recording, &truth_folder.join(&name))?;
        }
        entry.file = PathBuf::from(name);
    }
    let truth_path = truth_folder.join("truth.json");
    let truth = serde_json::to_vec_pretty(&simulated.truth)
        .map_err(|e| sixaxis_recordings::Error::io(&truth_path, std::io::Error::other(e)))?;
    write_atomically(&truth_path, &truth)?;
    write_atomically(
        &truth_folder.join(PLAN_FILE),
        with_comments(&simulated.truth.plan).as_bytes(),
    )?;
    let text = toml::to_string(&session)
        .map_err(|e| sixaxis_recordings::Error::io(&path, std::io::Error::other(e)))?;
    write_atomically(&path, text.as_bytes())?;
    Ok(path)
}

/// Writes a recording that is no part of the session into the session's folder, and its truth apart: a tumble.
///
/// # Errors
/// Those of writing.
pub fn write_beside(
    recording: &SimulatedRecording,
    folder: &Path,
    extension: &str,
) -> sixaxis_recordings::Result<PathBuf> {
    let name = format!("{}.{extension}", recording.name);
    let path = folder.join(&name);
    write_recording(recording, &path)?;
    write_truth(recording, &folder.join(TRUTH_FOLDER).join(&name))?;
    Ok(path)
}

fn write_recording(recording: &SimulatedRecording, path: &Path) -> sixaxis_recordings::Result<()> {
    let moves = !recording.accelerometer_m_s2.is_empty();
    let layout = Layout::of_a_sensor(Some(recording.sample_rate_hz), moves);
    let columns = layout.channels.len();
    let mut sink = create(path, &layout)?;
    let mut block = Block::new(columns);
    for start in (0..recording.voltage_v.len()).step_by(BLOCK) {
        let rows = start..(start + BLOCK).min(recording.voltage_v.len());
        block.clear(columns);
        for (limb, column) in block.columns.iter_mut().take(LIMBS).enumerate() {
            column.extend(
                recording.voltage_v[rows.clone()]
                    .iter()
                    .map(|row| row[limb]),
            );
        }
        if moves {
            block.columns[LIMBS].extend_from_slice(&recording.accelerometer_m_s2[rows.clone()]);
            block.columns[LIMBS + 1].extend_from_slice(&recording.gyroscope_rad_s[rows]);
        }
        sink.write(&block)?;
    }
    sink.finish()
}

fn write_truth(recording: &SimulatedRecording, path: &Path) -> sixaxis_recordings::Result<()> {
    let channels = MOTION_CHANNELS.map(|(name, unit)| Channel {
        sample_rate_hz: Some(recording.sample_rate_hz),
        ..Channel::new(name, Some(unit))
    });
    let columns = channels.len();
    let layout = Layout {
        channels: channels.to_vec(),
        ..Layout::default()
    };
    let mut sink = create(path, &layout)?;
    let mut block = Block::new(columns);
    for rows in recording.truth.chunks(BLOCK) {
        block.clear(columns);
        for truth in rows {
            let q = truth.attitude;
            let values = truth
                .linear_ground_m_s2
                .to_array()
                .into_iter()
                .chain(truth.angular_ground_rad_s2.to_array())
                .chain(truth.rate_shell_rad_s.to_array())
                .chain([q.w, q.x, q.y, q.z]);
            for (column, value) in block.columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
        sink.write(&block)?;
    }
    sink.finish()
}
