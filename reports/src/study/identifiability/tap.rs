//! One tap on the study's sensor, evaluated with what steps 2 and 3 found.

use anyhow::{Context, Result};
use nalgebra::Matrix6;
use rand_pcg::Pcg64;
use sixaxis_calibration::propagation::Propagated;
use sixaxis_calibration::steps::{Campaign, FourSteps};
use sixaxis_core::identify::tap::{Setup, identify};
use sixaxis_core::parameter::{INERTIA, SCALE};
use sixaxis_core::{Gains, LIMBS, Parameters, Sensor};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulate;
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::rig::tap::{DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE, Tap};

use crate::study::results::identifiability::KnownTap;

/// Random stream of the tap: beyond those of all trials.
const STREAM: u128 = 1 << 20;
/// Relative standard deviation of an amplifier range's gain about another's: a tap is recorded in other ranges than step 2.
const RANGE_DEVIATION: f64 = 0.005;

/// Plays and evaluates it.
///
/// # Errors
/// Those of the simulation. A tap that cannot be evaluated says so in the answer.
pub fn study(
    laboratory: &Laboratory,
    campaign: &Campaign,
    steps: &FourSteps,
    propagated: &Propagated,
) -> Result<KnownTap> {
    let truth = &laboratory.sensor;
    let mut rng = Pcg64::new(u128::from(laboratory.seed), STREAM);
    let gravity = Mounting::AxisVertical.gravity_ground_m_s2(glam::DVec3::Z);
    let model = SensorModel::new(truth, gravity);
    let tap = Tap::random(&mut rng);
    let motion =
        simulate(&model, &tap, DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE).context("a tap")?;
    let forces = &motion.limb_force_per_mass_m_s2;
    let chain = &laboratory.chain;
    let gain_n_per_v = chain.amplifier_ranges(forces, truth);
    let voltage_v = chain.record(forces, truth, &gain_n_per_v, SAMPLE_RATE_HZ, &mut rng);
    // From here on only what a laboratory has.
    let sensor = Sensor {
        geometry: campaign.geometry,
        gains: Gains { gain_n_per_v },
    };
    let found = steps.found();
    let setup = Setup {
        sensor: &sensor,
        parameters: &Parameters {
            stiffness_per_mass_per_s2: campaign.design.stiffness_per_mass_per_s2,
            ..found
        },
        inertia_covariance_m4: inertia_covariance(propagated),
        gain_deviation: gain_deviation(&found, propagated),
        sample_rate_hz: SAMPLE_RATE_HZ,
        full_scale_v: chain.full_scale_v,
    };
    let refused = |cause: String| KnownTap {
        truth_per_s2: truth.stiffness_per_mass_per_s2,
        found_per_s2: None,
        refused: Some(cause),
    };
    Ok(match identify(&setup, &voltage_v) {
        Ok(tap) if tap.verdict.is_determined() => KnownTap {
            truth_per_s2: truth.stiffness_per_mass_per_s2,
            found_per_s2: Some((tap.stiffness_per_mass_per_s2, tap.interval_95_per_s2())),
            refused: None,
        },
        Ok(tap) => refused(format!(
            "standard error of ln k/m {:.1e}",
            tap.standard_error_ln
        )),
        Err(error) => refused(error.to_string()),
    })
}

fn inertia_covariance(propagated: &Propagated) -> Matrix6<f64> {
    propagated
        .total()
        .fixed_view::<6, 6>(INERTIA.start, INERTIA.start)
        .into()
}

/// About what the channels have in common, which a tap does not notice: the accelerometer's gain is in no entry.
fn gain_deviation(found: &Parameters, propagated: &Propagated) -> [f64; LIMBS] {
    core::array::from_fn(|limb| {
        let place = SCALE.start + limb;
        let variance = propagated.noise[(place, place)] + propagated.wedges[(place, place)];
        let own = variance.max(0.0).sqrt() / found.scale_per_mass_per_kg[limb].abs();
        RANGE_DEVIATION.hypot(own)
    })
}
