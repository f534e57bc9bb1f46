//! The acquisition: takes every sample from the source, and of each makes statistics, conditioned voltages, accelerations, a row of
//! the history and of the recording. It waits for nobody but the source: browsers read what it leaves in [`Board`], files are
//! written by threads of their own. What it does at a command stands in `commands.rs`, what browsers are told in `status.rs`.

mod commands;
mod status;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender as JobSender, SyncSender};
use std::time::{Duration, Instant};

use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::{Channels, Session};

use crate::board::{Board, Live, Post, locked};
use crate::chain::{Beside, Chain, Choice};
use crate::columns::{self, Batch, COLUMNS};
use crate::control::{LabCommand, Parameters, Stages};
use crate::day::{Captured, Job, Outcome};
use crate::history::History;
use crate::recorder::Recorder;
use crate::source::{Begin, Event, Start};
use crate::statistics::Statistics;

/// Time between two statuses.
const STATUS: Duration = Duration::from_millis(200);
/// Messages that are kept for browsers that come later.
const NOTES: usize = 50;
/// Longest trial that is kept in memory, s.
const LONGEST_TRIAL_S: f64 = 900.0;

/// What the acquisition is told when it begins.
pub struct Setup {
    /// Folder of everything that is written.
    pub out: PathBuf,
    /// Sensor, converter, design; gains where no run says others.
    pub session: Session,
    /// Names, units and delays of the channels.
    pub channels: Channels,
    /// The calibration file of the command line.
    pub calibration: Option<Calibration>,
    /// The simulated laboratory's commands, if there is one.
    pub laboratory: Option<SyncSender<LabCommand>>,
    /// The calibration day's worker.
    pub day: JobSender<Job>,
    /// Is told what is noted.
    pub tell: fn(&str),
}

/// The state of the acquisition.
struct Acquisition {
    setup: Setup,
    board: Arc<Board>,
    start: Start,
    statistics: Statistics,
    /// Of the voltages behind the stages.
    conditioned: Statistics,
    chain: Chain,
    stages: Stages,
    choice: Parameters,
    watch: bool,
    day_calibration: Option<Calibration>,
    /// The run under way, and the last one's gains and gravity.
    begin: Option<Begin>,
    last: Option<Begin>,
    capture: Option<(usize, Batch)>,
    recorder: Option<Recorder>,
    notes: Vec<(u64, String)>,
    noted: u64,
    rested: u32,
    rate: (Instant, u64, f64),
}

/// Works until the source and all who hold the way to it are gone, or `over` says so.
pub fn run(events: &Receiver<Event>, board: &Arc<Board>, setup: Setup) {
    let start = Start {
        title: "waiting for a source".to_owned(),
        sample_rate_hz: 1000.0,
        standards: false,
        truth: false,
    };
    let full_scale_v = setup.session.sensor.full_scale_v;
    let choice = if setup.calibration.is_some() {
        Parameters::File
    } else {
        Parameters::Design
    };
    let stages = Stages::default();
    let mut acquisition = Acquisition {
        statistics: Statistics::new(full_scale_v, start.sample_rate_hz),
        conditioned: Statistics::new(full_scale_v, start.sample_rate_hz),
        chain: Chain::idle(),
        board: Arc::clone(board),
        setup,
        start,
        stages,
        choice,
        watch: false,
        day_calibration: None,
        begin: None,
        last: None,
        capture: None,
        recorder: None,
        notes: Vec::new(),
        noted: 0,
        rested: 0,
        rate: (Instant::now(), 0, 0.0),
    };
    acquisition.rebuild();
    let mut told = Instant::now();
    acquisition.tell();
    while !board.is_over() {
        match events.recv_timeout(STATUS.saturating_sub(told.elapsed())) {
            Ok(event) => acquisition.take(event),
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {}
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => break,
        }
        if told.elapsed() >= STATUS {
            acquisition.tell();
            told = Instant::now();
        }
    }
}

impl Acquisition {
    fn take(&mut self, event: Event) {
        match event {
            Event::Start(start) => self.start(start),
            Event::Samples(batch) => self.samples(&batch),
            Event::Begin(begin) => self.begin(*begin),
            Event::End { complete } => self.end(complete),
            Event::Note(text) => self.note(text),
            Event::Control(message) => self.obey(message),
            Event::Calibrated(outcome) => self.calibrated(*outcome),
        }
    }

    fn note(&mut self, text: String) {
        (self.setup.tell)(&text);
        self.noted += 1;
        self.notes.push((self.noted, text));
        let old = self.notes.len().saturating_sub(NOTES);
        self.notes.drain(..old);
    }

    fn start(&mut self, start: Start) {
        self.stop_recording();
        self.note(format!(
            "{}: {} samples per second",
            start.title, start.sample_rate_hz
        ));
        self.statistics =
            Statistics::new(self.setup.session.sensor.full_scale_v, start.sample_rate_hz);
        self.conditioned = self.statistics.clone();
        *locked(&self.board.history) = History::new(start.sample_rate_hz);
        self.board.next_source();
        (self.begin, self.last, self.capture) = (None, None, None);
        self.start = start;
        self.rebuild();
    }

    /// Whose parameters, with their calibration.
    fn chosen(&self) -> Choice<'_> {
        let calibration = match self.choice {
            Parameters::Design => None,
            Parameters::File => self.setup.calibration.as_ref(),
            Parameters::Day => self.day_calibration.as_ref(),
        };
        let gains = match self.begin.as_ref().or(self.last.as_ref()) {
            Some(begin) => begin.gain_n_per_v,
            None => self.setup.session.sensor.gain_n_per_v.each(),
        };
        let begin = self.begin.as_ref().or(self.last.as_ref());
        Choice {
            session: &self.setup.session,
            calibration,
            gain_n_per_v: gains,
            gravity_ground_m_s2: begin.map_or(glam::DVec3::ZERO, |begin| begin.gravity_ground_m_s2),
            direction: begin
                .and_then(|begin| begin.entry.direction)
                .and_then(|direction| glam::DVec3::from_array(direction).try_normalize()),
            watch: self.watch,
        }
    }

    /// Another source or other stages: conditioning and decoding begin anew.
    fn rebuild(&mut self) {
        let delays_s = self
            .setup
            .channels
            .limbs_lag_us
            .map(|lags| lags.each().map(|us| us * 1e-6));
        let rate_hz = self.start.sample_rate_hz;
        if let Err(error) = self.chain.condition(&self.stages, delays_s, rate_hz) {
            self.note(format!("cannot condition: {error:#}"));
        }
        self.restart();
    }

    /// Other parameters or gains, or a rest: decoding begins anew.
    fn restart(&mut self) {
        let mut chain = std::mem::replace(&mut self.chain, Chain::idle());
        let restarted = chain.restart(&self.chosen());
        self.chain = chain;
        if let Err(error) = restarted {
            self.note(format!("cannot decode: {error:#}"));
        }
    }

    fn begin(&mut self, begin: Begin) {
        // The zeros of the rest before the run; a run begins with too short a rest of its own.
        if let Some(trial) = begin.trial {
            self.capture = Some((trial, Batch::default()));
        }
        self.begin = Some(begin);
        self.restart();
    }

    fn end(&mut self, complete: bool) {
        let begin = self.begin.take();
        self.chain.run_ended();
        self.last.clone_from(&begin);
        match (self.capture.take(), begin) {
            (Some((trial, samples)), Some(begin)) if complete => {
                let job = Job::Captured(Box::new(Captured {
                    trial,
                    begin,
                    samples,
                    sample_rate_hz: self.start.sample_rate_hz,
                }));
                if self.setup.day.send(job).is_err() {
                    self.note("the calibration day's worker is gone".to_owned());
                }
            }
            (Some(_), _) => self.note("the run was stopped: its trial is not taken".to_owned()),
            (None, _) => {}
        }
    }

    fn calibrated(&mut self, outcome: Outcome) {
        if let Ok(text) = serde_json::to_string(&serde_json::json!({ "day": &outcome })) {
            self.board.post(Post::Day, text);
        }
        if let Some(calibration) = outcome.calibration {
            let first = self.day_calibration.is_none();
            self.day_calibration = Some(calibration);
            if first && self.choice == Parameters::Design {
                self.choice = Parameters::Day;
            }
            if self.begin.is_none() {
                self.restart();
            }
        }
    }

    fn samples(&mut self, batch: &Batch) {
        let standards = batch.standard[0].len() == batch.samples();
        let truth = batch.truth.len() == batch.samples();
        if let Some(recorder) = &mut self.recorder {
            let width = LIMBS + if self.start.standards { 2 } else { 0 };
            let mut rows = Vec::with_capacity(batch.samples() * width);
            for k in 0..batch.samples() {
                rows.extend(batch.voltage_v.row(k));
                if self.start.standards {
                    rows.extend(
                        batch
                            .standard
                            .each_ref()
                            .map(|s| s.get(k).copied().unwrap_or(f64::NAN)),
                    );
                }
            }
            recorder.push(rows);
        }
        self.capture(batch);
        let mut rows: Vec<[f32; COLUMNS]> = Vec::with_capacity(batch.samples());
        for k in 0..batch.samples() {
            let raw = batch.voltage_v.row(k);
            if self.statistics.push(&raw) {
                self.window();
            }
            let mut row = [f32::NAN; COLUMNS];
            for (cell, u) in row[columns::VOLTAGE].iter_mut().zip(raw) {
                *cell = u as f32;
            }
            if standards {
                for (cell, readings) in row[columns::STANDARD].iter_mut().zip(&batch.standard) {
                    *cell = readings[k] as f32;
                }
            }
            let beside = Beside {
                truth: truth.then(|| batch.truth[k]),
                standard: standards.then(|| batch.standard.each_ref().map(|s| s[k])),
            };
            self.chain.push(&raw, beside, &mut row);
            let after = core::array::from_fn(|k| f64::from(row[columns::CONDITIONED.start + k]));
            self.conditioned.push(&after);
            rows.push(row);
        }
        for message in self.chain.messages() {
            if !self.held() || self.chain.has_stopped() {
                self.note(message);
            }
        }
        let live = Live {
            arrived: Some(Instant::now()),
            ..self.chain.live()
        };
        let mut history = locked(&self.board.history);
        for row in &rows {
            history.push(row);
        }
        drop(history);
        *locked(&self.board.live) = live;
        self.rate.1 += rows.len() as u64;
    }

    /// Whether rate and attitude are held at zero. The fault monitor begins anew with each window then, and what it makes of so few
    /// samples is no failure's.
    const fn held(&self) -> bool {
        self.rested >= 2 && self.stages.hold_at_rest
    }

    /// A window of the statistics is complete.
    fn window(&mut self) {
        let resting = self.statistics.at_rest && self.begin.is_none();
        self.rested = if resting { self.rested + 1 } else { 0 };
        // Two windows of rest, so that the first of them holds no end of a motion.
        if self.rested >= 2 {
            self.chain.zero_v = Some(self.statistics.channels.map(|c| c.mean_v));
        }
        if self.held() && self.chain.has_stopped() {
            // What is no number stays in a filter, and would stop decoding again.
            if let Some(why) = self.chain.messages().pop() {
                self.note(why);
            }
            self.rebuild();
        } else if self.held() {
            self.restart();
        }
    }

    fn capture(&mut self, batch: &Batch) {
        let most = (LONGEST_TRIAL_S * self.start.sample_rate_hz) as usize;
        let Some((_, captured)) = &mut self.capture else {
            return;
        };
        if captured.samples() > most {
            self.capture = None;
            self.note(format!(
                "a trial is at most {LONGEST_TRIAL_S} s long: it is not taken"
            ));
            return;
        }
        for (column, more) in captured
            .voltage_v
            .columns
            .iter_mut()
            .zip(&batch.voltage_v.columns)
        {
            column.extend_from_slice(more);
        }
        for (readings, more) in captured.standard.iter_mut().zip(&batch.standard) {
            readings.extend_from_slice(more);
        }
    }
}
