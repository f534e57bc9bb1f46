//! Recording to disk, so that what was acknowledged survives the program's death: rows go to a journal first, appended and
//! flushed, and become a TDMS, Parquet or CSV file when the recording is stopped or, after a crash, when the panel starts again.
//!
//! A journal is [`HEAD`] bytes of text, a JSON object padded with blanks to a line, and then rows of little-endian 64-bit numbers:
//! NumPy reads it by `fromfile(path, "<f8", offset=1024).reshape(-1, columns)`.

use std::fmt::Display;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, Read, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow, bail, ensure};
use serde::{Deserialize, Serialize};
use sixaxis_recordings::{Block, Channel, Layout, create};

use crate::board::locked;
use crate::control::FileFormat;

/// Bytes before the first row of a journal.
pub const HEAD: usize = 1024;
/// Ending of a journal's name.
pub const ENDING: &str = "journal";
/// Time between two flushes to disk.
const FLUSH: Duration = Duration::from_millis(500);
/// Pieces that may wait for the disk: some seconds.
const WAITING: usize = 1024;
/// Rows of a finished file that are converted at a time.
const ROWS: usize = 1 << 14;

/// The head of a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// `sixaxis-journal-1`.
    pub journal: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Names and units.
    pub columns: Vec<(String, String)>,
    /// What it is to become.
    pub format: FileFormat,
}

const JOURNAL: &str = "sixaxis-journal-1";
/// Said of a name that would replace a file.
const EXISTS: &str = "is there already; give another name";

/// An error of a file.
fn of_file(path: &Path, cause: impl Display) -> anyhow::Error {
    anyhow!("{}: {cause}", path.display())
}

/// How far a recording is.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Progress {
    /// Its name without ending.
    pub name: String,
    /// Rows that the disk has confirmed: they survive even a loss of power.
    pub on_disk: u64,
    /// Rows that came before *Stop* and could not be taken since the disk is too slow. The recording ends with the first.
    pub lost: u64,
    /// The finished file.
    pub finished: Option<String>,
    /// Why it failed; the journal holds what was acknowledged.
    pub failed: Option<String>,
}

/// A recording under way.
pub struct Recorder {
    rows: Option<SyncSender<Vec<f64>>>,
    columns: usize,
    /// Whether rows come that the disk was too slow for.
    loses: bool,
    progress: Arc<Mutex<Progress>>,
    thread: Option<JoinHandle<()>>,
}

impl Recorder {
    /// Starts a recording, which replaces nothing.
    ///
    /// # Errors
    /// A file of that name, or of its journal's, that is there already; what the system says.
    pub fn start(folder: &Path, name: &str, head: Head) -> Result<Self> {
        let finished = folder.join(format!("{name}.{}", head.format.extension()));
        let path = folder.join(format!("{name}.{ENDING}"));
        if finished.exists() || path.exists() {
            bail!("{name} {EXISTS}");
        }
        let io = |source| of_file(&path, source);
        let mut file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)
            .map_err(io)?;
        // While it is locked, no other panel takes it for one that a crash has left.
        file.try_lock().map_err(|e| io(e.into()))?;
        file.write_all(&head_bytes(&head)).map_err(io)?;
        file.sync_all().map_err(io)?;
        let progress = Arc::new(Mutex::new(Progress {
            name: name.to_owned(),
            ..Progress::default()
        }));
        let columns = head.columns.len().max(1);
        let (rows, received) = sync_channel(WAITING);
        let of_thread = Arc::clone(&progress);
        let thread = std::thread::Builder::new()
            .name("record".to_owned())
            .spawn(move || {
                let done = append(&mut file, &head, &received, &of_thread)
                    .map_err(|source| of_file(&path, source))
                    .and_then(|()| finish(&path, &finished));
                let mut progress = locked(&of_thread);
                match done {
                    Ok(()) => progress.finished = Some(finished.display().to_string()),
                    Err(error) => progress.failed = Some(error.to_string()),
                }
            })
            .map_err(|source| of_file(folder, source))?;
        Ok(Self {
            rows: Some(rows),
            columns,
            loses: false,
            progress,
            thread: Some(thread),
        })
    }

    /// Takes rows, one after the other in one vector. Never waits: a disk that is behind by [`WAITING`] pieces ends the recording.
    pub fn push(&mut self, rows: Vec<f64>) {
        let refused = match &self.rows {
            Some(sender) => sender.try_send(rows).err(),
            None => self.loses.then_some(TrySendError::Full(rows)),
        };
        let Some(error) = refused else {
            return;
        };
        self.rows = None;
        if let TrySendError::Full(rows) = error {
            self.loses = true;
            let mut progress = locked(&self.progress);
            progress.lost += (rows.len() / self.columns) as u64;
            progress.failed = Some(format!(
                "the disk is too slow: the recording has ended, {} rows came since and are lost",
                progress.lost
            ));
        }
    }

    /// No more rows: the file is finished on its thread.
    pub fn stop(&mut self) {
        self.rows = None;
        self.loses = false;
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        locked(&self.progress).clone()
    }

    /// Waits until the file is finished.
    pub fn wait(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.wait();
    }
}

fn head_bytes(head: &Head) -> Vec<u8> {
    let mut bytes = serde_json::to_vec(head).unwrap_or_default();
    bytes.resize(HEAD - 1, b' ');
    bytes.push(b'\n');
    bytes
}

/// A head for columns with these names and units.
pub fn head(columns: &[(&str, &str)], sample_rate_hz: f64, format: FileFormat) -> Head {
    let owned = |(name, unit): &(&str, &str)| ((*name).to_owned(), (*unit).to_owned());
    Head {
        journal: JOURNAL.to_owned(),
        sample_rate_hz,
        columns: columns.iter().map(owned).collect(),
        format,
    }
}

fn append(
    file: &mut File,
    head: &Head,
    received: &Receiver<Vec<f64>>,
    progress: &Mutex<Progress>,
) -> std::io::Result<()> {
    let width = head.columns.len().max(1) as u64;
    let (mut written, mut bytes) = (0_u64, Vec::new());
    let mut flushed = Instant::now();
    loop {
        let wait = FLUSH.saturating_sub(flushed.elapsed());
        let over = match received.recv_timeout(wait) {
            Ok(rows) => {
                bytes.clear();
                bytes.extend(rows.iter().flat_map(|value| value.to_le_bytes()));
                file.write_all(&bytes)?;
                written += rows.len() as u64 / width;
                false
            }
            Err(RecvTimeoutError::Timeout) => false,
            Err(RecvTimeoutError::Disconnected) => true,
        };
        if over || flushed.elapsed() >= FLUSH {
            file.sync_data()?;
            locked(progress).on_disk = written;
            flushed = Instant::now();
        }
        if over {
            return Ok(());
        }
    }
}

/// Reads the head of a journal.
fn read_head(file: &mut impl Read) -> Result<Head> {
    let mut bytes = [0; HEAD];
    file.read_exact(&mut bytes)?;
    let head: Head = serde_json::from_slice(&bytes)?;
    let this_version = head.journal == JOURNAL && !head.columns.is_empty();
    ensure!(this_version, "another version");
    Ok(head)
}

/// The same, with the file and what it should be.
fn head_of(file: &mut impl Read, path: &Path) -> Result<Head> {
    read_head(file)
        .map_err(|cause| of_file(path, format!("not a journal of this program: {cause}")))
}

/// Makes a file of a journal and removes the journal. A row that was cut off is left out.
fn finish(journal: &Path, finished: &Path) -> Result<()> {
    let io = |source| of_file(journal, source);
    let mut file = BufReader::with_capacity(1 << 20, File::open(journal).map_err(io)?);
    let head = head_of(&mut file, journal)?;
    let channel = |(name, unit): &(String, String)| Channel {
        sample_rate_hz: Some(head.sample_rate_hz),
        ..Channel::new(name.clone(), Some(unit))
    };
    let layout = Layout {
        channels: head.columns.iter().map(channel).collect(),
        ..Layout::default()
    };
    let mut sink = create(finished, &layout)?;
    let width = head.columns.len();
    let mut bytes = Vec::new();
    let mut block = Block::new(width);
    loop {
        bytes.clear();
        let piece = (ROWS * width * 8) as u64;
        let got = Read::take(&mut file, piece)
            .read_to_end(&mut bytes)
            .map_err(io)?;
        block.clear(width);
        let (numbers, _) = bytes.as_chunks::<8>();
        for row in numbers.chunks_exact(width) {
            for (column, number) in block.columns.iter_mut().zip(row) {
                column.push(f64::from_le_bytes(*number));
            }
        }
        sink.write(&block)?;
        if (got as u64) < piece {
            break;
        }
    }
    sink.finish()?;
    std::fs::remove_file(journal).map_err(io)
}

/// Finishes the journals that a crash has left in a folder; says of each what became of it.
pub fn recover(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let journals = entries.filter_map(|entry| Some(entry.ok()?.path()));
    journals
        .filter(|path| path.extension().is_some_and(|e| e == ENDING))
        .filter_map(|path| {
            let mut file = File::open(&path).ok()?;
            // Locked: it is being written by another panel.
            file.try_lock().ok()?;
            let made = head_of(&mut file, &path).and_then(|head| {
                let finished = path.with_extension(head.format.extension());
                if finished.exists() {
                    bail!("{} {EXISTS}", finished.display());
                }
                finish(&path, &finished)?;
                Ok(finished)
            });
            Some(match made {
                Ok(finished) => format!("{}: finished after a crash", finished.display()),
                Err(error) => format!("{}: left as it is: {error}", path.display()),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests;
