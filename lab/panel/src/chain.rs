//! What becomes of nine voltages on their way through the instrument: stages, decoder, parity rows, and beside them the truth of a
//! simulated laboratory and the reference instruments' readings behind the same low-pass.
//!
//! The stages run forwards only and delay; motion, parity, truth and readings are filed when they come out, so that they stand beside each
//! other and lag behind the voltages by [`Chain::delay_s`].

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use sixaxis_calibration::apply::conditioning_stream::{LOW_PASS_ORDER, causal_delay_s};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::dsp::lag::FirstOrder;
use sixaxis_core::{LIMBS, SixAxis};
use sixaxis_recordings::session::Session;

use crate::board::Live;
use crate::columns::{
    ALONG, COLUMNS, CONDITIONED, FELT, MOTION, PARITY, STANDARD_BEHIND, TRULY_FELT, TRUTH,
    TRUTH_NUMBERS,
};
use crate::control::Stages;
use crate::decoding::{Config, LiveDecoder, sensor};
use crate::departures::{AxisError, Departures};
use crate::stages::{Conditioning, Ready};

/// Time that the shown size of the parity rows is about, s.
const PARITY_S: f64 = 0.25;

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
    /// Unit vector along which the rig travels and about which it turns, the instruments' axis; none while nobody says.
    pub direction: Option<DVec3>,
    /// Whether the fault monitor is wanted.
    pub watch: bool,
}

/// What stands beside a sample.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beside {
    /// The true motion.
    pub truth: Option<[f64; TRUTH_NUMBERS]>,
    /// Readings of accelerometer, m/s^2, and gyroscope, rad/s.
    pub standard: Option<[f64; 2]>,
}

/// The same behind the low-pass.
#[derive(Debug, Clone, Copy, Default)]
struct Behind {
    /// True accelerations in ground and in sensor axes.
    truth: Option<[[f64; 6]; 2]>,
    standard: Option<[f64; 2]>,
}

/// States of the low-pass for [`Behind`]: twelve accelerations, two readings.
const BEHIND: usize = 14;

/// Accelerations as a tared sensor feels them in its own axes, from those in ground axes.
fn in_sensor_axes(ground: &[f64; 6], attitude: DQuat, gravity_ground_m_s2: DVec3) -> [f64; 6] {
    let [linear, angular] = [0, 3].map(|first| DVec3::from_slice(&ground[first..first + 3]));
    let back = attitude.inverse();
    let felt = back * (linear - gravity_ground_m_s2) + gravity_ground_m_s2;
    let pair = [felt, back * angular];
    core::array::from_fn(|k| pair[k / 3][k % 3])
}

/// Files numbers as a history keeps them.
fn file(cells: &mut [f32], numbers: &[f64]) {
    for (cell, number) in cells.iter_mut().zip(numbers) {
        *cell = *number as f32;
    }
}

/// Stages and decoder.
pub struct Chain {
    conditioning: Option<Conditioning>,
    /// Delay of the low-pass, s.
    delay_s: f64,
    sample_rate_hz: f64,
    beside: VecDeque<Beside>,
    /// The low-pass of what stands beside the samples.
    filter: Option<Vec<SectionsState>>,
    decoder: Option<LiveDecoder>,
    /// Samples that the stages have answered, and whether the decoder knows how zeros wander behind them.
    conditioned_samples: u64,
    knows_wander: bool,
    /// Means at the last rest, V: the zeros where the design is decoded with.
    pub zero_v: Option<[f64; LIMBS]>,
    answer: Option<SixAxis>,
    conditioned: [f64; LIMBS],
    truth: Option<[f64; TRUTH_NUMBERS]>,
    behind: Behind,
    parity_squares: [f64; 3],
    /// From the truth in ground and in sensor axes.
    departures: [Departures<6>; 2],
    last_errors: Option<[[AxisError; 6]; 2]>,
    /// From the instruments along and about the direction.
    from_standards: Departures<2>,
    last_from_standards: Option<[AxisError; 2]>,
    gravity_ground_m_s2: DVec3,
    direction: Option<DVec3>,
    /// The instruments' own first-order bandwidths, so that what is decoupled along their axis is as slow as they are.
    bandwidths: [Option<FirstOrder>; 2],
    /// Whether departures are counted: an open loop drifts on when the run is over.
    counting: bool,
    messages: Vec<String>,
}

impl Chain {
    /// Without stages and decoder.
    pub fn idle() -> Self {
        Self {
            conditioning: None,
            delay_s: 0.0,
            sample_rate_hz: 1.0,
            beside: VecDeque::new(),
            filter: None,
            decoder: None,
            conditioned_samples: 0,
            knows_wander: false,
            zero_v: None,
            answer: None,
            conditioned: [0.0; LIMBS],
            truth: None,
            behind: Behind::default(),
            parity_squares: [0.0; 3],
            departures: Default::default(),
            last_errors: None,
            from_standards: Departures::default(),
            last_from_standards: None,
            gravity_ground_m_s2: DVec3::ZERO,
            direction: None,
            bandwidths: [None; 2],
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
        self.beside.clear();
        self.conditioned_samples = 0;
        self.conditioning = Some(Conditioning::new(stages, delays_s, sample_rate_hz)?);
        if let Some(corner_hz) = stages.low_pass_hz {
            let sections = butterworth::low_pass(LOW_PASS_ORDER, corner_hz, sample_rate_hz)?;
            self.filter = Some(vec![SectionsState::at_rest(&sections); BEHIND]);
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
        self.last_from_standards = self.errors_of_standards();
        self.departures = Default::default();
        self.from_standards = Departures::default();
        self.gravity_ground_m_s2 = choice.gravity_ground_m_s2;
        self.direction = choice.direction;
        let Session {
            accelerometer,
            gyroscope,
            ..
        } = choice.session;
        self.bandwidths = [accelerometer.bandwidth_hz, gyroscope.bandwidth_hz].map(|hz| {
            let corner_hz = hz.filter(|hz| *hz < 0.5 * self.sample_rate_hz)?;
            FirstOrder::low_pass(corner_hz, self.sample_rate_hz).ok()
        });
        self.counting = true;
        self.knows_wander = false;
        (self.decoder, self.answer, self.behind) = (None, None, Behind::default());
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
    pub fn push(&mut self, voltage_v: &[f64; LIMBS], beside: Beside, row: &mut [f32; COLUMNS]) {
        if let Some(conditioning) = &mut self.conditioning {
            conditioning.push(voltage_v);
            self.beside.push_back(beside);
        }
        while let Some(ready) = self.conditioning.as_mut().and_then(Conditioning::pop) {
            let beside = self.beside.pop_front().unwrap_or_default();
            self.sample(&ready, beside, row);
        }
    }

    fn sample(&mut self, ready: &Ready, beside: Beside, row: &mut [f32; COLUMNS]) {
        let conditioned = &ready.row;
        self.conditioned = *conditioned;
        file(&mut row[CONDITIONED], conditioned);
        let answered = self.conditioned_samples;
        self.conditioned_samples += 1;
        // The decoder answers the sample before.
        let before = self.behind;
        self.truth = beside.truth;
        self.behind = self.filtered(&beside);
        if let Some([ground, sensor]) = &before.truth {
            file(&mut row[TRUTH], ground);
            file(&mut row[TRULY_FELT], sensor);
        }
        if let Some(standard) = &before.standard {
            file(&mut row[STANDARD_BEHIND], standard);
        }
        let Some(decoder) = &mut self.decoder else {
            return;
        };
        let parity = decoder.parity_m_s2(conditioned);
        let share = 1.0 / (PARITY_S * self.sample_rate_hz).max(1.0);
        file(&mut row[PARITY], &parity);
        for (value, squares) in parity.into_iter().zip(&mut self.parity_squares) {
            if value.is_finite() {
                *squares += share * (value * value - *squares);
            }
        }
        if !self.knows_wander {
            self.knows_wander = true;
            let wander = (self.conditioning.as_ref()).and_then(Conditioning::zero_wander);
            wander
                .into_iter()
                .for_each(|wander| decoder.allow_for(wander, answered));
        }
        self.answer = decoder.push(ready);
        self.messages.append(&mut decoder.messages);
        if let Some(answer) = &self.answer {
            let numbers = answer.numbers();
            file(&mut row[MOTION], &numbers);
            let ground: [f64; 6] = core::array::from_fn(|k| numbers[k]);
            let sensor = in_sensor_axes(&ground, answer.attitude, self.gravity_ground_m_s2);
            file(&mut row[FELT], &sensor);
            // A rig's direction is the same in ground and in shell axes: it is what the shell turns about.
            let along = self.direction.map(|n| {
                let rate = DVec3::from_slice(&numbers[6..9]);
                let mut along = [DVec3::from_slice(&sensor[..3]).dot(n), rate.dot(n)];
                for (value, bandwidth) in along.iter_mut().zip(&mut self.bandwidths) {
                    *value = bandwidth.as_mut().map_or(*value, |b| b.step(*value));
                }
                along
            });
            if let Some(along) = &along {
                file(&mut row[ALONG], along);
            }
            if !self.counting {
                return;
            }
            if let Some(truth) = &before.truth {
                for (departures, (value, truth)) in self
                    .departures
                    .iter_mut()
                    .zip([ground, sensor].iter().zip(truth))
                {
                    departures.push(value, truth);
                }
            }
            if let (Some(along), Some(standard)) = (along, before.standard) {
                self.from_standards.push(&along, &standard);
            }
        }
    }

    fn filtered(&mut self, beside: &Beside) -> Behind {
        let mut truth = beside.truth.map(|truth| {
            let ground: [f64; 6] = core::array::from_fn(|k| truth[k]);
            let attitude = DQuat::from_xyzw(truth[10], truth[11], truth[12], truth[9]);
            [
                ground,
                in_sensor_axes(&ground, attitude, self.gravity_ground_m_s2),
            ]
        });
        let mut standard = beside.standard;
        if let Some((of_truth, of_standard)) = self
            .filter
            .as_mut()
            .and_then(|states| states.split_at_mut_checked(BEHIND - 2))
        {
            let truths = truth.iter_mut().flatten().flatten().zip(of_truth);
            let readings = standard.iter_mut().flatten().zip(of_standard);
            for (value, state) in truths.chain(readings) {
                *value = state.step(*value);
            }
        }
        Behind { truth, standard }
    }

    /// The run is over: its errors stay as they are.
    pub const fn run_ended(&mut self) {
        self.counting = false;
    }

    /// Errors since the run began, in ground axes and in sensor axes; of the last run while the sensor rests.
    pub fn errors(&self) -> Option<[[AxisError; 6]; 2]> {
        match self.departures.each_ref().map(Departures::errors) {
            [Some(ground), Some(sensor)] => Some([ground, sensor]),
            _ => self.last_errors,
        }
    }

    /// Departures from the reference instruments in this run, along the direction and about it; of the last run while the sensor rests.
    pub fn errors_of_standards(&self) -> Option<[AxisError; 2]> {
        self.from_standards.errors().or(self.last_from_standards)
    }

    /// Time by which the stages delay, s: of the low-pass, and of the samples that they hold back.
    pub fn delay_s(&self) -> f64 {
        self.delay_s + self.beside.len() as f64 / self.sample_rate_hz
    }

    /// Root mean squares of the parity rows, m/s^2.
    pub fn parity_rms(&self) -> [f64; 3] {
        self.parity_squares.map(f64::sqrt)
    }

    /// Excluded and suspected limbs as digits.
    pub fn flags(&self) -> [f64; 2] {
        self.decoder
            .as_ref()
            .map_or([0.0; 2], |decoder| decoder.flags)
    }

    /// Whether nothing is decoded before the next start.
    pub fn has_stopped(&self) -> bool {
        self.decoder.as_ref().is_some_and(LiveDecoder::has_stopped)
    }

    /// What the decoder has said since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// The newest pose.
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
