//! What becomes of nine voltages on their way through the instrument: stages, decoder, parity rows, and beside them the truth of a
//! simulated laboratory behind the same low-pass.
//!
//! The stages run forwards only and delay; motion, parity and truth are filed when they come out, so that they stand beside each
//! other and lag behind the voltages by [`Chain::delay_s`].

use std::collections::VecDeque;

use glam::DVec3;
use serde::Serialize;
use sixaxis_calibration::apply::conditioning_stream::{
    ConditioningConfig, ConditioningStream, LOW_PASS_ORDER, causal_delay_s,
};
use sixaxis_calibration::apply::voltages::Voltages;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::{LIMBS, SixAxis};
use sixaxis_recordings::session::{Outliers, Session};

use crate::board::Live;
use crate::columns::{COLUMNS, CONDITIONED, MOTION, PARITY, TRUTH, TRUTH_NUMBERS};
use crate::control::Stages;
use crate::decoding::{Config, LiveDecoder, sensor};

/// Hampel's test of the outlier stage: samples on either side, standard deviations.
const OUTLIERS: Outliers = Outliers {
    half_width: 5,
    sigmas: 5.0,
};
/// Time that the shown size of the parity rows is about, s.
const PARITY_S: f64 = 0.25;
/// An axis that moves less than this share of the largest of its three has no error relative to its peak.
const MOVES: f64 = 0.1;
/// Accelerations, m/s^2 and rad/s^2, below which nothing moves.
const STANDS_STILL: f64 = 1e-2;

/// What is to be decoded with.
pub struct Choice<'a> {
    /// Sensor and design.
    pub session: &'a Session,
    /// The calibration; none for the design's parameters.
    pub calibration: Option<&'a Calibration>,
    /// Gains in use, N/V.
    pub gain_n_per_v: [f64; LIMBS],
    /// Gravity in the sensor's axes at rest, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Whether the fault monitor is wanted.
    pub watch: bool,
}

/// How far an axis has been from the truth in a run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct AxisError {
    /// Largest departure, m/s^2 or rad/s^2.
    pub departure: f64,
    /// The same over the axis' peak; none for an axis that the run does not move.
    pub share: Option<f64>,
}

/// Stages and decoder.
pub struct Chain {
    conditioning: Option<ConditioningStream>,
    /// Delay of the low-pass, s.
    delay_s: f64,
    sample_rate_hz: f64,
    received: Voltages,
    ready: Voltages,
    truths: VecDeque<Option<[f64; TRUTH_NUMBERS]>>,
    /// The low-pass of the truth, one state for each acceleration.
    filter: Option<Vec<SectionsState>>,
    decoder: Option<LiveDecoder>,
    /// Means at the last rest, V: the zeros where the design is decoded with.
    pub zero_v: Option<[f64; LIMBS]>,
    answer: Option<SixAxis>,
    conditioned: [f64; LIMBS],
    truth: Option<[f64; TRUTH_NUMBERS]>,
    filtered: Option<[f64; 6]>,
    parity_squares: [f64; 3],
    peaks: [f64; 6],
    departures: [f64; 6],
    last_errors: Option<[AxisError; 6]>,
    /// Whether departures are counted: an open loop drifts on when the run is over.
    counting: bool,
    messages: Vec<String>,
}

impl Chain {
    /// Without stages and decoder.
    #[must_use]
    pub fn idle() -> Self {
        Self {
            conditioning: None,
            delay_s: 0.0,
            sample_rate_hz: 1.0,
            received: Voltages::default(),
            ready: Voltages::default(),
            truths: VecDeque::new(),
            filter: None,
            decoder: None,
            zero_v: None,
            answer: None,
            conditioned: [0.0; LIMBS],
            truth: None,
            filtered: None,
            parity_squares: [0.0; 3],
            peaks: [0.0; 6],
            departures: [0.0; 6],
            last_errors: None,
            counting: true,
            messages: Vec::new(),
        }
    }

    /// Begins with other stages; `delays_s` are those of the channels against the clock.
    ///
    /// # Errors
    /// Corners that the sample rate does not allow; the stages are then off.
    pub fn condition(
        &mut self,
        stages: &Stages,
        delays_s: Option<[f64; LIMBS]>,
        sample_rate_hz: f64,
    ) -> anyhow::Result<()> {
        self.conditioning = None;
        self.filter = None;
        self.sample_rate_hz = sample_rate_hz;
        self.delay_s = 0.0;
        self.truths.clear();
        self.ready.clear();
        let config = ConditioningConfig {
            delays_s,
            outliers: stages.outliers.then_some(OUTLIERS),
            amplifier_high_pass_hz: stages.high_pass_hz,
            low_pass_hz: stages.low_pass_hz,
            causal: true,
            ..ConditioningConfig::default()
        };
        self.conditioning = Some(ConditioningStream::new(&config, sample_rate_hz)?);
        if let Some(corner_hz) = stages.low_pass_hz {
            let sections = butterworth::low_pass(LOW_PASS_ORDER, corner_hz, sample_rate_hz)?;
            self.filter = Some((0..6).map(|_| SectionsState::at_rest(&sections)).collect());
            self.delay_s = causal_delay_s(corner_hz);
        }
        Ok(())
    }

    /// Decodes from rest, with shell axes along the ground's.
    ///
    /// # Errors
    /// Those of [`LiveDecoder::new`]; nothing is decoded then.
    pub fn restart(&mut self, choice: &Choice<'_>) -> anyhow::Result<()> {
        self.last_errors = self.errors();
        (self.peaks, self.departures) = ([0.0; 6], [0.0; 6]);
        self.counting = true;
        (self.decoder, self.answer, self.filtered) = (None, None, None);
        let card = &choice.session.sensor;
        let mut design = card.design();
        design.zero_drift_v = self.zero_v.unwrap_or_default();
        self.decoder = Some(LiveDecoder::new(&Config {
            sensor: sensor(card.geometry(), choice.gain_n_per_v),
            design,
            calibration: choice.calibration,
            gravity_ground_m_s2: choice.gravity_ground_m_s2,
            sample_rate_hz: self.sample_rate_hz,
            watch: choice.watch,
        })?);
        Ok(())
    }

    /// Takes a sample and fills in what comes out of the stages with it.
    pub fn push(
        &mut self,
        voltage_v: &[f64; LIMBS],
        truth: Option<&[f64; TRUTH_NUMBERS]>,
        row: &mut [f32; COLUMNS],
    ) {
        let Some(conditioning) = &mut self.conditioning else {
            return;
        };
        self.received.push(voltage_v);
        self.truths.push_back(truth.copied());
        conditioning.push(&mut self.received, &mut self.ready);
        for sample in 0..self.ready.samples() {
            let conditioned = self.ready.row(sample);
            let truth = self.truths.pop_front().flatten();
            self.sample(&conditioned, truth, row);
        }
        self.ready.clear();
    }

    fn sample(
        &mut self,
        conditioned: &[f64; LIMBS],
        truth: Option<[f64; TRUTH_NUMBERS]>,
        row: &mut [f32; COLUMNS],
    ) {
        self.conditioned = *conditioned;
        for (cell, u) in row[CONDITIONED].iter_mut().zip(conditioned) {
            *cell = *u as f32;
        }
        // The decoder answers the sample before.
        let before = self.filtered;
        self.truth = truth;
        self.filtered = truth.map(|truth| self.filtered_truth(&truth));
        if let Some(before) = before {
            for (cell, value) in row[TRUTH].iter_mut().zip(before) {
                *cell = value as f32;
            }
        }
        let Some(decoder) = &mut self.decoder else {
            return;
        };
        let parity = decoder.parity_m_s2(conditioned);
        let share = 1.0 / (PARITY_S * self.sample_rate_hz).max(1.0);
        for ((cell, value), squares) in row[PARITY]
            .iter_mut()
            .zip(parity)
            .zip(&mut self.parity_squares)
        {
            *cell = value as f32;
            if value.is_finite() {
                *squares += share * (value * value - *squares);
            }
        }
        self.answer = decoder.push(conditioned);
        self.messages.append(&mut decoder.messages);
        if let Some(answer) = &self.answer {
            let numbers = answer.numbers();
            for (cell, value) in row[MOTION].iter_mut().zip(numbers) {
                *cell = value as f32;
            }
            if let Some(before) = before.filter(|_| self.counting) {
                for (k, (value, truth)) in numbers.iter().zip(before).enumerate() {
                    self.peaks[k] = self.peaks[k].max(truth.abs());
                    self.departures[k] = self.departures[k].max((value - truth).abs());
                }
            }
        }
    }

    fn filtered_truth(&mut self, truth: &[f64; TRUTH_NUMBERS]) -> [f64; 6] {
        match &mut self.filter {
            Some(states) => {
                let mut filtered = [0.0; 6];
                for ((out, state), value) in filtered.iter_mut().zip(states).zip(truth) {
                    *out = state.step(*value);
                }
                filtered
            }
            None => core::array::from_fn(|k| truth[k]),
        }
    }

    /// The run is over: its errors stay as they are.
    pub const fn run_ended(&mut self) {
        self.counting = false;
    }

    /// Errors since the run began; of the last run while the sensor rests.
    #[must_use]
    pub fn errors(&self) -> Option<[AxisError; 6]> {
        let largest = [0, 3].map(|first| {
            self.peaks[first..first + 3]
                .iter()
                .copied()
                .fold(0.0, f64::max)
        });
        if largest[0] < STANDS_STILL && largest[1] < STANDS_STILL {
            return self.last_errors;
        }
        Some(core::array::from_fn(|k| {
            let (departure, peak, largest) = (self.departures[k], self.peaks[k], largest[k / 3]);
            let moves = largest >= STANDS_STILL && peak >= MOVES * largest;
            AxisError {
                departure,
                share: moves.then(|| departure / peak),
            }
        }))
    }

    /// Time by which the stages delay, s: of the low-pass, and of the samples that they hold back.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.delay_s + self.truths.len() as f64 / self.sample_rate_hz
    }

    /// Root mean squares of the parity rows, m/s^2.
    #[must_use]
    pub fn parity_rms(&self) -> [f64; 3] {
        self.parity_squares.map(f64::sqrt)
    }

    /// Excluded and suspected limbs as digits.
    #[must_use]
    pub fn flags(&self) -> [f64; 2] {
        self.decoder
            .as_ref()
            .map_or([0.0; 2], |decoder| decoder.flags)
    }

    /// What the decoder has said since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// The newest pose.
    #[must_use]
    pub fn live(&self) -> Live {
        let attitude = self.answer.map_or([1.0, 0.0, 0.0, 0.0], |answer| {
            let q = answer.attitude;
            [q.w, q.x, q.y, q.z]
        });
        let pose = self
            .decoder
            .as_ref()
            .map(|decoder| decoder.pose(&self.conditioned))
            .unwrap_or_default();
        Live {
            attitude,
            true_attitude: self.truth.map(|t| [t[9], t[10], t[11], t[12]]),
            position_m: pose.position_shell_m.to_array(),
            rotation_rad: pose.rotation_rad.to_array(),
            arrived: None,
        }
    }
}
