//! One trial recorded: the rig's run, the limbs' voltages, the instruments' readings and what a defect makes of them.

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::Laboratory;
use super::continuous::at;
use super::defect::{Defect, Where};
use super::error::SessionError;
use super::mount::{MOUNTS, Mount};
use super::plan::{Engine, SessionPlan};
use super::recording::SimulatedRecording;
use super::schedule::{PlannedTrial, foreign_sensor, tilted};
use crate::geometry::LIMBS;
use crate::limbs::Limbs;
use crate::motion::SimulatedRun;
use crate::paper::GRAVITY_M_S2;
use crate::rig::run::{Mounting, Run};
use crate::rigid::RigidSensor;
use crate::sensor::TrueSensor;

/// Random stream of the first trial.
const FIRST_TRIAL_STREAM: u128 = 64;

/// Records the trials of one session.
pub(super) struct Recorder<'a> {
    pub plan: &'a SessionPlan,
    pub defect: Option<&'a Defect>,
    pub laboratory: Laboratory,
    /// How the sensor truly hangs.
    pub mounting: Mounting,
    /// How it stands on each wedge, and on what is no wedge.
    pub mounts: [Mount; MOUNTS],
}

impl Recorder<'_> {
    /// Records the trial with this number.
    pub fn record(
        &self,
        index: usize,
        trial: &PlannedTrial,
    ) -> Result<SimulatedRecording, SessionError> {
        let here = |place: &Where| place.holds(Some(index));
        let mut laboratory = self.laboratory;
        if let Some(Defect::ForeignTrial { trial, seed }) = self.defect
            && *trial == index
        {
            laboratory.sensor = foreign_sensor(*seed);
        }
        let mount = &self.mounts[trial.wedge.unwrap_or(MOUNTS - 1)];
        let run = Run {
            direction_ground: self.true_direction(trial, mount),
            centre_offset_shell_m: mount.centre_offset_shell_m,
            ..trial.run
        };
        let stated_direction = trial.run.direction_ground;
        let mut simulated = self.simulate(&run, stated_direction, mount, &laboratory.sensor)?;
        if let Some(Defect::SwappedChannels { channels, place }) = self.defect
            && here(place)
        {
            swap_limbs(
                *channels,
                &mut simulated.limb_force_per_mass_m_s2,
                &mut laboratory.sensor,
            );
        }
        let mut rng = Pcg64::new(
            u128::from(self.plan.seed),
            FIRST_TRIAL_STREAM + index as u128,
        );
        let mut recording = laboratory.record_voltages(&simulated, &mut rng);
        self.spoil_voltages(Some(index), &mut recording, &laboratory, &mut rng);
        laboratory.read_instruments(&simulated, &mut recording, &mut rng);
        self.spoil_readings(index, &mut recording);
        let stated_mounting = match self.defect {
            Some(Defect::GravityNotHandled { level: true }) => Mounting::AxisVertical,
            Some(Defect::GravityNotHandled { level: false }) => Mounting::AxisLevel,
            _ => trial.mounting,
        };
        Ok(SimulatedRecording {
            name: trial.name.clone(),
            role: trial.role,
            direction_ground: stated_direction,
            gravity_ground_m_s2: stated_mounting.gravity_ground_m_s2(stated_direction),
            ..recording
        })
    }

    /// The direction that wedge and workshop make of the stated one.
    fn true_direction(&self, trial: &PlannedTrial, mount: &Mount) -> DVec3 {
        let stated = trial.run.direction_ground;
        let Some(index) = trial.wedge else {
            return stated;
        };
        let direction = mount.wedge.of(stated);
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
        mount: &Mount,
        sensor: &TrueSensor,
    ) -> Result<SimulatedRun, SessionError> {
        let gravity_by_mounting_m_s2 = match self.mounting {
            Mounting::AxisVertical => self.mounting.gravity_ground_m_s2(run.direction_ground),
            // A wedge that misses its direction carries the sensor along, and gravity stands in it elsewhere by as much.
            Mounting::AxisLevel => {
                DQuat::from_rotation_arc(stated_direction, run.direction_ground)
                    * self.mounting.gravity_ground_m_s2(stated_direction)
            }
        };
        let gravity_ground_m_s2 = if self.plan.rig.axis_tilt_deg > 0.0 {
            mount.plumb.of(gravity_by_mounting_m_s2.normalize()) * GRAVITY_M_S2
        } else {
            gravity_by_mounting_m_s2
        };
        let rate = self.plan.sample_rate_hz;
        match self.plan.engine {
            Engine::Rigid => {
                let rigid = RigidSensor::new(sensor, &self.plan.stiffness_ratio());
                let rigid = rigid.ok_or_else(|| {
                    SessionError::plan("chain.stiffness_spread", "the limbs do not hold the mass")
                })?;
                Ok(rigid.simulate(run, gravity_ground_m_s2, rate))
            }
            Engine::Mujoco => {
                let limbs = self.plan.true_limbs();
                in_mujoco(run, sensor, limbs, gravity_ground_m_s2, rate)
            }
        }
    }

    /// What defects of the measuring chain make of the voltages and of what is written down of them. A tap has no number.
    pub(super) fn spoil_voltages(
        &self,
        index: Option<usize>,
        recording: &mut SimulatedRecording,
        laboratory: &Laboratory,
        rng: &mut Pcg64,
    ) {
        let here = |place: &Where| place.holds(index);
        let Laboratory { sensor, chain, .. } = laboratory;
        let gains = &mut recording.gain_n_per_v;
        let voltage_v = &mut recording.voltage_v;
        match self.defect {
            Some(Defect::DeadLimb { channel, place }) if here(place) => {
                let converter = chain.converter();
                for row in voltage_v {
                    row[*channel] = converter.convert(sensor.zero_drift_v[*channel], rng);
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
            }) if Some(*trial) == index => {
                let zero = sensor.zero_drift_v[*channel];
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
            }) if here(place) => gains[*channel] *= factor,
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
            }) if Some(*trial) == index => {
                // In the channel's own volts, of the force that the strongest channel feels.
                let h = |i: usize| 1.0 / sensor.scale_per_mass_per_kg[i];
                let strongest = (0..LIMBS)
                    .map(|i| {
                        let zero = sensor.zero_drift_v[i];
                        voltage_v
                            .iter()
                            .fold(0.0_f64, |a, row| a.max((row[i] - zero).abs()))
                            * gains[i]
                            / h(i)
                    })
                    .fold(0.0, f64::max);
                let volts = share * strongest * h(*channel) / gains[*channel];
                let samples = voltage_v.len() as f64;
                for (sample, row) in voltage_v.iter_mut().enumerate() {
                    row[*channel] = (row[*channel] + volts * sample as f64 / samples)
                        .clamp(-chain.full_scale_v, chain.full_scale_v);
                }
            }
            _ => {}
        }
    }

    /// What defects make of the instruments' readings and of the sample rate that is written down.
    fn spoil_readings(&self, index: usize, recording: &mut SimulatedRecording) {
        let rate = recording.sample_rate_hz;
        let accelerometer = &mut recording.accelerometer_m_s2;
        let gyroscope = &mut recording.gyroscope_rad_s;
        match self.defect {
            Some(Defect::WrongAccelerometer { factor }) => {
                accelerometer.iter_mut().for_each(|a| *a *= factor);
            }
            Some(Defect::WrongGyroscope { factor }) => {
                gyroscope.iter_mut().for_each(|w| *w *= factor);
            }
            Some(Defect::ReferenceClock {
                place,
                late_s,
                rate_error,
            }) if place.holds(Some(index)) => {
                for series in [accelerometer, gyroscope] {
                    *series = on_other_clock(series, rate, *late_s, *rate_error);
                }
            }
            Some(Defect::WrongSampleRate { place, factor }) if place.holds(Some(index)) => {
                recording.sample_rate_hz *= factor;
            }
            _ => {}
        }
    }
}

/// Exchanges the plugs of two limbs: limb and piezo come along, the amplifier stays.
pub(super) fn swap_limbs([a, b]: [usize; 2], forces: &mut [[f64; LIMBS]], sensor: &mut TrueSensor) {
    for force in forces {
        force.swap(a, b);
    }
    sensor.scale_per_mass_per_kg.swap(a, b);
    sensor.zero_drift_v.swap(a, b);
}

#[cfg(feature = "mujoco")]
fn in_mujoco(
    run: &Run,
    sensor: &TrueSensor,
    limbs: Limbs,
    gravity_ground_m_s2: DVec3,
    sample_rate_hz: f64,
) -> Result<SimulatedRun, SessionError> {
    use crate::mujoco::model::SensorModel;
    /// Runge-Kutta steps are at most this long, s: the modes reach 6.7 kHz.
    const LONGEST_STEP_S: f64 = 2e-5;
    let model = SensorModel {
        limbs,
        ..SensorModel::new(sensor, gravity_ground_m_s2)
    };
    let steps = (1.0 / (sample_rate_hz * LONGEST_STEP_S)).ceil() as usize;
    Ok(crate::mujoco::simulate_run(
        &model,
        run,
        sample_rate_hz,
        steps,
    )?)
}

#[cfg(not(feature = "mujoco"))]
fn in_mujoco(
    _run: &Run,
    _sensor: &TrueSensor,
    _limbs: Limbs,
    _gravity_ground_m_s2: DVec3,
    _sample_rate_hz: f64,
) -> Result<SimulatedRun, SessionError> {
    Err(SessionError::without_mujoco("engine"))
}

/// A series as a recorder takes it whose samples come late and at another rate. At the ends the first and the last value stand.
fn on_other_clock(series: &[f64], rate_hz: f64, late_s: f64, rate_error: f64) -> Vec<f64> {
    (0..series.len())
        .map(|i| at(series, i as f64 / (1.0 + rate_error) + late_s * rate_hz))
        .collect()
}
