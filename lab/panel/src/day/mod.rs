//! The calibration day: which recordings it needs, what has been recorded, and the calibration of what there is so far.
//!
//! A worker thread writes each trial into the output folder, checks it, and runs the one pipeline of `sixaxis-calibration` over the
//! session that is being collected. The acquisition never waits for it.
//!
//! | file | holds |
//! |---|---|
//! | [`check`] | whether a trial is the one that was asked for: frequency, amplitude, direction, rest, range |
//! | [`worth`] | what a trial that is still to come would tell |
//! | [`outcome`] | what the browser is shown of it |

pub mod check;
pub mod outcome;
pub mod worth;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;

use sixaxis_calibration::calibrate::{Options, calibrate};
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::report::ParameterReport;
use sixaxis_recordings::draft::write_atomically;
use sixaxis_recordings::session::{Entry, Role, Session, SessionFile};
use sixaxis_recordings::{Block, Layout, create};

use crate::columns::Batch;
use crate::source::{Begin, Event, Sender};
pub use check::Check;
pub use outcome::Outcome;
use worth::Information;

/// Folder of the calibration day below the output folder.
pub const FOLDER: &str = "day";
/// Trials of steps 2 and 3 each from which a calibration is tried.
const FEWEST: usize = 3;

/// What is to be recorded.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Sensor, instruments, rig, limits; its own recordings are not looked at.
    pub session: Session,
    /// The recordings in order, each with its length, s; none where the person ends it.
    pub entries: Vec<(Entry, Option<f64>)>,
}

impl Plan {
    /// Of a session file: its recordings are to be made anew.
    pub fn of_session(session: &Session) -> Self {
        let entries = session.recording.iter().map(|entry| (entry.clone(), None));
        Self {
            entries: entries.collect(),
            session: session.clone(),
        }
    }
}

/// A trial that has been recorded.
pub struct Captured {
    /// Which.
    pub trial: usize,
    /// How it was.
    pub begin: Begin,
    /// Its samples.
    pub samples: Batch,
    /// Samples per second.
    pub sample_rate_hz: f64,
}

/// Something for the worker.
pub enum Job {
    /// A trial that has been recorded.
    Captured(Box<Captured>),
    /// A trial that is to be left out.
    Discard(usize),
}

/// The worker's state.
pub struct Day {
    plan: Plan,
    folder: PathBuf,
    done: BTreeMap<usize, (Entry, Check)>,
    /// Half widths of the 25 intervals after each calibration, for their shrinking.
    widths: Vec<Vec<Option<f64>>>,
}

impl Day {
    /// Nothing recorded.
    pub fn new(plan: Plan, out: &Path) -> Self {
        Self {
            plan,
            folder: out.join(FOLDER),
            done: BTreeMap::new(),
            widths: Vec::new(),
        }
    }

    /// Works until nobody sends jobs any more.
    pub fn run(mut self, jobs: &Receiver<Job>, sender: &Sender) {
        while let Ok(first) = jobs.recv() {
            let mut problem = self.take(first).err();
            // Only the newest state is calibrated.
            while let Ok(job) = jobs.try_recv() {
                problem = self.take(job).err().or(problem);
            }
            // What was recorded is shown before the calibration is done.
            let recorded = outcome::Outcome::recorded(&self.plan, &self.done, problem);
            if sender
                .send(Event::Calibrated(Box::new(recorded.clone())))
                .is_err()
            {
                return;
            }
            let outcome = match self.calibrated(recorded) {
                Some(outcome) => outcome,
                None => continue,
            };
            if sender.send(Event::Calibrated(Box::new(outcome))).is_err() {
                return;
            }
        }
    }

    fn take(&mut self, job: Job) -> Result<(), String> {
        match job {
            Job::Discard(trial) => {
                self.done.remove(&trial);
                Ok(())
            }
            Job::Captured(captured) => {
                let Captured {
                    trial,
                    begin,
                    samples,
                    sample_rate_hz,
                } = *captured;
                let Some((planned, _)) = self.plan.entries.get(trial) else {
                    return Err("no such trial".to_owned());
                };
                let stem = planned.file.with_extension("");
                let name = stem.file_name().unwrap_or_default().to_string_lossy();
                let file = PathBuf::from(format!("{name}.tdms"));
                let moves = planned.role != Role::Static;
                let entry = Entry {
                    file: file.clone(),
                    role: planned.role,
                    direction: planned.direction,
                    frequency_hz: planned.frequency_hz,
                    ..begin.entry.clone()
                };
                let card = &self.plan.session;
                let check =
                    check::check(card, &entry, &begin.gain_n_per_v, &samples, sample_rate_hz);
                write(&self.folder.join(&file), &samples, sample_rate_hz, moves)
                    .map_err(|error| error.to_string())?;
                self.done.insert(trial, (entry, check));
                Ok(())
            }
        }
    }

    /// The calibration of what there is, if that is enough to try.
    fn calibrated(&mut self, recorded: Outcome) -> Option<Outcome> {
        let count = |role| {
            self.done
                .values()
                .filter(|(entry, _)| entry.role == role)
                .count()
        };
        if count(Role::Static) == 0 || count(Role::Linear) < FEWEST || count(Role::Angular) < FEWEST
        {
            return None;
        }
        Some(match self.session_file() {
            Err(problem) => Outcome {
                problem: Some(problem),
                ..recorded
            },
            Ok(file) => match calibrate(&file, &Options::default(), &NoProgress) {
                Err(error) => Outcome {
                    problem: Some(error.to_string()),
                    ..recorded
                },
                Ok(calibrated) => {
                    let widths = calibrated.parameters.iter().map(|p| p.half_width_95);
                    self.widths.push(widths.collect());
                    let path = self.folder.join("calibration.json");
                    let written = calibrated.calibration.as_ref().map(|c| c.write(&path));
                    let problem = match written {
                        Some(Err(error)) => Some(error.to_string()),
                        _ => None,
                    };
                    let mut outcome = recorded.with(&calibrated, &self.widths, &path, problem);
                    self.price(&mut outcome, &calibrated.parameters);
                    outcome
                }
            },
        })
    }

    /// Says of the trials that are to come what they are worth.
    fn price(&self, outcome: &mut Outcome, parameters: &[ParameterReport]) {
        let Some(none) = Information::none(&self.plan.session) else {
            return;
        };
        let recorded = self.done.values().map(|(entry, _)| entry);
        let told = recorded.fold(none, Information::with);
        for (index, trial) in outcome.trials.iter_mut().enumerate() {
            let (entry, _) = &self.plan.entries[index];
            if !self.done.contains_key(&index) {
                trial.worth = told.worth(entry, parameters);
            }
        }
    }

    /// The session of what there is, written beside its recordings.
    fn session_file(&self) -> Result<SessionFile, String> {
        let session = Session {
            recording: self.done.values().map(|(entry, _)| entry.clone()).collect(),
            ..self.plan.session.clone()
        };
        let text = toml::to_string(&session).map_err(|error| error.to_string())?;
        let path = self.folder.join("session.toml");
        write_atomically(&path, text.as_bytes()).map_err(|error| error.to_string())?;
        SessionFile::parse(&path, text).map_err(|error| error.to_string())
    }
}

/// Writes a trial.
fn write(
    path: &Path,
    samples: &Batch,
    rate_hz: f64,
    moves: bool,
) -> sixaxis_recordings::Result<()> {
    let mut columns = samples.voltage_v.columns.to_vec();
    if moves {
        columns.extend(samples.standard.iter().cloned());
    }
    let mut sink = create(path, &Layout::of_a_sensor(Some(rate_hz), moves))?;
    sink.write(&Block { columns })?;
    sink.finish()
}
