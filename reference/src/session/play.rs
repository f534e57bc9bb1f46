//! Plays a session plan: what the laboratory records, what it writes into its session file, and what only the simulator knows.

use core::f64::consts::PI;
use std::path::PathBuf;

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;
use sixaxis_calibration::session::{
    Accelerometer, Channels, Design, Entry, Gyroscope, PerLimb, Preprocessing, Rig, Role,
    SensorCard, Session,
};
use sixaxis_core::preprocess::resample::CubicSpline;
use sixaxis_core::{Gains, Geometry, LIMBS, Parameters};
use thiserror::Error;

use super::defect::{Defect, Where};
use super::plan::{Engine, SessionPlan, random_sensor};
use crate::campaign::{DAMPING_RATIO, MASS_KG, WEDGES};
use crate::chain::{Chain, Coupling, amplifier_ranges};
use crate::instruments::Instruments;
use crate::mjcf::SensorModel;
use crate::paper;
use crate::recording::{SimulatedRun, TrueMotion};
use crate::rig::{Mode, Mounting, Run};
use crate::rigid::RigidSensor;
use crate::simulation::SimulationError;

/// Runge-Kutta steps of MuJoCo are at most this long, s: the modes reach 6.7 kHz.
const LONGEST_STEP_S: f64 = 2e-5;

/// Random streams of a session.
const WEDGE_STREAM: u128 = 5;
const INSTRUMENT_STREAM: u128 = 6;
const STATIC_STREAM: u128 = 7;
const FIRST_TRIAL_STREAM: u128 = 64;

/// Wedges that lie in the plane square to an axis.
fn planar_wedges(axis: usize) -> [DVec3; 4] {
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    [(1.0, 0.0), (0.0, 1.0), (1.0, 2.0), (2.0, 1.0)].map(|(x, y)| {
        let mut v = [0.0; 3];
        (v[a], v[b]) = (x, y);
        DVec3::from_array(v)
    })
}

/// A session that cannot be played.
#[derive(Debug, Error)]
pub enum PlayError {
    /// MuJoCo refuses.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The plan has numbers that cannot be.
    #[error("simulation plan: {0}")]
    Plan(String),
}

/// One recording as it lies on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// What the session file says of it.
    pub entry: Entry,
    /// Samples per second as the recorder writes it down.
    pub sample_rate_hz: f64,
    /// Nine voltages per sample, V, true volts times whatever the recorder makes of them.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Accelerometer, m/s^2; empty for the static record.
    pub accelerometer_m_s2: Vec<f64>,
    /// Gyroscope, rad/s; empty for the static record.
    pub gyroscope_rad_s: Vec<f64>,
    /// The true motion; empty for the static record.
    pub truth: Vec<TrueMotion>,
}

/// A played session.
#[derive(Debug, Clone)]
pub struct PlayedSession {
    /// What the laboratory writes down.
    pub session: Session,
    /// Its recordings, the static one first.
    pub recordings: Vec<Played>,
    /// What it does not know.
    pub truth: Truth,
}

/// What only the simulator knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// The plan.
    pub plan: SessionPlan,
    /// The sensor's true parameters.
    pub parameters: Parameters,
    /// The instruments as they are.
    pub instruments: Instruments,
    /// What is wrong, particulars drawn.
    pub defect: Option<Defect>,
}

/// One trial to be played.
struct Planned {
    role: Role,
    mode: Mode,
    frequency_hz: f64,
    /// Which wedge, if it is one of the six.
    wedge: Option<usize>,
    direction: DVec3,
}

fn planned(plan: &SessionPlan, defect: Option<&Defect>) -> Vec<Planned> {
    let per_step = plan.trials_per_step;
    let mut trials = Vec::new();
    for (role, mode, (low, high)) in [
        (Role::Linear, Mode::Linear, plan.rig.low_band_hz),
        (Role::Angular, Mode::Angular, plan.rig.low_band_hz),
        (
            Role::HighFrequencyLinear,
            Mode::Linear,
            plan.rig.high_band_hz,
        ),
    ] {
        let plane = match defect {
            Some(Defect::UnderExcitedAxis {
                axis,
                linear,
                angular,
            }) if (*linear && mode == Mode::Linear) || (*angular && mode == Mode::Angular) => {
                Some(planar_wedges(*axis))
            }
            _ => None,
        };
        for i in 0..per_step {
            let share = i as f64 / (per_step.max(2) - 1) as f64;
            let (wedge, direction) = match &plane {
                Some(wedges) => (None, wedges[i % wedges.len()]),
                None => (Some(i % WEDGES.len()), WEDGES[i % WEDGES.len()]),
            };
            trials.push(Planned {
                role,
                mode,
                frequency_hz: low + (high - low) * share,
                wedge,
                direction: direction.normalize(),
            });
        }
    }
    trials.extend(paper::COMPOUND_TABLES.iter().map(|table| Planned {
        role: Role::Validation,
        mode: Mode::Compound,
        frequency_hz: table.frequency_hz,
        wedge: WEDGES.iter().position(|w| *w == table.direction),
        direction: table.direction.normalize(),
    }));
    trials
}

/// A direction tilted by an angle towards an azimuth about itself.
fn tilted(direction: DVec3, angle_rad: f64, azimuth_rad: f64) -> DVec3 {
    let side = direction.any_orthonormal_vector();
    let towards = DQuat::from_axis_angle(direction, azimuth_rad) * side;
    (direction * angle_rad.cos() + towards * angle_rad.sin()).normalize()
}

/// Plays a session.
///
/// # Errors
/// [`PlayError`].
pub fn play(plan: &SessionPlan) -> Result<PlayedSession, PlayError> {
    check(plan)?;
    let defect = plan.drawn_defect();
    let defect = defect.as_ref();
    let parameters = plan.parameters();
    let mounting = match defect {
        Some(Defect::GravityNotHandled { level: true }) => Mounting::AxisLevel,
        Some(Defect::GravityNotHandled { level: false }) => Mounting::AxisVertical,
        _ => plan.rig.mounting,
    };
    let seed = u128::from(plan.seed);
    let instruments = instruments(plan, defect);
    let mut wedge_rng = Pcg64::new(seed, WEDGE_STREAM);
    let wedge_errors: [(f64, f64); WEDGES.len()] = core::array::from_fn(|_| {
        (
            plan.rig.wedge_error_deg.to_radians() * wedge_rng.random::<f64>(),
            2.0 * PI * wedge_rng.random::<f64>(),
        )
    });
    let trials = planned(plan, defect);
    let mut recordings = vec![Played {
        entry: Entry {
            file: PathBuf::from("static"),
            role: Role::Static,
            direction: None,
            down: None,
            frequency_hz: None,
            sample_rate_hz: None,
            gain_n_per_v: None,
            reference_file: None,
            reference_start_s: None,
            reference_sample_rate_hz: None,
            channels: None,
        },
        sample_rate_hz: plan.static_rate_hz,
        voltage_v: at_rest(plan, &parameters, defect),
        accelerometer_m_s2: Vec::new(),
        gyroscope_rad_s: Vec::new(),
        truth: Vec::new(),
    }];
    let mut counts = [0_usize; 4];
    let names: Vec<String> = trials
        .iter()
        .map(|trial| {
            let (kind, word) = match trial.role {
                Role::Linear => (0, "linear"),
                Role::Angular => (1, "angular"),
                Role::HighFrequencyLinear => (2, "fast"),
                Role::Static | Role::Validation => (3, "compound"),
            };
            counts[kind] += 1;
            format!("{word}-{:02}", counts[kind])
        })
        .collect();
    let played: Vec<Played> = trials
        .par_iter()
        .zip(names)
        .enumerate()
        .map(|(index, (trial, name))| {
            let mut direction = trial.direction;
            if let Some(wedge) = trial.wedge {
                let (angle, azimuth) = wedge_errors[wedge];
                direction = tilted(direction, angle, azimuth);
            }
            if let Some(Defect::LooseWedge {
                wedge,
                angle_deg,
                azimuth_rad,
            }) = defect
                && trial.wedge == Some(*wedge)
                && trial.role != Role::Validation
            {
                direction = tilted(direction, angle_deg.to_radians(), *azimuth_rad);
            }
            Recorder {
                plan,
                defect,
                instruments: &instruments,
                index,
            }
            .record(trial, name, direction, mounting, &parameters)
        })
        .collect::<Result<_, PlayError>>()?;
    recordings.extend(played);
    Ok(PlayedSession {
        session: session(plan, defect, &recordings),
        recordings,
        truth: Truth {
            plan: plan.clone(),
            parameters,
            instruments,
            defect: defect.cloned(),
        },
    })
}

fn check(plan: &SessionPlan) -> Result<(), PlayError> {
    for (name, value) in [
        ("sample_rate_hz", plan.sample_rate_hz),
        ("static_duration_s", plan.static_duration_s),
        ("static_rate_hz", plan.static_rate_hz),
        ("rig.slider_amplitude_m", plan.rig.slider_amplitude_m),
        (
            "rig.rotation_amplitude_rad",
            plan.rig.rotation_amplitude_rad,
        ),
        (
            "rig.low_band_hz",
            plan.rig.low_band_hz.0.min(plan.rig.low_band_hz.1),
        ),
        (
            "rig.high_band_hz",
            plan.rig.high_band_hz.0.min(plan.rig.high_band_hz.1),
        ),
        ("chain.full_scale_v", plan.chain.full_scale_v),
        ("instruments.class_percent", plan.instruments.class_percent),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(PlayError::Plan(format!(
                "{name} = {value}: must be positive and finite"
            )));
        }
    }
    // The crank's own run has to come back to where it began.
    let turns = plan.rig.ramp_periods + plan.rig.steady_periods;
    if !(plan.rig.ramp_periods > 0.0 && plan.rig.steady_periods >= 0.0 && turns.fract() == 0.0) {
        return Err(PlayError::Plan(format!(
            "rig.ramp_periods + rig.steady_periods = {turns}: must be a whole number, so that a run ends where it began"
        )));
    }
    if plan.trials_per_step < 3 {
        return Err(PlayError::Plan(
            "trials_per_step: three directions need at least 3".to_owned(),
        ));
    }
    Ok(())
}

fn chain(plan: &SessionPlan) -> Chain {
    Chain {
        coupling: Coupling::Tared,
        signal_to_noise_db: plan
            .chain
            .signal_to_noise_db
            .is_finite()
            .then_some(plan.chain.signal_to_noise_db),
        resolution_bits: (plan.chain.resolution_bits > 0).then_some(plan.chain.resolution_bits),
        full_scale_v: plan.chain.full_scale_v,
    }
}

fn instruments(plan: &SessionPlan, defect: Option<&Defect>) -> Instruments {
    let mut rng = Pcg64::new(u128::from(plan.seed), INSTRUMENT_STREAM);
    // Half of the class is the gain's, as in `Instruments::of_class`; linearity and noise have the rest.
    let half = 0.5 * plan.instruments.class_percent / 100.0;
    let mut gain_error = || half * (2.0 * rng.random::<f64>() - 1.0);
    let bandwidth_hz = match defect {
        Some(Defect::GyroscopeLag { bandwidth_hz }) => *bandwidth_hz,
        _ => plan.instruments.gyroscope_bandwidth_hz,
    };
    Instruments {
        accelerometer_gain_error: gain_error(),
        gyroscope_gain_error: gain_error(),
        gyroscope_bandwidth_hz: (bandwidth_hz > 0.0).then_some(bandwidth_hz),
        signal_to_noise_db: plan
            .instruments
            .signal_to_noise_db
            .is_finite()
            .then_some(plan.instruments.signal_to_noise_db),
    }
}

/// Gain of the static record: the amplifiers' most sensitive range that a trial of the campaign uses matters little there.
const STATIC_GAIN_N_PER_V: f64 = 1.0;

fn at_rest(
    plan: &SessionPlan,
    parameters: &Parameters,
    defect: Option<&Defect>,
) -> Vec<[f64; LIMBS]> {
    let chain = chain(plan);
    let mut rng = Pcg64::new(u128::from(plan.seed), STATIC_STREAM);
    let samples = (plan.static_duration_s * plan.static_rate_hz) as usize;
    let mut drift = parameters.zero_drift_v;
    let mut slope = [0.0; LIMBS];
    let mut factor = [1.0; LIMBS];
    match defect {
        Some(Defect::InvertedChannel {
            channel,
            place: Where::Everywhere,
        }) => factor[*channel] = -1.0,
        Some(Defect::SwappedChannels {
            channels: [a, b],
            place: Where::Everywhere,
        }) => drift.swap(*a, *b),
        Some(Defect::MillivoltMixUp {
            channel,
            place: Where::Everywhere,
            factor: f,
        }) => {
            for (limb, own) in factor.iter_mut().enumerate() {
                if channel.is_none_or(|c| c == limb) {
                    *own = *f;
                }
            }
        }
        Some(Defect::DriftDuringRun {
            channel,
            trial: None,
            share,
        }) => slope[*channel] = share * chain.full_scale_v,
        _ => {}
    }
    (0..samples)
        .map(|sample| {
            let share = sample as f64 / samples as f64 - 0.5;
            core::array::from_fn(|limb| {
                factor[limb] * chain.convert(drift[limb] + slope[limb] * share, &mut rng)
            })
        })
        .collect()
}

struct Recorder<'a> {
    plan: &'a SessionPlan,
    defect: Option<&'a Defect>,
    instruments: &'a Instruments,
    index: usize,
}

impl Recorder<'_> {
    fn record(
        &self,
        trial: &Planned,
        name: String,
        direction: DVec3,
        mounting: Mounting,
        parameters: &Parameters,
    ) -> Result<Played, PlayError> {
        let plan = self.plan;
        let here = |place: &Where| place.holds(Some(self.index));
        let mut parameters = *parameters;
        if let Some(Defect::ForeignTrial { trial, seed }) = self.defect
            && *trial == self.index
        {
            parameters = random_sensor(&mut Pcg64::new(u128::from(*seed), 1));
        }
        let mut run = Run::new(trial.mode, trial.frequency_hz, direction);
        run.slider_amplitude_m = plan.rig.slider_amplitude_m;
        run.rotation_amplitude_rad = plan.rig.rotation_amplitude_rad;
        run.rest_s = plan.rig.rest_s;
        run.ramp_periods = plan.rig.ramp_periods;
        run.steady_periods = plan.rig.steady_periods;
        let mut simulated = self.simulate(&run, mounting, &parameters)?;
        if let Some(Defect::SwappedChannels {
            channels: [a, b],
            place,
        }) = self.defect
            && here(place)
        {
            // Limb and piezo come along with the plug; the amplifier stays.
            for force in &mut simulated.limb_force_per_mass_m_s2 {
                force.swap(*a, *b);
            }
            parameters.scale_per_mass_per_kg.swap(*a, *b);
            parameters.zero_drift_v.swap(*a, *b);
        }
        let chain = chain(plan);
        let mut rng = Pcg64::new(
            u128::from(plan.seed),
            FIRST_TRIAL_STREAM + self.index as u128,
        );
        let gains = amplifier_ranges(
            &simulated.limb_force_per_mass_m_s2,
            &parameters,
            chain.full_scale_v,
        );
        let rate = plan.sample_rate_hz;
        let mut voltage_v = chain.record(
            &simulated.limb_force_per_mass_m_s2,
            &parameters,
            &gains,
            rate,
            &mut rng,
        );
        let mut stated_gains = gains;
        self.spoil(
            &mut voltage_v,
            &mut stated_gains,
            &parameters,
            &chain,
            &mut rng,
        );
        let along = |get: fn(&TrueMotion) -> DVec3| -> Vec<f64> {
            simulated
                .truth
                .iter()
                .map(|t| get(t).dot(direction))
                .collect()
        };
        let mut accelerometer_m_s2 = self
            .instruments
            .read_accelerometer(&along(|t| t.linear_ground_m_s2), &mut rng);
        let mut gyroscope_rad_s =
            self.instruments
                .read_gyroscope(&along(|t| t.rate_shell_rad_s), rate, &mut rng);
        let mut stated_rate = rate;
        match self.defect {
            Some(Defect::WrongAccelerometer { factor }) => {
                accelerometer_m_s2.iter_mut().for_each(|a| *a *= factor);
            }
            Some(Defect::WrongGyroscope { factor }) => {
                gyroscope_rad_s.iter_mut().for_each(|w| *w *= factor);
            }
            Some(Defect::ReferenceClock {
                place,
                late_s,
                rate_error,
            }) if here(place) => {
                for series in [&mut accelerometer_m_s2, &mut gyroscope_rad_s] {
                    *series = on_other_clock(series, rate, *late_s, *rate_error);
                }
            }
            Some(Defect::WrongSampleRate { place, factor }) if here(place) => {
                stated_rate *= factor;
            }
            _ => {}
        }
        let stated_level = match self.defect {
            Some(Defect::GravityNotHandled { level }) => !level,
            _ => plan.rig.mounting == Mounting::AxisLevel,
        };
        let down = stated_level.then(|| {
            Mounting::AxisLevel
                .gravity_ground_m_s2(trial.direction)
                .normalize()
                .to_array()
        });
        Ok(Played {
            entry: Entry {
                file: PathBuf::from(name),
                role: trial.role,
                direction: Some(trial.direction.to_array().map(tidy)),
                down: down.map(|v| v.map(tidy)),
                frequency_hz: Some(tidy(trial.frequency_hz)),
                sample_rate_hz: None,
                gain_n_per_v: Some(PerLimb::Each(stated_gains.gain_n_per_v)),
                reference_file: None,
                reference_start_s: None,
                reference_sample_rate_hz: None,
                channels: None,
            },
            sample_rate_hz: stated_rate,
            voltage_v,
            accelerometer_m_s2,
            gyroscope_rad_s,
            truth: simulated.truth,
        })
    }

    fn simulate(
        &self,
        run: &Run,
        mounting: Mounting,
        parameters: &Parameters,
    ) -> Result<SimulatedRun, PlayError> {
        let gravity_ground_m_s2 = mounting.gravity_ground_m_s2(run.direction_ground);
        let rate = self.plan.sample_rate_hz;
        match self.plan.engine {
            Engine::Rigid => {
                let sensor = RigidSensor::new(
                    &Geometry::PAPER,
                    &parameters.inertia_per_mass,
                    &self.plan.stiffness_ratio(),
                )
                .ok_or_else(|| {
                    PlayError::Plan(
                        "chain.stiffness_spread: limbs that do not hold the mass".to_owned(),
                    )
                })?;
                Ok(sensor.play(run, gravity_ground_m_s2, rate))
            }
            Engine::Mujoco => {
                let model = SensorModel {
                    geometry: Geometry::PAPER,
                    mass_kg: MASS_KG,
                    inertia_per_mass: parameters.inertia_per_mass,
                    stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
                    damping_ratio: DAMPING_RATIO,
                    gravity_ground_m_s2,
                };
                let steps = (1.0 / (rate * LONGEST_STEP_S)).ceil() as usize;
                Ok(SimulatedRun::simulate(&model, run, rate, steps)?)
            }
        }
    }

    /// What defects of the measuring chain make of the voltages and of what is written down of them.
    fn spoil(
        &self,
        voltage_v: &mut [[f64; LIMBS]],
        gains: &mut Gains,
        parameters: &Parameters,
        chain: &Chain,
        rng: &mut Pcg64,
    ) {
        let here = |place: &Where| place.holds(Some(self.index));
        match self.defect {
            Some(Defect::DeadLimb { channel, place }) if here(place) => {
                for row in voltage_v {
                    row[*channel] = chain.convert(parameters.zero_drift_v[*channel], rng);
                }
            }
            Some(Defect::InvertedChannel { channel, place }) if here(place) => {
                for row in voltage_v {
                    row[*channel] = -row[*channel];
                }
            }
            Some(Defect::ClippedConverter {
                channel,
                trial,
                share,
            }) if *trial == self.index => {
                let zero = parameters.zero_drift_v[*channel];
                let peak = voltage_v
                    .iter()
                    .fold(0.0_f64, |a, row| a.max((row[*channel] - zero).abs()));
                for row in voltage_v {
                    row[*channel] = row[*channel].clamp(-share * peak, share * peak);
                }
            }
            Some(Defect::WrongGain {
                channel,
                place,
                factor,
            }) if here(place) => gains.gain_n_per_v[*channel] *= factor,
            Some(Defect::MillivoltMixUp {
                channel,
                place,
                factor,
            }) if here(place) => {
                for row in voltage_v {
                    for (limb, u) in row.iter_mut().enumerate() {
                        if channel.is_none_or(|c| c == limb) {
                            *u *= factor;
                        }
                    }
                }
            }
            Some(Defect::DriftDuringRun {
                channel,
                trial: Some(trial),
                share,
            }) if *trial == self.index => {
                // In the channel's own volts, of the force that the strongest channel feels.
                let h = |i: usize| 1.0 / parameters.scale_per_mass_per_kg[i];
                let strongest = (0..LIMBS)
                    .map(|i| {
                        let zero = parameters.zero_drift_v[i];
                        voltage_v
                            .iter()
                            .fold(0.0_f64, |a, row| a.max((row[i] - zero).abs()))
                            * gains.gain_n_per_v[i]
                            / h(i)
                    })
                    .fold(0.0, f64::max);
                let volts = share * strongest * h(*channel) / gains.gain_n_per_v[*channel];
                let samples = voltage_v.len() as f64;
                for (sample, row) in voltage_v.iter_mut().enumerate() {
                    row[*channel] += volts * sample as f64 / samples;
                }
            }
            _ => {}
        }
    }
}

/// Ten digits: what a person would write into a file.
fn tidy(value: f64) -> f64 {
    (value * 1e10).round() / 1e10
}

/// A series as a recorder takes it whose samples come late and at another rate. At the ends the first and the last value stand.
fn on_other_clock(series: &[f64], rate_hz: f64, late_s: f64, rate_error: f64) -> Vec<f64> {
    let Ok(spline) = CubicSpline::even(series, rate_hz) else {
        return series.to_vec();
    };
    let end_s = (series.len() - 1) as f64 / rate_hz;
    (0..series.len())
        .map(|i| {
            let time_s = i as f64 / (rate_hz * (1.0 + rate_error)) + late_s;
            spline
                .at(time_s.clamp(0.0, end_s))
                .unwrap_or_else(|_| series[i])
        })
        .collect()
}

fn session(plan: &SessionPlan, defect: Option<&Defect>, recordings: &[Played]) -> Session {
    let stated_bandwidth = match defect {
        Some(Defect::GyroscopeLag { .. }) => None,
        _ => (plan.instruments.gyroscope_bandwidth_hz > 0.0)
            .then_some(plan.instruments.gyroscope_bandwidth_hz),
    };
    Session {
        title: format!("Simulated session, seed {}", plan.seed),
        sensor: SensorCard {
            serial: format!("simulated-{}", plan.seed),
            limb_length_mm: tidy(Geometry::PAPER.limb_length_m * 1e3),
            half_edge_mm: tidy(Geometry::PAPER.half_edge_m * 1e3),
            full_scale_v: plan.chain.full_scale_v,
            gain_n_per_v: PerLimb::All(STATIC_GAIN_N_PER_V),
            design: Design {
                scale_per_mass_per_kg: PerLimb::All(paper::DESIGN_SCALE_PER_MASS_PER_KG),
                inertia_per_mass_mm2: paper::DESIGN_INERTIA_PER_MASS_MM2,
                stiffness_per_mass_per_s2: paper::DESIGN_STIFFNESS_PER_MASS_PER_S2,
            },
        },
        accelerometer: Accelerometer {
            sensitivity_mv_per_g: None,
            class_percent: plan.instruments.class_percent,
            bandwidth_hz: None,
        },
        gyroscope: Gyroscope {
            sensitivity_mv_per_deg_s: None,
            class_percent: plan.instruments.class_percent,
            bandwidth_hz: stated_bandwidth,
        },
        rig: Some(Rig {
            stroke_mm: Some(tidy(2e3 * plan.rig.slider_amplitude_m)),
            rotation_amplitude_deg: Some(tidy(plan.rig.rotation_amplitude_rad.to_degrees())),
        }),
        channels: Channels::default(),
        preprocessing: Preprocessing::default(),
        recording: recordings.iter().map(|r| r.entry.clone()).collect(),
    }
}
