//! The simulated laboratory: what it would have on disk of a calibration day and, kept apart, the truth.
//!
//! [`Laboratory`] turns a simulated motion into a recording: limb forces through the measuring [`chain`], the true motion
//! through the reference [`instruments`]. It is the only place where that is done. A [`session`] is a whole day of it, with
//! everything that goes with a day:
//!
//! | module | holds |
//! |---|---|
//! | `continuous` | a sampled signal between its samples: analogue filters, other clocks |
//! | [`plan`] | what is simulated, and [`plan_file`], the plan as TOML with comments |
//! | [`check`] | the plans that are refused |
//! | [`schedule`] | the trials that a plan asks for |
//! | `mount` | how the sensor truly stands on each wedge |
//! | [`channels`] | what the channels show of the limb forces at an hour of the day |
//! | [`defect`] | what may be wrong with a session, and `spoil`, how it acts |
//! | [`room`] | the gentle and the usual room |
//! | `trial`, `tap`, [`mod@tumble`] | one trial of the rig, one tap, one tumble from the field |
//! | [`session`] | all trials of a day |
//! | [`session_file`] | what the laboratory writes down of it |
//! | [`mod@write`] | all of it on disk |

pub mod chain;
pub mod channels;
pub mod check;
mod continuous;
pub mod defect;
pub mod error;
pub mod instruments;
mod mount;
pub mod plan;
pub mod plan_file;
pub mod recording;
pub mod room;
pub mod schedule;
pub mod session;
pub mod session_file;
mod spoil;
mod tap;
mod trial;
pub mod tumble;
pub mod write;

use glam::DVec3;
use rand_pcg::Pcg64;
use serde::Serialize;
use sixaxis_recordings::session::Role;

use crate::geometry::LIMBS;
use crate::motion::{SimulatedRun, TrueMotion};
use crate::sensor::TrueSensor;
use chain::Chain;
use instruments::Instruments;
use recording::SimulatedRecording;

/// Length of the static record, s, and its rate after preprocessing, Hz: the paper's ten minutes.
pub const STATIC_DURATION_S: f64 = 600.0;
/// See [`STATIC_DURATION_S`].
pub const STATIC_RATE_HZ: f64 = 100.0;
/// Gain of the static record, N/V: nothing is measured there but voltages.
const STATIC_GAIN_N_PER_V: f64 = 1.0;

/// Random streams of a laboratory by itself; a session has its own. Runs use their index plus [`FIRST_RUN_STREAM`].
const INSTRUMENT_STREAM: u128 = 1;
const STATIC_STREAM: u128 = 2;
const FIRST_RUN_STREAM: u128 = 16;

/// A laboratory: the sensor on its rig, the measuring chain of its nine channels and the reference instruments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Laboratory {
    /// The sensor as it truly is.
    pub sensor: TrueSensor,
    /// Measuring chain of the nine channels.
    pub chain: Chain,
    /// Reference instruments.
    pub instruments: Instruments,
    /// Seed of every random number.
    pub seed: u64,
}

impl Laboratory {
    /// A laboratory without errors.
    pub const fn noise_free(sensor: TrueSensor) -> Self {
        Self {
            sensor,
            chain: Chain::noise_free(),
            instruments: Instruments::perfect(),
            seed: 0,
        }
    }

    /// A laboratory with the paper's instruments and this project's channels: 60 dB, instruments of the 1 % class, 10 Hz gyroscope.
    pub fn with_errors(sensor: TrueSensor, seed: u64) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), INSTRUMENT_STREAM);
        Self {
            sensor,
            chain: Chain::laboratory(),
            instruments: Instruments::of_class(&mut rng),
            seed,
        }
    }

    /// The healthy laboratory of a plan: its sensor, measuring chain and instruments.
    pub fn of_plan(plan: &plan::SessionPlan) -> Self {
        Self {
            sensor: plan.true_sensor(),
            chain: plan.measuring_chain(),
            instruments: plan.true_instruments(),
            seed: plan.seed,
        }
    }

    /// The paper's ten minutes at rest.
    pub fn record_static(&self) -> SimulatedRecording {
        let mut rng = Pcg64::new(u128::from(self.seed), STATIC_STREAM);
        let drift = self.sensor.zero_drift_v;
        self.record_at_rest(STATIC_DURATION_S, STATIC_RATE_HZ, |_| drift, &mut rng)
    }

    /// A record at rest: a tared channel of a sensor that does not move shows its zero drift, V, and noise. The drift is asked
    /// for at each share of the record, from 0 to 1.
    fn record_at_rest(
        &self,
        duration_s: f64,
        rate_hz: f64,
        drift_v: impl Fn(f64) -> [f64; LIMBS],
        rng: &mut Pcg64,
    ) -> SimulatedRecording {
        let converter = self.chain.converter();
        let samples = (duration_s * rate_hz) as usize;
        let row = |sample| drift_v(sample as f64 / samples as f64);
        SimulatedRecording {
            voltage_v: (0..samples)
                .map(|sample| row(sample).map(|voltage_v| converter.convert(voltage_v, rng)))
                .collect(),
            ..SimulatedRecording::of_nothing(
                "static",
                Role::Static,
                rate_hz,
                self.chain.full_scale_v,
            )
        }
    }

    /// Records one simulated run. `index` picks the random stream, so that a run's noise does not depend on which runs were
    /// recorded before it. The recording has no name and is one for validation until its owner says otherwise.
    pub fn record(&self, simulated: &SimulatedRun, index: usize) -> SimulatedRecording {
        let mut rng = Pcg64::new(u128::from(self.seed), FIRST_RUN_STREAM + index as u128);
        let forces = &simulated.limb_force_per_mass_m_s2;
        let mut recording = self.record_voltages(simulated, forces, &mut rng);
        self.read_instruments(simulated, &mut recording, &mut rng);
        recording
    }

    /// The voltages of a run of which the channels sense these forces per mass, m/s^2, in amplifier ranges that fit the true
    /// ones; the instruments are still to be read.
    fn record_voltages(
        &self,
        simulated: &SimulatedRun,
        sensed: &[[f64; LIMBS]],
        rng: &mut Pcg64,
    ) -> SimulatedRecording {
        let forces = &simulated.limb_force_per_mass_m_s2;
        let full_scale_v = self.chain.full_scale_v;
        let rate = simulated.sample_rate_hz;
        let gains = self.chain.amplifier_ranges(forces, &self.sensor);
        SimulatedRecording {
            gain_n_per_v: gains,
            voltage_v: self.chain.record(sensed, &self.sensor, &gains, rate, rng),
            direction_ground: simulated.motion.direction_ground,
            gravity_ground_m_s2: simulated.gravity_ground_m_s2,
            true_gravity_ground_m_s2: simulated.gravity_ground_m_s2,
            frequency_hz: simulated.motion.frequency_hz,
            ..SimulatedRecording::of_nothing("", Role::Validation, rate, full_scale_v)
        }
    }

    /// Adds the instruments' readings of a run along its true direction, and the truth.
    fn read_instruments(
        &self,
        simulated: &SimulatedRun,
        recording: &mut SimulatedRecording,
        rng: &mut Pcg64,
    ) {
        let along = |get: fn(&TrueMotion) -> DVec3| -> Vec<f64> {
            let direction = simulated.motion.direction_ground;
            let truth = simulated.truth.iter();
            truth.map(|truth| get(truth).dot(direction)).collect()
        };
        let acceleration = along(|truth| truth.linear_ground_m_s2);
        let rate = along(|truth| truth.rate_shell_rad_s);
        recording.accelerometer_m_s2 = self.instruments.read_accelerometer(&acceleration, rng);
        recording.gyroscope_rad_s =
            self.instruments
                .read_gyroscope(&rate, simulated.sample_rate_hz, rng);
        recording.truth.clone_from(&simulated.truth);
    }
}
