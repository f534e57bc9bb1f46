//! A recording from the field for a session's sensor: tumbled by hand after the day in the laboratory, a limb perhaps drifted since.

use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::error::SessionError;
use super::plan::SessionPlan;
use super::recording::SimulatedRecording;
use crate::compliant::compliant_forces_m_s2;
use crate::geometry::LIMBS;
use crate::rig::field::{Field, Pace};
use crate::rigid::RigidSensor;

/// Random stream of the tumble: beyond those of taps.
const TUMBLE_STREAM: u128 = 1 << 21;
/// Samples per second.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;

/// Records a tumble of `duration_s` in closed form, limb by limb with scale factors that are larger by `drift` than in the
/// laboratory.
///
/// # Errors
/// [`SessionError::Plan`] for limbs that do not hold the mass.
pub fn record_tumble(
    plan: &SessionPlan,
    duration_s: f64,
    drift: &[f64; LIMBS],
) -> Result<SimulatedRecording, SessionError> {
    let mut rng = Pcg64::new(u128::from(plan.seed), TUMBLE_STREAM);
    let mut sensor = plan.true_sensor();
    let field = Field::by_hand(&mut rng, Pace::Brisk, duration_s, SAMPLE_RATE_HZ);
    let (loads, truth) = field.simulate(&sensor);
    let forces = if plan.chain.stiffness_spread > 0.0 {
        RigidSensor::new(&sensor, &plan.stiffness_ratio())
            .map(|rigid| loads.iter().map(|load| rigid.forces_m_s2(load)).collect())
    } else {
        compliant_forces_m_s2(&sensor, field.gravity_ground_m_s2, &truth)
    };
    let forces = forces.ok_or_else(|| {
        SessionError::plan("chain.stiffness_spread", "limbs that do not hold the mass")
    })?;
    let chain = plan.measuring_chain();
    // Ranges are set in the laboratory, before anything drifts.
    let gain_n_per_v = chain.amplifier_ranges(&forces, &sensor);
    for (scale, drift) in sensor.scale_per_mass_per_kg.iter_mut().zip(drift) {
        *scale *= 1.0 + drift;
    }
    // As at the end of the day, from the tumble's first sample on.
    let channels = plan.true_channels(1.0);
    let forces: Vec<[f64; LIMBS]> = match forces.first().copied() {
        Some(rest) => forces
            .iter()
            .map(|force| {
                let change = channels.shown(force, &rest, &sensor);
                core::array::from_fn(|i| rest[i] + change[i])
            })
            .collect(),
        None => forces,
    };
    Ok(SimulatedRecording {
        gain_n_per_v,
        voltage_v: chain.record(&forces, &sensor, &gain_n_per_v, SAMPLE_RATE_HZ, &mut rng),
        gravity_ground_m_s2: field.gravity_ground_m_s2,
        truth,
        ..SimulatedRecording::of_nothing(
            "tumble",
            Role::Validation,
            SAMPLE_RATE_HZ,
            chain.full_scale_v,
        )
    })
}
