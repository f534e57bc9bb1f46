//! One trial recorded: the rig's run, the limbs' voltages, the instruments' readings, each with what `spoil` makes of it.

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;

use super::Laboratory;
use super::defect::Defect;
use super::error::SessionError;
use super::mount::{MOUNTS, Mount};
use super::plan::{Engine, SessionPlan};
use super::recording::SimulatedRecording;
use super::schedule::PlannedTrial;
use crate::limbs::{Limbs, shown_of_rods_m_s2};
use crate::motion::SimulatedRun;
use crate::paper::GRAVITY_M_S2;
use crate::rig::run::{Mounting, Run};
use crate::rigid::RigidSensor;
use crate::sensor::TrueSensor;

/// Random stream of the first trial.
const FIRST_TRIAL_STREAM: u128 = 64;

/// Records the trials of one session.
pub(super) struct Recorder<'a> {
    /// What is played, which is not what the session file says if the defect is the rig's.
    pub plan: &'a SessionPlan,
    pub defect: Option<&'a Defect>,
    pub laboratory: Laboratory,
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
        let number = Some(index);
        let mut laboratory = Laboratory {
            sensor: self.sensor_of(number),
            ..self.laboratory
        };
        let mount = &self.mounts[trial.wedge.unwrap_or(MOUNTS - 1)];
        let run = Run {
            direction_ground: self.true_direction(trial, mount),
            centre_offset_shell_m: mount.centre_offset_shell_m,
            ..trial.run
        };
        let stated_direction = trial.run.direction_ground;
        let mut simulated = self.simulate(&run, stated_direction, mount, &laboratory.sensor)?;
        let forces = &mut simulated.limb_force_per_mass_m_s2;
        self.exchange(number, forces, &mut laboratory.sensor);
        let mut rng = Pcg64::new(
            u128::from(self.plan.seed),
            FIRST_TRIAL_STREAM + index as u128,
        );
        let sensed = self.sensed(
            number,
            &simulated.limb_force_per_mass_m_s2,
            simulated.sample_rate_hz,
            &laboratory.sensor,
        );
        let mut recording = laboratory.record_voltages(&simulated, &sensed, &mut rng);
        self.spoil_voltages(number, &mut recording, &laboratory);
        laboratory.read_instruments(&simulated, &mut recording, &mut rng);
        self.spoil_readings(index, &mut recording);
        Ok(SimulatedRecording {
            name: trial.name.clone(),
            role: trial.role,
            direction_ground: stated_direction,
            gravity_ground_m_s2: self.stated_gravity(trial),
            ..recording
        })
    }

    fn simulate(
        &self,
        run: &Run,
        stated_direction: DVec3,
        mount: &Mount,
        sensor: &TrueSensor,
    ) -> Result<SimulatedRun, SessionError> {
        let gravity_by_mounting_m_s2 = match self.plan.rig.mounting {
            Mounting::AxisVertical => self
                .plan
                .rig
                .mounting
                .gravity_ground_m_s2(run.direction_ground),
            // A wedge that misses its direction carries the sensor along, and gravity stands in it elsewhere by as much.
            Mounting::AxisLevel => {
                DQuat::from_rotation_arc(stated_direction, run.direction_ground)
                    * self.plan.rig.mounting.gravity_ground_m_s2(stated_direction)
            }
        };
        let gravity_ground_m_s2 = if self.plan.rig.axis_tilt_deg > 0.0 {
            mount.plumb.of(gravity_by_mounting_m_s2.normalize()) * GRAVITY_M_S2
        } else {
            gravity_by_mounting_m_s2
        };
        self.plan.simulate(run, sensor, gravity_ground_m_s2)
    }
}

impl SessionPlan {
    /// A run of a sensor in the plan's engine, with the plan's limbs.
    ///
    /// # Errors
    /// [`SessionError`]: limbs that do not hold the mass, MuJoCo's own errors, a build without MuJoCo.
    pub fn simulate(
        &self,
        run: &Run,
        sensor: &TrueSensor,
        gravity_ground_m_s2: DVec3,
    ) -> Result<SimulatedRun, SessionError> {
        let mut played = self.play(run, sensor, gravity_ground_m_s2)?;
        if self.rod_mass > 0.0 {
            let forces = played.limb_force_per_mass_m_s2.iter_mut();
            for (forces, motion) in forces.zip(&played.truth) {
                let geometry = &sensor.geometry;
                let of_rods =
                    shown_of_rods_m_s2(geometry, self.rod_mass, motion, gravity_ground_m_s2);
                forces
                    .iter_mut()
                    .zip(of_rods)
                    .for_each(|(f, own)| *f += own);
            }
        }
        Ok(played)
    }

    fn play(
        &self,
        run: &Run,
        sensor: &TrueSensor,
        gravity_ground_m_s2: DVec3,
    ) -> Result<SimulatedRun, SessionError> {
        let rate = self.sample_rate_hz;
        match self.engine {
            Engine::Rigid => {
                let rigid = RigidSensor::new(sensor, &self.stiffness_ratio());
                let rigid = rigid.ok_or_else(|| {
                    SessionError::plan("chain.stiffness_spread", "the limbs do not hold the mass")
                })?;
                Ok(rigid.simulate(run, gravity_ground_m_s2, rate))
            }
            Engine::Mujoco => in_mujoco(run, sensor, self.true_limbs(), gravity_ground_m_s2, rate),
        }
    }
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
