//! One trial recorded: the rig's run, the limbs' voltages, the standards' readings and what a defect makes of them.

use core::f64::consts::PI;

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64;
use sixaxis_core::dsp::resample::CubicSpline;
use sixaxis_core::{Gains, Geometry, LIMBS, Parameters};
use sixaxis_recordings::session::{Entry, PerLimb, Role};

use super::defect::{Defect, Where};
use super::effect::foreign_sensor;
use super::plan::{CouplingChoice, Engine, SessionPlan};
use super::play::{PlayError, Played};
use super::schedule::{Planned, tilted};
use super::session_file::tidy;
use crate::campaign::{DAMPING_RATIO, MASS_KG, WEDGES};
use crate::chain::{Chain, Coupling, amplifier_ranges};
use crate::instruments::Instruments;
use crate::mjcf::SensorModel;
use crate::recording::{SimulatedRun, TrueMotion};
use crate::rig::{Mounting, Run};
use crate::rigid::RigidSensor;

/// Runge-Kutta steps of MuJoCo are at most this long, s: the modes reach 6.7 kHz.
const LONGEST_STEP_S: f64 = 2e-5;

/// Random streams of a session.
const WEDGE_STREAM: u128 = 5;
const FIRST_TRIAL_STREAM: u128 = 64;

/// The measuring chain of a plan.
pub(super) fn chain(plan: &SessionPlan) -> Chain {
    let corner_hz = plan.chain.amplifier_high_pass_hz;
    Chain {
        coupling: match plan.chain.coupling {
            CouplingChoice::Ideal => Coupling::Ideal,
            CouplingChoice::Tared if corner_hz > 0.0 => Coupling::AlternatingCurrent { corner_hz },
            CouplingChoice::Tared => Coupling::Tared,
        },
        signal_to_noise_db: plan
            .chain
            .signal_to_noise_db
            .is_finite()
            .then_some(plan.chain.signal_to_noise_db),
        resolution_bits: (plan.chain.resolution_bits > 0).then_some(plan.chain.resolution_bits),
        full_scale_v: plan.chain.full_scale_v,
    }
}

/// The wedges as the workshop made them: tilt and where it goes to, rad.
pub(super) fn wedge_errors(plan: &SessionPlan) -> [(f64, f64); WEDGES.len()] {
    let mut rng = Pcg64::new(u128::from(plan.seed), WEDGE_STREAM);
    core::array::from_fn(|_| {
        (
            plan.rig.wedge_error_deg.to_radians() * rng.random::<f64>(),
            2.0 * PI * rng.random::<f64>(),
        )
    })
}

/// Records the trials of one session.
pub(super) struct Recorder<'a> {
    pub plan: &'a SessionPlan,
    pub defect: Option<&'a Defect>,
    pub instruments: &'a Instruments,
    pub parameters: &'a Parameters,
    pub mounting: Mounting,
    pub wedge_errors: [(f64, f64); WEDGES.len()],
}

impl Recorder<'_> {
    /// Records the trial with this number.
    pub fn record(&self, index: usize, trial: &Planned) -> Result<Played, PlayError> {
        let plan = self.plan;
        let here = |place: &Where| place.holds(Some(index));
        let direction = self.true_direction(trial);
        let mut parameters = match self.defect {
            Some(Defect::ForeignTrial { trial, seed }) if *trial == index => foreign_sensor(*seed),
            _ => *self.parameters,
        };
        let run = trial.run(&plan.rig, direction);
        let mut simulated = self.simulate(&run, trial.direction, &parameters)?;
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
        let mut rng = Pcg64::new(u128::from(plan.seed), FIRST_TRIAL_STREAM + index as u128);
        let forces = &simulated.limb_force_per_mass_m_s2;
        let gains = match chain.coupling {
            // Ranges are chosen from changes of force since the first row: with no load there, from the whole force.
            Coupling::Ideal => {
                let mut from_nothing = vec![[0.0; LIMBS]];
                from_nothing.extend_from_slice(forces);
                amplifier_ranges(&from_nothing, &parameters, chain.full_scale_v)
            }
            Coupling::Tared | Coupling::AlternatingCurrent { .. } => {
                amplifier_ranges(forces, &parameters, chain.full_scale_v)
            }
        };
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
            index,
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
                file: trial.name.clone().into(),
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

    /// The direction that wedge and workshop make of the stated one.
    fn true_direction(&self, trial: &Planned) -> DVec3 {
        let Some(index) = trial.wedge else {
            return trial.direction;
        };
        let (angle, azimuth) = self.wedge_errors[index];
        let direction = tilted(trial.direction, angle, azimuth);
        match self.defect {
            Some(Defect::LooseWedge {
                wedge,
                angle_deg,
                azimuth_rad,
            }) if *wedge == index && trial.role != Role::Validation => {
                tilted(direction, angle_deg.to_radians(), *azimuth_rad)
            }
            _ => direction,
        }
    }

    fn simulate(
        &self,
        run: &Run,
        stated_direction: DVec3,
        parameters: &Parameters,
    ) -> Result<SimulatedRun, PlayError> {
        let gravity_ground_m_s2 = match self.mounting {
            Mounting::AxisVertical => self.mounting.gravity_ground_m_s2(run.direction_ground),
            // A wedge that misses its direction carries the sensor along, and gravity stands in it elsewhere by as much.
            Mounting::AxisLevel => {
                DQuat::from_rotation_arc(stated_direction, run.direction_ground)
                    * self.mounting.gravity_ground_m_s2(stated_direction)
            }
        };
        let rate = self.plan.sample_rate_hz;
        match self.plan.engine {
            Engine::Rigid => {
                let sensor = RigidSensor::new(
                    &Geometry::PAPER,
                    &parameters.inertia_per_mass,
                    &self.plan.stiffness_ratio(),
                )
                .ok_or_else(|| PlayError::Plan {
                    key: "chain.stiffness_spread".to_owned(),
                    cause: "the limbs do not hold the mass".to_owned(),
                })?;
                Ok(sensor.play(run, gravity_ground_m_s2, rate))
            }
            Engine::Mujoco => {
                let model = model(parameters, gravity_ground_m_s2);
                let steps = (1.0 / (rate * LONGEST_STEP_S)).ceil() as usize;
                Ok(SimulatedRun::simulate(&model, run, rate, steps)?)
            }
        }
    }

    /// What defects of the measuring chain make of the voltages and of what is written down of them.
    pub(super) fn spoil(
        &self,
        index: usize,
        voltage_v: &mut [[f64; LIMBS]],
        gains: &mut Gains,
        parameters: &Parameters,
        chain: &Chain,
        rng: &mut Pcg64,
    ) {
        let here = |place: &Where| place.holds(Some(index));
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
            }) if *trial == index => {
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
            }) if *trial == index => {
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
                    row[*channel] = (row[*channel] + volts * sample as f64 / samples)
                        .clamp(-chain.full_scale_v, chain.full_scale_v);
                }
            }
            _ => {}
        }
    }
}

/// The sensor as MuJoCo has it.
pub(super) fn model(parameters: &Parameters, gravity_ground_m_s2: DVec3) -> SensorModel {
    SensorModel {
        geometry: Geometry::PAPER,
        mass_kg: MASS_KG,
        inertia_per_mass: parameters.inertia_per_mass,
        stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
        damping_ratio: DAMPING_RATIO,
        gravity_ground_m_s2,
    }
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
