//! What all browsers are told of the acquisition.

use std::time::Instant;

use serde::Serialize;
use sixaxis_core::LIMBS;

use super::Acquisition;
use crate::board::{Post, locked};
use crate::control::{Parameters, Stages};
use crate::departures::AxisError;
use crate::recorder::{Progress, Recorder};
use crate::source::Start;
use crate::statistics::Channel;

/// What all browsers are told five times a second.
#[derive(Debug, Clone, Serialize)]
struct Status<'a> {
    start: &'a Start,
    samples: u64,
    kept_s: f64,
    received_per_s: f64,
    channels: &'a [Channel; LIMBS],
    conditioned_deviation_v: [f64; LIMBS],
    full_scale_v: f64,
    at_rest: bool,
    run: Option<String>,
    trial: Option<usize>,
    gains_n_per_v: [f64; LIMBS],
    stages: Stages,
    delay_s: f64,
    parameters: Parameters,
    available: [bool; 3],
    watch: bool,
    watched: [f64; 2],
    errors: Option<[[AxisError; 6]; 2]>,
    errors_of_standards: Option<[AxisError; 2]>,
    parity_rms: [f64; 3],
    recording: Option<Progress>,
    notes: Vec<(u64, String)>,
    laboratory: bool,
}

impl Acquisition {
    /// Puts up the newest status.
    pub(super) fn tell(&mut self) {
        let (since, samples, _) = self.rate;
        let elapsed = since.elapsed().as_secs_f64();
        if elapsed >= 1.0 {
            self.rate = (Instant::now(), 0, samples as f64 / elapsed);
        }
        let history = locked(&self.board.history);
        let (count, kept_s) = (history.count(), history.kept_s);
        drop(history);
        let run = self
            .begin
            .as_ref()
            .map(|begin| begin.entry.file.display().to_string());
        let status = Status {
            start: &self.start,
            samples: count,
            kept_s,
            received_per_s: self.rate.2,
            channels: &self.statistics.channels,
            conditioned_deviation_v: self.conditioned.channels.map(|c| c.deviation_v),
            full_scale_v: self.setup.session.sensor.full_scale_v,
            at_rest: self.statistics.at_rest,
            run,
            trial: self.capture.as_ref().map(|(trial, _)| *trial),
            gains_n_per_v: self.chosen().gain_n_per_v,
            stages: self.stages,
            delay_s: self.chain.delay_s(),
            parameters: self.choice,
            available: [
                true,
                self.setup.calibration.is_some(),
                self.day_calibration.is_some(),
            ],
            watch: self.watch,
            watched: if self.held() {
                [0.0; 2]
            } else {
                self.chain.flags()
            },
            errors: self.chain.errors(),
            errors_of_standards: self.chain.errors_of_standards(),
            parity_rms: self.chain.parity_rms(),
            recording: self.recorder.as_ref().map(Recorder::progress),
            notes: self.notes.clone(),
            laboratory: self.setup.laboratory.is_some(),
        };
        if let Ok(text) = serde_json::to_string(&serde_json::json!({ "status": &status })) {
            self.board.post(Post::Status, text);
        }
    }
}
