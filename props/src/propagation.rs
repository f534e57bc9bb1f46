//! Campaigns by the ten thousand, to hold the closed-form propagation of errors against: the paper's plan, played once,
//! recorded with fresh errors as often as wanted, calibrated by the four steps each time.
//!
//! Steps 2 and 3 and the compound runs are played with limbs that do not give way, in closed form; step 4 in MuJoCo, since it
//! identifies what gives way. Everything that a draw adds is normal and white: what the propagation claims to know.

pub mod monte_carlo;

use crate::truth;
use crate::truth::InCore;
use glam::DVec3;
use nalgebra::SVector;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioning;
use sixaxis_calibration::propagation::{Sources, TrialNoise};
use sixaxis_calibration::steps::Campaign;
use sixaxis_calibration::trial::Trial;
use sixaxis_core::decouple::decouple;
use sixaxis_core::identify::zero_drift;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{Geometry, LIMBS, Parameters, Scheme, SixAxis};
use sixaxis_recordings::session::{Preprocessing, Role};
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::laboratory::instruments::{GYROSCOPE_BANDWIDTH_HZ, Instruments};
use sixaxis_reference::laboratory::plan::RigPlan;
use sixaxis_reference::laboratory::schedule::{compound_trials, trials};
use sixaxis_reference::laboratory::{Laboratory, STATIC_DURATION_S, STATIC_RATE_HZ};
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::rigid::RigidSensor;
use sixaxis_reference::sensor::TrueSensor;

use crate::compare::largest;

/// Ratio of a full-scale sine to the noise of one sample, in the channels and in the standards, dB.
const SIGNAL_TO_NOISE_DB: f64 = 60.0;
/// Standard deviation of either standard's gain: even over half of the 1 % class, as the reference draws it.
const GAIN_DEVIATION: f64 = 0.005 / 1.732_050_807_568_877_2;
/// Standard deviation of a wedge about either axis, rad: a tenth of a degree.
const WEDGE_RAD: f64 = 0.1 * core::f64::consts::PI / 180.0;
/// Longest step of MuJoCo, s: the modes reach 6.7 kHz.
const LONGEST_STEP_S: f64 = 2e-5;
/// Random stream of the draws.
const STREAM: u128 = 25;

/// How large a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Samples per second.
    pub rate_hz: f64,
    /// Trials of each of steps 2 to 4.
    pub per_step: usize,
    /// Samples of the static record, each the mean of so many raw ones that together they are the paper's ten minutes.
    pub static_samples: usize,
}

/// A played campaign, free of errors, and what a draw adds to it.
#[derive(Debug, Clone)]
pub struct World {
    /// What the recordings would be without error.
    pub clean: Campaign,
    /// Compound runs, upright and level.
    pub compound: Vec<Trial>,
    /// The preprocessing.
    pub conditioning: Conditioning,
    /// What is uncertain, and by how much.
    pub sources: Sources,
    /// Noise of one sample of the compound runs, V.
    pub noise_v: f64,
    /// The sensor's true parameters: for the player alone.
    truth: Parameters,
    static_samples: usize,
}

/// Normal numbers of one draw.
struct Dice(Pcg64);

impl Dice {
    fn roll(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}

impl World {
    /// Plays the campaign.
    ///
    /// # Panics
    /// If MuJoCo refuses a run within the rig's limits.
    pub fn play(size: Size) -> Self {
        let truth = truth::identified_parameters();
        let sensor = TrueSensor::identified();
        let rigid = RigidSensor::new(&sensor, &[1.0; LIMBS]).expect("three nodes hold a body");
        let noisy = Chain {
            signal_to_noise_db: Some(SIGNAL_TO_NOISE_DB),
            ..Chain::noise_free()
        };
        let laboratory = Laboratory {
            instruments: Instruments {
                gyroscope_bandwidth_hz: Some(GYROSCOPE_BANDWIDTH_HZ),
                ..Instruments::perfect()
            },
            ..Laboratory::noise_free(sensor)
        };
        let upright = trials(
            &RigPlan::one_turn(Mounting::AxisVertical),
            size.per_step,
            None,
        );
        let level = compound_trials(&RigPlan::one_turn(Mounting::AxisLevel));
        let trials: Vec<(Role, Trial)> = upright
            .par_iter()
            .chain(&level)
            .enumerate()
            .map(|(index, planned)| {
                let gravity = planned.gravity_ground_m_s2();
                let run = if planned.role == Role::HighFrequencyLinear {
                    let steps = (1.0 / (size.rate_hz * LONGEST_STEP_S)).ceil() as usize;
                    let model = SensorModel::new(&sensor, gravity);
                    simulate_run(&model, &planned.run, size.rate_hz, steps)
                        .expect("a run within the rig's limits simulates")
                } else {
                    rigid.simulate(&planned.run, gravity, size.rate_hz)
                };
                let role = planned.role;
                (role, laboratory.record(&run, index).trial(role))
            })
            .collect();
        let (compound, moving): (Vec<_>, Vec<_>) = trials
            .into_iter()
            .partition(|(role, _)| *role == Role::Validation);
        let compound: Vec<Trial> = compound.into_iter().map(|(_, trial)| trial).collect();
        let conditioning = Conditioning {
            level_samples: None,
            stages: Preprocessing::default(),
            accelerometer_bandwidth_hz: None,
            gyroscope_bandwidth_hz: Some(GYROSCOPE_BANDWIDTH_HZ),
        };
        let noise_v = noisy.noise_v();
        let standard = |series: &[f64]| {
            let peak = largest(series.iter().copied());
            peak / core::f64::consts::SQRT_2 / 10.0_f64.powf(SIGNAL_TO_NOISE_DB / 20.0)
        };
        let sources = Sources {
            zero_drift_v: [noise_v / (STATIC_DURATION_S * STATIC_RATE_HZ).sqrt(); LIMBS],
            trials: moving
                .iter()
                .map(|(_, trial)| TrialNoise {
                    channels_v: [noise_v; LIMBS],
                    accelerometer_m_s2: standard(&trial.accelerometer_m_s2),
                    gyroscope_rad_s: standard(&trial.gyroscope_rad_s),
                })
                .collect(),
            accelerometer_gain: GAIN_DEVIATION,
            gyroscope_gain: GAIN_DEVIATION,
            wedge_rad: WEDGE_RAD,
        };
        let trials = moving
            .into_iter()
            .map(|(_, trial)| {
                let conditioned = conditioning
                    .condition(&trial)
                    .expect("a whole trial cleans");
                (trial, conditioned)
            })
            .collect();
        Self {
            clean: Campaign {
                geometry: Geometry::PAPER,
                design: truth::design_parameters(),
                static_voltage_v: vec![truth.zero_drift_v; size.static_samples],
                trials,
            },
            compound,
            conditioning,
            sources,
            noise_v,
            truth,
            static_samples: size.static_samples,
        }
    }

    /// The same laboratory with all its errors a share of what they are: what first order leaves out shrinks with its square.
    pub fn times(&self, share: f64) -> Self {
        let all = &self.sources;
        let sources = Sources {
            zero_drift_v: all.zero_drift_v.map(|sd| sd * share),
            trials: all
                .trials
                .iter()
                .map(|noise| TrialNoise {
                    channels_v: noise.channels_v.map(|sd| sd * share),
                    accelerometer_m_s2: noise.accelerometer_m_s2 * share,
                    gyroscope_rad_s: noise.gyroscope_rad_s * share,
                })
                .collect(),
            accelerometer_gain: all.accelerometer_gain * share,
            gyroscope_gain: all.gyroscope_gain * share,
            wedge_rad: all.wedge_rad * share,
        };
        Self {
            sources,
            noise_v: self.noise_v * share,
            ..self.clone()
        }
    }

    /// The laboratory's noise without its standards' gains and its wedges.
    pub fn noise_alone(&self) -> Sources {
        Sources {
            accelerometer_gain: 0.0,
            gyroscope_gain: 0.0,
            wedge_rad: 0.0,
            ..self.sources.clone()
        }
    }

    /// One laboratory's campaign and compound runs, with errors of `sources` drawn from a seed.
    ///
    /// # Panics
    /// Never: what cleans without errors cleans with them.
    pub fn draw(&self, sources: &Sources, seed: u64) -> (Campaign, Vec<Trial>) {
        let mut dice = Dice(Pcg64::new(u128::from(seed), STREAM));
        let mut campaign = self.clean.clone();
        let gains =
            [sources.accelerometer_gain, sources.gyroscope_gain].map(|sd| 1.0 + sd * dice.roll());
        let static_sd = sources
            .zero_drift_v
            .map(|sd| sd * (self.static_samples as f64).sqrt());
        for row in &mut campaign.static_voltage_v {
            for (u, sd) in row.iter_mut().zip(static_sd) {
                *u += sd * dice.roll();
            }
        }
        let mut wedges: Vec<(DVec3, DVec3)> = Vec::new();
        for ((trial, conditioned), noise) in campaign.trials.iter_mut().zip(&sources.trials) {
            let direction = trial.direction_ground;
            let stated = match wedges.iter().find(|(true_one, _)| *true_one == direction) {
                Some((_, stated)) => *stated,
                None => {
                    let (u, v) = direction.any_orthonormal_pair();
                    let tilt = u * dice.roll() + v * dice.roll();
                    let stated = (direction + tilt * sources.wedge_rad).normalize();
                    wedges.push((direction, stated));
                    stated
                }
            };
            // The player keeps the true direction; what is wrong is the laboratory's belief.
            trial.direction_ground = stated;
            for row in &mut trial.voltage_v {
                for (u, sd) in row.iter_mut().zip(noise.channels_v) {
                    *u += sd * dice.roll();
                }
            }
            for (series, gain, sd) in [
                (
                    &mut trial.accelerometer_m_s2,
                    gains[0],
                    noise.accelerometer_m_s2,
                ),
                (&mut trial.gyroscope_rad_s, gains[1], noise.gyroscope_rad_s),
            ] {
                for x in series.iter_mut() {
                    *x = *x * gain + sd * dice.roll();
                }
            }
            *conditioned = self
                .conditioning
                .condition(trial)
                .expect("a noisy trial cleans");
        }
        let mut compound = self.compound.clone();
        for trial in &mut compound {
            for row in &mut trial.voltage_v {
                for u in row.iter_mut() {
                    *u += self.noise_v * dice.roll();
                }
            }
        }
        (campaign, compound)
    }

    /// A compound run decoupled by parameters that somebody identified.
    ///
    /// # Panics
    /// If the decoupler refuses.
    pub fn decouple(trial: &Trial, parameters: &Parameters) -> Vec<SixAxis> {
        let (sensor, settings) = (trial.sensor(Geometry::PAPER), trial.settings(Scheme::Heun));
        decouple(&sensor, parameters, &settings, &trial.voltage_v)
            .expect("a run of the rig decouples")
    }

    /// True parameters, for the player's own use.
    pub fn truth(&self) -> &Parameters {
        &self.truth
    }
}

/// The 25 numbers that the four steps find, in the order of the covariance: the gyroscope trusted, step 4 by least squares.
///
/// # Panics
/// If a step refuses.
pub fn calibrate(campaign: &Campaign) -> SVector<f64, PARAMETERS> {
    let (parameters, compliance) = identified(campaign);
    let mut all = SVector::<f64, PARAMETERS>::zeros();
    let numbers = parameters
        .zero_drift_v
        .into_iter()
        .chain(parameters.scale_per_mass_per_kg)
        .chain(parameters.inertia_per_mass.to_paper_order())
        .chain([compliance]);
    for (entry, number) in all.iter_mut().zip(numbers) {
        *entry = number;
    }
    all
}

/// The parameters to decouple with, k/m the design's, and m/k as step 4 finds it.
///
/// # Panics
/// If a step refuses.
pub fn identified(campaign: &Campaign) -> (Parameters, f64) {
    let drift = zero_drift::identify(&campaign.static_voltage_v).expect("step 1 is possible");
    let scale = campaign
        .scale(&drift, |_| true)
        .expect("step 2 is possible");
    let mut parameters = Parameters {
        zero_drift_v: drift.drift_v,
        scale_per_mass_per_kg: scale.estimate.values,
        ..campaign.design
    };
    parameters.inertia_per_mass = campaign
        .angular(&parameters, |_| true)
        .and_then(|rows| rows.solve())
        .expect("step 3 is possible")
        .inertia_per_mass;
    let compliance = campaign
        .compliance(&parameters)
        .expect("step 4 is possible");
    (parameters, compliance)
}
