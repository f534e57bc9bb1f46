//! What the acquisition does at a command.

use sixaxis_core::LIMBS;

use super::Acquisition;
use crate::control::{FileFormat, LabCommand, Message};
use crate::day::Job;
use crate::recorder::{self, Recorder};
use crate::source::Begin;

impl Acquisition {
    /// Does it.
    pub(super) fn obey(&mut self, message: Message) {
        match message {
            // The server has answered them.
            Message::View(_) | Message::Seen { .. } | Message::Take {} | Message::Release {} => {}
            Message::Run { run } => self.laboratory(LabCommand::Run(run)),
            Message::Stop {} => self.laboratory(LabCommand::Stop),
            Message::Defect { defect } => self.laboratory(LabCommand::Defect(defect)),
            Message::Speed { speed } => self.laboratory(LabCommand::Speed(speed)),
            Message::Record { name, format } => self.record(&name, format),
            Message::StopRecording {} => self.stop_recording(),
            Message::Stages { stages } => {
                self.stages = stages;
                self.rebuild();
            }
            Message::Parameters { parameters } => {
                self.choice = parameters;
                self.restart();
            }
            Message::Watch { on } => {
                self.watch = on;
                self.restart();
            }
            Message::Restart {} => {
                if !self.statistics.at_rest {
                    self.note("started from rest where the channels do not rest: zeros are what they showed on average".to_owned());
                }
                self.chain.zero_v = Some(self.statistics.channels.map(|c| c.mean_v));
                self.restart();
            }
            Message::Capture { trial, done } => self.by_hand(trial, done),
            Message::Discard { trial } => {
                let _ = self.setup.day.send(Job::Discard(trial));
            }
            Message::ClearCounts {} => self.statistics.clear_counts(),
        }
    }

    /// Ends the recording, if one is under way.
    pub(super) fn stop_recording(&mut self) {
        if let Some(recorder) = &mut self.recorder {
            recorder.stop();
        }
    }

    fn laboratory(&mut self, command: LabCommand) {
        match &self.setup.laboratory {
            None => self.note("the source is no simulated laboratory".to_owned()),
            // Its queue is drained many times a second; a browser that fills it all the same is not waited for.
            Some(laboratory) => {
                if laboratory.try_send(command).is_err() {
                    self.note("the simulated laboratory does not listen".to_owned());
                }
            }
        }
    }

    fn record(&mut self, name: &str, format: FileFormat) {
        if self
            .recorder
            .as_ref()
            .is_some_and(|r| r.progress().finished.is_none() && r.progress().failed.is_none())
        {
            self.note("a recording is under way".to_owned());
            return;
        }
        let names: Vec<String> = (1..=LIMBS).map(|i| format!("u{i}")).collect();
        let mut columns: Vec<(&str, &str)> =
            names.iter().map(|name| (name.as_str(), "V")).collect();
        if self.start.standards {
            columns.extend([("accelerometer", "m/s^2"), ("gyroscope", "rad/s")]);
        }
        let head = recorder::head(&columns, self.start.sample_rate_hz, format);
        match Recorder::start(&self.setup.out, name, head) {
            Ok(recorder) => self.recorder = Some(recorder),
            Err(error) => self.note(error.to_string()),
        }
    }

    /// A trial from hardware, or the rig's of the simulated laboratory.
    fn by_hand(&mut self, trial: usize, done: bool) {
        if self.setup.laboratory.is_some() {
            self.laboratory(if done {
                LabCommand::Stop
            } else {
                LabCommand::Trial(trial)
            });
            return;
        }
        if done {
            self.end(true);
            return;
        }
        let Some(entry) = self.setup.session.recording.get(trial).cloned() else {
            self.note("the session has no such recording".to_owned());
            return;
        };
        self.begin(Begin::of(&self.setup.session, entry, Some(trial)));
    }
}
