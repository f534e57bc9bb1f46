//! A recording from the field for a session's sensor: tumbled by hand after the day in the laboratory, a limb perhaps drifted since.

use rand_pcg::Pcg64;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_recordings::session::{Entry, PerLimb, Role};

use super::plan::SessionPlan;
use super::play::{PlayError, Played};
use super::record::chain;
use crate::chain::amplifier_ranges;
use crate::field::{Field, Pace, compliant_forces_m_s2, unequal_forces_m_s2};
use crate::rigid::RigidSensor;

/// Random stream of the tumble: beyond those of taps.
const TUMBLE_STREAM: u128 = 1 << 21;
/// Samples per second.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;

/// Plays a tumble of `duration_s` in closed form, limb by limb with scale factors that are larger by `drift` than in the laboratory.
///
/// # Errors
/// [`PlayError::Plan`] for limbs that do not hold the mass.
pub fn tumble(
    plan: &SessionPlan,
    duration_s: f64,
    drift: &[f64; LIMBS],
) -> Result<Played, PlayError> {
    let mut rng = Pcg64::new(u128::from(plan.seed), TUMBLE_STREAM);
    let mut parameters = plan.parameters();
    let field = Field::by_hand(&mut rng, Pace::Brisk, duration_s, SAMPLE_RATE_HZ);
    let (loads, truth) = field.play(&parameters);
    let forces = if plan.chain.stiffness_spread > 0.0 {
        RigidSensor::new(
            &Geometry::PAPER,
            &parameters.inertia_per_mass,
            &plan.stiffness_ratio(),
        )
        .map(|sensor| unequal_forces_m_s2(&sensor, &loads))
    } else {
        compliant_forces_m_s2(
            &Geometry::PAPER,
            parameters.stiffness_per_mass_per_s2,
            &loads,
        )
    };
    let forces = forces.ok_or_else(|| PlayError::Plan {
        key: "chain.stiffness_spread".to_owned(),
        cause: "limbs that do not hold the mass".to_owned(),
    })?;
    let chain = chain(plan);
    // Ranges are set in the laboratory, before anything drifts.
    let gains = amplifier_ranges(&forces, &parameters, chain.full_scale_v);
    for (scale, drift) in parameters.scale_per_mass_per_kg.iter_mut().zip(drift) {
        *scale *= 1.0 + drift;
    }
    let voltage_v = chain.record(&forces, &parameters, &gains, SAMPLE_RATE_HZ, &mut rng);
    Ok(Played {
        entry: Entry {
            file: "tumble".into(),
            role: Role::Validation,
            direction: None,
            down: Some([0.0, 0.0, -1.0]),
            frequency_hz: None,
            sample_rate_hz: None,
            gain_n_per_v: Some(PerLimb::Each(gains.gain_n_per_v)),
            reference_file: None,
            reference_start_s: None,
            reference_sample_rate_hz: None,
            channels: None,
        },
        sample_rate_hz: SAMPLE_RATE_HZ,
        voltage_v,
        accelerometer_m_s2: Vec::new(),
        gyroscope_rad_s: Vec::new(),
        truth,
    })
}
