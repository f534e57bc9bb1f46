//! Hours of motion, decoupled with what else is known of them, against the motion itself.
//!
//! A calibration's errors are drawn anew for every run from the covariance that the decoupler is told, and so is the noise. What a
//! deviation is worth is asked of squared errors over variances: their mean is 1 where it is right.

pub mod hours;
mod watched;

use glam::{DQuat, DVec3};
use nalgebra::{DVector, SMatrix, SVector};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::aided::{Aid, AidedDecoupler, Bound, ErrorFilter, RestFinder, bound};
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::parameter::{DRIFT, INERTIA, SCALE};
use sixaxis_core::{
    Decoupler, Gains, Geometry, InertiaPerMass, LIMBS, LimbSet, Parameters, Scheme, Sensor,
    Settings,
};
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::mujoco::Playing;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::rig::journey::{Journey, Kind};
use sixaxis_reference::sensor::TrueSensor;

pub use self::watched::{Checked, Judged, KNOWN_RAD, OPEN_S, Outcome};
use self::watched::{Common, Run};
use crate::truth;
use crate::undone::{Amplifier, UndoneNoise};

/// Random stream of the runs.
const STREAM: u128 = 21;
/// Random streams of what aids tell, one for each set of them.
const FIXES: u128 = 2100;
/// Samples of truth that are played at a time.
const PIECE: usize = 4096;
/// Time of the motion that amplifier ranges are chosen by, s: a vehicle takes its time.
const RANGING_S: f64 = 60.0;
/// Of its samples one in so many: peaks need no more.
const RANGING_BY: f64 = 10.0;

/// What a calibration leaves open, standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Noise of a sample over the largest signal. A number and no power of ten: that is rounded otherwise where it is optimised.
    pub noise_of_peak: f64,
    /// Zero drifts, over the deviation of one sample's noise.
    pub drift_of_noise: f64,
    /// Scale factors, all together by the accelerometer's gain and each by itself, relative.
    pub scale: [f64; 2],
    /// Inertias over the mean moment.
    pub inertia: f64,
    /// Down at the first sample in each of two directions, rad.
    pub down_rad: f64,
    /// What the decoupler is told of all these, over what they are: 1 where it is told the truth.
    pub told: f64,
}

impl Quality {
    /// As a good day leaves it: 74 dB, zeros of ten thousand samples' mean, gains to 0.1 % together and 5e-5 each (one standard deviation).
    pub const DAY: Self = Self {
        noise_of_peak: 1.995_262_314_968_88e-4,
        drift_of_noise: 0.01,
        scale: [1e-3, 5e-5],
        inertia: 2e-4,
        down_rad: 0.001_75,
        told: 1.0,
    };
}

/// Which aids are used.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Aids {
    /// Time between two measurements of the velocity, s, and its deviation, m/s.
    pub velocity: Option<(f64, f64)>,
    /// Time between two fixes of the attitude, s, and their deviation, rad.
    pub attitude: Option<(f64, f64)>,
    /// Whether rests are used, as the motion has them.
    pub rests: bool,
}

impl Aids {
    /// In steady state, where there is one: what a sensor that stands still keeps open under them. None for rests, between which nothing
    /// holds.
    fn bound(
        &self,
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        noise: &ChannelNoise,
    ) -> Option<Bound> {
        let velocity = self
            .velocity
            .map(|(every_s, deviation_m_s)| (Aid::Velocity { deviation_m_s }, every_s));
        let attitude = self.attitude.map(|(every_s, deviation_rad)| {
            let attitude = DQuat::IDENTITY;
            (
                Aid::Attitude {
                    attitude,
                    deviation_rad,
                },
                every_s,
            )
        });
        let all: Vec<_> = velocity.into_iter().chain(attitude).collect();
        let none = LimbSet::EMPTY;
        bound::steady(sensor, parameters, settings, noise, none, &all).expect("a sound sensor")
    }
}

/// Who plays a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Played {
    /// Closed form, with a mass that is in equilibrium in its limbs at each instant.
    InEquilibrium,
    /// MuJoCo, with a step of so many seconds.
    ByMujoco {
        /// The step, s.
        step_s: f64,
    },
}

/// What is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ride {
    /// Who plays it.
    pub played: Played,
    /// Kind of the motion.
    pub kind: Kind,
    /// Its length, s.
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// What the calibration leaves open.
    pub quality: Quality,
    /// A high-pass of the amplifiers that is undone.
    pub amplifier: Option<Amplifier>,
    /// Whether it is smoothed, too: several times the work.
    pub smooth: bool,
    /// Limbs whose channels are not read.
    pub without: LimbSet,
}

/// Plays one motion and decouples it once with each set of aids. Errors are looked at where a block ends after each of these times.
///
/// # Panics
/// If the sensor cannot be loaded so.
pub fn run(ride: &Ride, aids: &[Aids], times_s: &[f64], seed: u64) -> Vec<Outcome> {
    let Ride {
        played: by,
        kind,
        duration_s,
        rate_hz,
        quality,
        amplifier,
        smooth,
        without,
    } = *ride;
    let rng = &mut Pcg64::new(u128::from(seed), STREAM);
    let journey = Journey::random(kind, rng);
    let true_parameters = truth::identified_parameters();
    let sensor = truth::sensor(&true_parameters);
    // The ground in which down is where it is said to be: that of the truth is turned against it.
    let off = crate::statistics::normal(rng) * quality.down_rad;
    let said = DQuat::from_scaled_axis(off.reject_from(DVec3::Z));
    let g = journey.gravity_ground_m_s2();
    let forces = |motion: &[TrueMotion]| {
        compliant_forces_m_s2(&sensor, g, motion).expect("limbs that hold the mass")
    };
    let ranging = ranging_forces(kind, &journey, rate_hz, &forces);
    let rest = forces(&journey.play(rate_hz).take(1).collect::<Vec<_>>())[0];
    let tared = |force: &[f64; LIMBS]| core::array::from_fn(|i| force[i] - rest[i]);
    let tares: Vec<[f64; LIMBS]> = ranging.iter().map(tared).collect();
    let Gains { gain_n_per_v } = truth::amplifier_ranges(&tares, &true_parameters);
    let signal = |force: &[f64; LIMBS]| sensor.voltage_v(&tared(force), &gain_n_per_v);
    let peak_v = ranging
        .iter()
        .map(|force| {
            let volts = signal(force);
            (0..LIMBS)
                .map(|i| (volts[i] - true_parameters.zero_drift_v[i]).abs())
                .fold(0.0, f64::max)
        })
        .fold(0.0, f64::max);
    let noise_v = peak_v * quality.noise_of_peak;
    let (covariance, parameters) = calibrated(&true_parameters, noise_v, quality, rng);
    let sensor_used = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains { gain_n_per_v },
    };
    let settings = Settings {
        gravity_ground_m_s2: said * g,
        scheme: Scheme::HeunSubstepped,
        ..Settings::new(rate_hz)
    };
    let noise_m_s2 = (0..3)
        .map(|axis| {
            let of_limb = |i: usize| {
                let sensitivity = true_parameters.scale_per_mass_per_kg[i] * gain_n_per_v[i];
                (DIRECTIONS_SHELL[i][axis] * sensitivity * noise_v).powi(2)
            };
            (0..LIMBS).map(of_limb).sum::<f64>().sqrt()
        })
        .fold(0.0, f64::max);
    let noise = ChannelNoise::white([noise_v * quality.told; LIMBS]);
    let decoupler = Decoupler::new(&sensor_used, &parameters, &settings)
        .and_then(|decoupler| decoupler.excluding(without))
        .expect("a sound sensor");
    let mut filter = ErrorFilter::new(
        &sensor_used,
        &parameters,
        &settings,
        &covariance,
        &noise,
        quality.down_rad * quality.told,
    )
    .expect("a sound covariance");
    filter
        .set_excluded(without)
        .expect("limbs that are not needed");
    let mut undone =
        amplifier.map(|amplifier| UndoneNoise::new(&amplifier, &[noise_v; LIMBS], rate_hz, rng));
    let wander = amplifier.and_then(|amplifier| amplifier.wander(rate_hz));
    let new = || {
        let aided = AidedDecoupler::new(decoupler.clone(), filter.clone(), &parameters, &settings);
        let mut aided = if smooth { aided.remembering() } else { aided };
        wander
            .into_iter()
            .for_each(|wander| aided.set_zero_wander(wander));
        aided
    };
    let mut runs: Vec<Run<'_>> = aids
        .iter()
        .enumerate()
        .map(|(number, aids)| Run {
            aids,
            rng: Pcg64::new(u128::from(seed), FIXES + number as u128),
            aided: new(),
            rests: RestFinder::new(filter.model(), &[noise_v; LIMBS], rate_hz),
            next_velocity_s: 0.0,
            next_fix_s: 0.0,
            looks: 0.0,
            blocks: 0,
            ended: false,
            times: Vec::new(),
            looked: Vec::new(),
            outcome: Outcome {
                filtered: Judged::default(),
                smoothed: None,
                bound: aids.bound(&sensor_used, &parameters, &settings, &noise),
            },
        })
        .collect();
    let common = Common {
        times_s,
        rate_hz,
        gravity: said * g,
        noise_m_s2,
        scale_per_mass_per_kg: true_parameters.scale_per_mass_per_kg,
    };
    let samples = (duration_s * rate_hz) as usize;
    let mut played = Vec::new();
    let mut play = player(by, &journey, &sensor, rate_hz);
    let (mut before, mut sample): (Option<TrueMotion>, usize) = (None, 0);
    while sample < samples && !runs.iter().all(|run| run.ended) {
        let piece = play(PIECE.min(samples - sample));
        sample += piece.len();
        for (motion, force) in piece {
            let mut volts = signal(&force);
            for (limb, v) in volts.iter_mut().enumerate() {
                *v += match &mut undone {
                    Some(undone) => undone.next(limb, rng),
                    None => {
                        let unit: f64 = StandardNormal.sample(rng);
                        noise_v * unit
                    }
                };
            }
            let truth = before.map(|before| TrueMotion {
                linear_ground_m_s2: said * before.linear_ground_m_s2,
                attitude: said * before.attitude,
                ..before
            });
            if smooth {
                played.push(volts);
            }
            for run in &mut runs {
                run.push(&volts, truth.as_ref(), &common);
            }
            before = Some(motion);
        }
    }
    runs.into_iter()
        .map(|run| {
            if smooth {
                run.smooth(&played, decoupler.clone(), &settings, &common)
            } else {
                run.outcome
            }
        })
        .collect()
}

/// What a motion is at one instant, and what the limbs carry then, over the mass, m/s^2.
type Sample = (TrueMotion, [f64; LIMBS]);
/// The next samples, as many as asked for.
type Player<'a> = Box<dyn FnMut(usize) -> Vec<Sample> + 'a>;

/// The motion of a kind that belongs to a seed.
fn journey(kind: Kind, seed: u64) -> Journey {
    Journey::random(kind, &mut Pcg64::new(u128::from(seed), STREAM))
}

fn player<'a>(
    by: Played,
    journey: &'a Journey,
    sensor: &'a TrueSensor,
    rate_hz: f64,
) -> Player<'a> {
    let g = journey.gravity_ground_m_s2();
    match by {
        Played::InEquilibrium => {
            let mut motions = journey.play(rate_hz);
            Box::new(move |samples| {
                let piece: Vec<_> = motions.by_ref().take(samples).collect();
                let forces = compliant_forces_m_s2(sensor, g, &piece);
                let forces = forces.expect("limbs that hold the mass");
                piece.into_iter().zip(forces).collect()
            })
        }
        Played::ByMujoco { step_s } => {
            let steps = (1.0 / (rate_hz * step_s)).round() as usize;
            let model = SensorModel::new(sensor, g);
            let mut playing = Playing::new(&model, journey, rate_hz, steps).expect("a stable step");
            Box::new(move |samples| {
                let next = |_| {
                    let now = playing.next_sample().expect("a sensor in one piece");
                    (now.true_motion(), now.limb_force_per_mass_m_s2)
                };
                (0..samples).map(next).collect()
            })
        }
    }
}

/// Forces by which amplifier ranges are chosen: those of the motion's beginning, or of a shake where it does not move at all.
fn ranging_forces(
    kind: Kind,
    journey: &Journey,
    rate_hz: f64,
    forces: &impl Fn(&[TrueMotion]) -> Vec<[f64; LIMBS]>,
) -> Vec<[f64; LIMBS]> {
    let rate_hz = rate_hz / RANGING_BY;
    let samples = (RANGING_S * rate_hz) as usize;
    let of = |journey: &Journey| forces(&journey.play(rate_hz).take(samples).collect::<Vec<_>>());
    if kind == Kind::Still {
        // Of a seed of its own: which shake a range is made for is no part of the run.
        of(&Journey::random(Kind::Shaken, &mut Pcg64::new(0, STREAM)))
    } else {
        of(journey)
    }
}

/// Parameters as a calibration has them, with its covariance.
fn calibrated(
    truth: &Parameters,
    noise_v: f64,
    quality: Quality,
    rng: &mut Pcg64,
) -> (Covariance, Parameters) {
    let exact = truth.to_paper_order();
    let moment = exact[INERTIA.start..INERTIA.start + 3].iter().sum::<f64>() / 3.0;
    let mut root = SMatrix::<f64, 25, 26>::zeros();
    for i in DRIFT {
        root[(i, i)] = noise_v * quality.drift_of_noise;
    }
    for i in SCALE {
        root[(i, i)] = quality.scale[1] * exact[i];
        root[(i, 25)] = quality.scale[0] * exact[i];
    }
    for i in INERTIA {
        root[(i, i)] = quality.inertia * moment;
    }
    let draws = SVector::<f64, 26>::from_fn(|_, _| StandardNormal.sample(rng));
    let errors = root * draws;
    let found: DVector<f64> = DVector::from_fn(25, |i, _| exact[i] + errors[i]);
    let parameters = Parameters {
        zero_drift_v: core::array::from_fn(|i| found[DRIFT.start + i]),
        scale_per_mass_per_kg: core::array::from_fn(|i| found[SCALE.start + i]),
        inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
            found[INERTIA.start + i]
        })),
        ..*truth
    };
    (root * root.transpose() * quality.told.powi(2), parameters)
}
