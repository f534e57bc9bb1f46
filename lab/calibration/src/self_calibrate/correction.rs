//! What a calibration says of its own scale factors, and a calibration with others.

use crate::calibration::{Calibration, STIFFNESS_SD};
use crate::report::Grade;
use anyhow::{Result, ensure};
use sixaxis_core::LIMBS;
use sixaxis_core::redundancy::self_calibration::PerLimbs;
use sixaxis_core::significance::NORMAL_95;

/// What the coordination equations are held against: ln of each limb's stiffness over the mean, and the covariance of
/// ln (s_i/m)/(k_i/k), both by the joint fit; of a calibration that knows no stiffnesses, those of an ordinary laboratory.
///
/// # Errors
/// Those of [`covariance_of_ln_scale`].
pub fn strains_per_v(calibration: &Calibration) -> Result<([f64; LIMBS], PerLimbs)> {
    if let Some(limbs) = &calibration.limbs {
        let covariance = PerLimbs::from_fn(|i, j| limbs.strain_covariance[i][j]);
        return Ok((limbs.stiffness_ratio.map(f64::ln), covariance));
    }
    let ordinary = PerLimbs::identity() * STIFFNESS_SD.powi(2);
    Ok((
        [0.0; LIMBS],
        covariance_of_ln_scale(calibration)? + ordinary,
    ))
}

/// Standard deviation of the error that all ln s_i/m have in common: the accelerometer's gain, of which no ratio says anything.
pub fn common_deviation(calibration: &Calibration) -> f64 {
    let scale = &calibration.parameters.scale_per_mass_per_kg;
    let standards = calibration.covariance.propagated.as_ref();
    let total = standards.and_then(|all| all.total());
    total.map_or(0.0, |total| {
        let relative =
            PerLimbs::from_fn(|i, j| total[(LIMBS + i, LIMBS + j)] / (scale[i] * scale[j]));
        relative.mean().max(0.0).sqrt()
    })
}

/// Covariance of ln s_i/m by noise and by what differs between trials; the standards' gain, which all nine share, drops out.
///
/// # Errors
/// A table that is not nine by nine.
fn covariance_of_ln_scale(calibration: &Calibration) -> Result<PerLimbs> {
    let table = &calibration.covariance.scale_per_mass_per_kg2;
    ensure!(
        table.len() == LIMBS && table.iter().all(|row| row.len() == LIMBS),
        "the calibration's covariance of the scale factors is not 9 by 9; --calibration-exact does without"
    );
    let scale = &calibration.parameters.scale_per_mass_per_kg;
    let own = calibration.covariance.propagated.as_ref();
    let mut covariance = PerLimbs::from_fn(|i, j| {
        let noise = own
            .and_then(|all| all.noise.get(LIMBS + i)?.get(LIMBS + j).copied())
            .unwrap_or(table[i][j]);
        noise / (scale[i] * scale[j])
    });
    // Trials differ by more than noise where wedges or mounting do.
    for (limb, report) in calibration
        .intervals
        .iter()
        .skip(LIMBS)
        .take(LIMBS)
        .enumerate()
    {
        let trials = report.from_trials.unwrap_or(0.0) / NORMAL_95 / scale[limb];
        let variance = &mut covariance[(limb, limb)];
        *variance = variance.max(trials * trials);
    }
    Ok(covariance)
}

/// The calibration with its scale factors changed by these logarithms. It is good with reservations at best: no standard saw it.
pub fn corrected(
    mut calibration: Calibration,
    ln_change: &[f64; LIMBS],
    deviation: &[f64; LIMBS],
) -> Calibration {
    for limb in 0..LIMBS {
        let (ln, deviation) = (ln_change[limb], deviation[limb]);
        if ln == 0.0 {
            continue;
        }
        if let Some(limbs) = &mut calibration.limbs {
            limbs.loosen(limb, deviation);
        }
        let scale = &mut calibration.parameters.scale_per_mass_per_kg[limb];
        *scale *= ln.exp();
        if let Some(report) = calibration.intervals.get_mut(LIMBS + limb) {
            report.estimate = *scale;
            let own = NORMAL_95 * deviation * scale.abs();
            report.half_width_95 = report.half_width_95.map(|old| old.hypot(own));
            "self-calibrated in the field".clone_into(&mut report.remark);
        }
    }
    if calibration.verdict == Grade::Good {
        calibration.verdict = Grade::Reserved;
    }
    calibration
}
