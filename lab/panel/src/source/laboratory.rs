//! The simulated laboratory in real time: at rest until a run is asked for, then that run sample by sample, as MuJoCo or the rigid
//! engine, the measuring chain and the instruments of `reference` make it; with defects at the press of a button.
//!
//! A run is computed on a thread of its own while the rig still stands: MuJoCo takes about as long for it as the run itself.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::chain::Converter;
use sixaxis_reference::laboratory::error::SessionError;
use sixaxis_reference::laboratory::plan::{Engine, SessionPlan};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::schedule::{PlannedTrial, trials};
use sixaxis_reference::rig::run::{Mode, Run, WEDGES};

use super::settings::{STATIC_S, Settings};
use super::{Begin, Event, LONGEST_BATCH, Sender, Start};
use crate::columns::{Batch, TRUTH_NUMBERS};
use crate::control::{Defect, FreeRun, LabCommand, Motion};

/// Time between two batches.
const TICK: Duration = Duration::from_millis(5);
/// Random streams: of the rest between runs, and the number of the first run of this room.
const REST_STREAM: u128 = 21;
/// A channel that drifts does so by this, V/s, up to a tenth of its range.
const DRIFT_V_PER_S: f64 = 5e-3;
/// A wedge that slips does so by this, degrees.
const SLIP_DEG: f64 = 3.0;

/// What is being played.
struct Playing {
    recording: SimulatedRecording,
    next: usize,
}

/// A run that is being computed.
struct Computing {
    number: Option<usize>,
    thread: JoinHandle<Result<SimulatedRecording, SessionError>>,
}

/// The laboratory on its thread.
pub struct LiveLaboratory {
    plan: SessionPlan,
    laboratory: Laboratory,
    converter: Converter,
    rest: Pcg64,
    planned: Vec<PlannedTrial>,
    computing: Option<Computing>,
    playing: Option<Playing>,
    runs: usize,
    defect: Option<Defect>,
    /// Samples since the defect was made.
    since: u64,
    speed: f64,
}

impl LiveLaboratory {
    /// At rest.
    pub fn new(settings: &Settings) -> Self {
        let plan = settings.plan();
        let laboratory = Laboratory::of_plan(&plan);
        Self {
            converter: laboratory.chain.converter(),
            rest: Pcg64::new(u128::from(plan.seed), REST_STREAM),
            planned: trials(&plan.rig, plan.trials_per_step, None),
            computing: None,
            playing: None,
            runs: 0,
            defect: None,
            since: 0,
            speed: 1.0,
            plan,
            laboratory,
        }
    }

    /// Works until the instrument is shut down. Samples are due by the clock; a command takes effect at once.
    pub fn run(mut self, commands: &Receiver<LabCommand>, sender: &Sender) {
        let start = Start {
            title: format!(
                "simulated laboratory, seed {}, {}",
                self.plan.seed,
                match self.plan.engine {
                    Engine::Mujoco => "MuJoCo",
                    Engine::Rigid => "rigid limbs",
                }
            ),
            sample_rate_hz: self.plan.sample_rate_hz,
            standards: true,
            truth: true,
        };
        if sender.send(Event::Start(start)).is_err() {
            return;
        }
        let mut last = Instant::now();
        let mut due = 0.0;
        loop {
            match commands.recv_timeout(TICK) {
                Ok(command) => {
                    if !self.obey(command, sender) {
                        return;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if !self.computed(sender) {
                return;
            }
            let now = Instant::now();
            // Between runs there is nothing to be in a hurry for.
            let speed = if self.playing.is_some() {
                self.speed
            } else {
                self.speed.min(1.0)
            };
            due += (now - last).as_secs_f64() * self.plan.sample_rate_hz * speed;
            last = now;
            // After a pause of the machine the clock is not chased.
            due = due.min(self.plan.sample_rate_hz * speed);
            while due >= 1.0 {
                let samples = (due as usize).min(LONGEST_BATCH);
                let batch = self.next(samples);
                due -= batch.samples() as f64;
                let ended = self.ended();
                if sender.send(Event::Samples(Box::new(batch))).is_err() {
                    return;
                }
                if ended {
                    self.playing = None;
                    due = 0.0;
                    if sender.send(Event::End { complete: true }).is_err() {
                        return;
                    }
                }
            }
        }
    }

    fn ended(&self) -> bool {
        let over = |playing: &Playing| playing.next >= playing.recording.voltage_v.len();
        self.playing.as_ref().is_some_and(over)
    }

    /// False when the instrument is gone.
    fn obey(&mut self, command: LabCommand, sender: &Sender) -> bool {
        match command {
            LabCommand::Speed(speed) => self.speed = speed,
            LabCommand::Defect(defect) => {
                self.defect = defect;
                self.since = 0;
            }
            LabCommand::Stop => {
                // What is being computed comes to its end and to nothing.
                self.computing = None;
                if self.playing.take().is_some() {
                    return sender.send(Event::End { complete: false }).is_ok();
                }
            }
            LabCommand::Trial(index) if self.stands() => {
                return match index.checked_sub(1) {
                    None => self.start_static(sender),
                    Some(moving) => match self.planned.get(moving).cloned() {
                        Some(trial) => self.start(&trial, Some(index), sender),
                        None => true,
                    },
                };
            }
            LabCommand::Run(free) if self.stands() => {
                let trial = self.free(&free);
                return self.start(&trial, None, sender);
            }
            LabCommand::Trial(_) | LabCommand::Run(_) => {
                let busy = "the rig is running; stop it first".to_owned();
                return sender.send(Event::Note(busy)).is_ok();
            }
        }
        true
    }

    fn stands(&self) -> bool {
        self.playing.is_none() && self.computing.is_none()
    }

    /// Begins the run that has been computed, if one has; false when the instrument is gone.
    fn computed(&mut self, sender: &Sender) -> bool {
        let done = |computing: &mut Computing| computing.thread.is_finished();
        let Some(Computing { number, thread }) = self.computing.take_if(done) else {
            return true;
        };
        match thread.join() {
            Ok(Ok(recording)) => self.begin(recording, number, sender),
            Ok(Err(error)) => sender
                .send(Event::Note(format!("the run cannot be simulated: {error}")))
                .is_ok(),
            Err(_) => sender
                .send(Event::Note("the run cannot be simulated".to_owned()))
                .is_ok(),
        }
    }

    /// A run that a person asks for.
    fn free(&self, free: &FreeRun) -> PlannedTrial {
        let mode = match free.motion {
            Motion::Linear => Mode::Linear,
            Motion::Angular => Mode::Angular,
            Motion::Compound => Mode::Compound,
        };
        let wedge = free.wedge.min(WEDGES.len() - 1);
        let rig = &self.plan.rig;
        let run = rig.run(mode, free.frequency_hz, WEDGES[wedge]);
        PlannedTrial {
            name: "free".to_owned(),
            role: Role::Validation,
            run: Run {
                slider_amplitude_m: run.slider_amplitude_m * free.amplitude,
                rotation_amplitude_rad: run.rotation_amplitude_rad * free.amplitude,
                steady_periods: (free.seconds * free.frequency_hz).round().max(1.0),
                ..run
            },
            wedge: Some(wedge),
            mounting: rig.mounting,
        }
    }

    fn start(&mut self, trial: &PlannedTrial, number: Option<usize>, sender: &Sender) -> bool {
        let gravity = trial.gravity_ground_m_s2();
        let stated = trial.run.direction_ground;
        let run = Run {
            direction_ground: match self.defect {
                Some(Defect::Slip {}) => {
                    let side = stated.any_orthonormal_vector();
                    (DQuat::from_axis_angle(side, SLIP_DEG.to_radians()) * stated).normalize()
                }
                _ => stated,
            },
            ..trial.run
        };
        self.runs += 1;
        let (plan, laboratory, runs) = (self.plan.clone(), self.laboratory, self.runs);
        let (name, role) = (trial.name.clone(), trial.role);
        let compute = move || {
            let simulated = plan.simulate(&run, &laboratory.sensor, gravity)?;
            Ok(SimulatedRecording {
                name,
                role,
                direction_ground: stated,
                gravity_ground_m_s2: gravity,
                ..laboratory.record(&simulated, runs)
            })
        };
        match Builder::new().name("run".to_owned()).spawn(compute) {
            Ok(thread) => {
                self.computing = Some(Computing { number, thread });
                true
            }
            Err(error) => sender
                .send(Event::Note(format!("the run cannot be simulated: {error}")))
                .is_ok(),
        }
    }

    fn start_static(&mut self, sender: &Sender) -> bool {
        let samples = (STATIC_S * self.plan.sample_rate_hz) as usize;
        let zero = self.laboratory.sensor.zero_drift_v;
        let rows = (0..samples).map(|_| zero.map(|u| self.converter.convert(u, &mut self.rest)));
        let voltage_v: Vec<[f64; LIMBS]> = rows.collect();
        let recording = SimulatedRecording {
            voltage_v,
            ..SimulatedRecording::of_nothing(
                "static",
                Role::Static,
                self.plan.sample_rate_hz,
                self.laboratory.chain.full_scale_v,
            )
        };
        self.begin(recording, Some(0), sender)
    }

    fn begin(
        &mut self,
        recording: SimulatedRecording,
        trial: Option<usize>,
        sender: &Sender,
    ) -> bool {
        let begin = Begin {
            entry: recording.entry(),
            gain_n_per_v: recording.gain_n_per_v,
            gravity_ground_m_s2: recording.gravity_ground_m_s2,
            trial,
        };
        self.playing = Some(Playing { recording, next: 0 });
        sender.send(Event::Begin(Box::new(begin))).is_ok()
    }

    /// The next samples: of the run as far as it goes, or at rest.
    fn next(&mut self, samples: usize) -> Batch {
        let mut batch = Batch::default();
        let at_rest = truth_of(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DQuat::IDENTITY);
        let zero = self.laboratory.sensor.zero_drift_v;
        for _ in 0..samples {
            let (mut row, standard, truth) = match &mut self.playing {
                Some(Playing { recording, next }) => {
                    let Some(row) = recording.voltage_v.get(*next) else {
                        break;
                    };
                    let reading = |readings: &Vec<f64>| readings.get(*next).copied().unwrap_or(0.0);
                    let standard = [
                        reading(&recording.accelerometer_m_s2),
                        reading(&recording.gyroscope_rad_s),
                    ];
                    let truth = recording.truth.get(*next).map_or(at_rest, |t| {
                        truth_of(
                            t.linear_ground_m_s2,
                            t.angular_ground_rad_s2,
                            t.rate_shell_rad_s,
                            t.attitude,
                        )
                    });
                    *next += 1;
                    (*row, standard, truth)
                }
                None => {
                    let row = zero.map(|u| self.converter.convert(u, &mut self.rest));
                    (row, [0.0; 2], at_rest)
                }
            };
            self.spoil(&mut row, &zero);
            batch.voltage_v.push(&row);
            batch.standard[0].push(standard[0]);
            batch.standard[1].push(standard[1]);
            batch.truth.push(truth);
        }
        batch
    }

    fn spoil(&mut self, row: &mut [f64; LIMBS], zero: &[f64; LIMBS]) {
        let full_scale_v = self.laboratory.chain.full_scale_v;
        match self.defect {
            Some(Defect::Dead { limb }) if (1..=LIMBS).contains(&limb) => {
                row[limb - 1] = self.converter.convert(zero[limb - 1], &mut self.rest);
            }
            Some(Defect::Drift { limb }) if (1..=LIMBS).contains(&limb) => {
                self.since += 1;
                let by_v = DRIFT_V_PER_S * self.since as f64 / self.plan.sample_rate_hz;
                let u = row[limb - 1] + by_v.min(0.1 * full_scale_v);
                row[limb - 1] = u.clamp(-full_scale_v, full_scale_v);
            }
            _ => {}
        }
    }
}

fn truth_of(a: DVec3, alpha: DVec3, w: DVec3, q: DQuat) -> [f64; TRUTH_NUMBERS] {
    [
        a.x, a.y, a.z, alpha.x, alpha.y, alpha.z, w.x, w.y, w.z, q.w, q.x, q.y, q.z,
    ]
}
