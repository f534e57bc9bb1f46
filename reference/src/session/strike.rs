//! One tap recorded: a blow on the shell, nine voltages at 50 kHz, no standards.

use rand_pcg::Pcg64;
use sixaxis_recordings::session::{Entry, PerLimb, Role};

use super::defect::{Defect, Where};
use super::play::{PlayError, Played};
use super::record::{Recorder, chain, model};
use crate::chain::amplifier_ranges;
use crate::rig::Mounting;
use crate::tap::{Blow, DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE};

/// Random stream of the first tap: beyond those of a thousand trials of each step.
const FIRST_TAP_STREAM: u128 = 1 << 20;
/// What no trial is numbered.
const NO_TRIAL: usize = usize::MAX;

/// Simulated time of a trial that takes as long to play, ms: a tap's steps are a tenth as long.
pub(super) const WORK_MS: u64 = 300;

impl Recorder<'_> {
    /// Records the tap with this number. Defects that are everywhere are here, too.
    pub fn strike(&self, index: usize) -> Result<Played, PlayError> {
        let plan = self.plan;
        let mut rng = Pcg64::new(u128::from(plan.seed), FIRST_TAP_STREAM + index as u128);
        let mut parameters = *self.parameters;
        let gravity = Mounting::AxisVertical.gravity_ground_m_s2(glam::DVec3::Z);
        let mut motion = Blow::random(&mut rng).play(
            &model(&parameters, gravity),
            DURATION_S,
            SAMPLE_RATE_HZ,
            STEPS_PER_SAMPLE,
        )?;
        if let Some(Defect::SwappedChannels {
            channels: [a, b],
            place: Where::Everywhere,
        }) = self.defect
        {
            for force in &mut motion.limb_force_per_mass_m_s2 {
                force.swap(*a, *b);
            }
            parameters.scale_per_mass_per_kg.swap(*a, *b);
            parameters.zero_drift_v.swap(*a, *b);
        }
        let chain = chain(plan);
        let forces = &motion.limb_force_per_mass_m_s2;
        let mut gains = amplifier_ranges(forces, &parameters, chain.full_scale_v);
        let mut voltage_v = chain.record(forces, &parameters, &gains, SAMPLE_RATE_HZ, &mut rng);
        self.spoil(
            NO_TRIAL,
            &mut voltage_v,
            &mut gains,
            &parameters,
            &chain,
            &mut rng,
        );
        let factor = match self.defect {
            Some(Defect::WrongSampleRate {
                place: Where::Everywhere,
                factor,
            }) => *factor,
            _ => 1.0,
        };
        Ok(Played {
            entry: Entry {
                file: format!("tap-{:02}", index + 1).into(),
                role: Role::Tap,
                direction: None,
                down: None,
                frequency_hz: None,
                sample_rate_hz: None,
                gain_n_per_v: Some(PerLimb::Each(gains.gain_n_per_v)),
                reference_file: None,
                reference_start_s: None,
                reference_sample_rate_hz: None,
                channels: None,
            },
            sample_rate_hz: SAMPLE_RATE_HZ * factor,
            voltage_v,
            accelerometer_m_s2: Vec::new(),
            gyroscope_rad_s: Vec::new(),
            truth: motion.truth,
        })
    }
}
