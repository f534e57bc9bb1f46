//! One tap recorded: nine voltages at 50 kHz, no reference instruments.

use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::defect::Kind;
use super::error::SessionError;
use super::recording::SimulatedRecording;
use super::spoil::size_of;
use super::trial::Recorder;
use crate::limbs::Limbs;
use crate::motion::SimulatedMotion;
use crate::rig::tap::{SAMPLE_RATE_HZ, Tap};
use crate::sensor::TrueSensor;

/// Random stream of the first tap: beyond those of a thousand trials of each step.
const FIRST_TAP_STREAM: u128 = 1 << 20;

/// Simulated time of a trial that takes as long to simulate, ms: a tap's steps are a tenth as long.
pub(super) const WORK_MS: u64 = 300;

impl Recorder<'_> {
    /// Records the tap with this number. Defects that are everywhere are here, too.
    pub fn record_tap(&self, index: usize) -> Result<SimulatedRecording, SessionError> {
        let seed = u128::from(self.plan.seed);
        let mut rng = Pcg64::new(seed, FIRST_TAP_STREAM + index as u128);
        let mut laboratory = self.laboratory;
        laboratory.sensor = self.sensor_of(None);
        let limbs = self.plan.true_limbs();
        let mut motion = in_mujoco(&Tap::random(&mut rng), &laboratory.sensor, limbs)?;
        let forces = &mut motion.limb_force_per_mass_m_s2;
        self.exchange(None, forces, &mut laboratory.sensor);
        let chain = &laboratory.chain;
        let sensor = &laboratory.sensor;
        let gains = chain.amplifier_ranges(forces, sensor);
        let forces = self.sensed(None, forces, SAMPLE_RATE_HZ, sensor);
        let mut recording = SimulatedRecording {
            gain_n_per_v: gains,
            voltage_v: chain.record(&forces, sensor, &gains, SAMPLE_RATE_HZ, &mut rng),
            truth: motion.truth,
            ..SimulatedRecording::of_nothing(
                &format!("tap-{:02}", index + 1),
                Role::Tap,
                SAMPLE_RATE_HZ,
                chain.full_scale_v,
            )
        };
        self.spoil_voltages(None, &mut recording, &laboratory);
        recording.sample_rate_hz *= size_of(self.defect, Kind::SampleRate).exp();
        Ok(recording)
    }
}

#[cfg(feature = "mujoco")]
fn in_mujoco(
    tap: &Tap,
    sensor: &TrueSensor,
    limbs: Limbs,
) -> Result<SimulatedMotion<Tap>, SessionError> {
    use crate::mujoco::model::SensorModel;
    use crate::rig::run::Mounting;
    use crate::rig::tap::{DURATION_S, STEPS_PER_SAMPLE};
    let gravity = Mounting::AxisVertical.gravity_ground_m_s2(glam::DVec3::Z);
    let model = SensorModel {
        limbs,
        ..SensorModel::new(sensor, gravity)
    };
    let simulated =
        crate::mujoco::simulate(&model, tap, DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE)?;
    Ok(simulated)
}

#[cfg(not(feature = "mujoco"))]
fn in_mujoco(
    _tap: &Tap,
    _sensor: &TrueSensor,
    _limbs: Limbs,
) -> Result<SimulatedMotion<Tap>, SessionError> {
    Err(SessionError::without_mujoco("rig.taps"))
}
