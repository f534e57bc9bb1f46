//! How well each parameter is known, and what limits it.
//!
//! Two things spread an estimate. What differs from sample to sample and from trial to trial, noise, wedges, mounting, shows in
//! the data: the steps' covariance has the noise, and leaving out one wedge after the other (the jackknife) has all of it. What
//! is the same in all trials does not show: the standards' gain errors, for which the certificates' classes stand. A class is
//! a limit, not a standard deviation: 95 % of an even spread within it lie within 0.95 of it.

pub(crate) mod rest;

use glam::DVec3;
use sixaxis_core::decouple::uncertainty::Covariance;
use sixaxis_core::parameter::{INERTIA, Parameter, SCALE};
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{LIMBS, Parameters};
use sixaxis_page::number::percent;

use crate::report::ParameterReport;
use crate::steps::{Campaign, FourSteps, jackknife};
use crate::tap::Taps;
use crate::trial::same_wedge;
use sixaxis_recordings::session::{Role, Session};

/// Half width of the 95 % interval of an even spread, in its half width.
const EVEN_95: f64 = 0.95;

/// A fit whose condition number grows by this factor when a trial is left out rests on that trial: the others do not determine the unknowns.
const WORSE_CONDITION: f64 = 30.0;
/// An interval wider than the parameter itself determines nothing, not even its sign.
const NOTHING_KNOWN: f64 = 1.0;

/// Estimates without one wedge after the other: the trials that share a direction share its error, so that they are left out
/// together. Where the others do not determine the parameters, the trial alone is left out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LeftOut {
    /// For each linear trial, scale factors that it had no part in, 1/kg; none where nothing is determined without it.
    pub scale: Vec<Option<[f64; LIMBS]>>,
    /// For each angular trial, inertias that it had no part in, m^2.
    pub inertia: Vec<Option<[f64; 6]>>,
    /// Scale factors without each wedge, or each trial where wedges are too few.
    scale_spread: Vec<[f64; LIMBS]>,
    /// Inertias likewise.
    inertia_spread: Vec<[f64; 6]>,
}

/// Wedges from which leaving one out after the other is a jackknife.
const WEDGES_WANTED: usize = 4;

impl LeftOut {
    /// Fits steps 2 and 3 without one wedge after the other.
    pub fn fit(campaign: &Campaign, steps: &FourSteps) -> Self {
        let wedges = |role: Role| -> Vec<usize> {
            let directions: Vec<DVec3> = campaign
                .trials
                .iter()
                .filter(|(trial, _)| trial.role == role)
                .map(|(trial, _)| trial.direction_ground)
                .collect();
            directions
                .iter()
                .map(|d| {
                    let same = |other: &DVec3| same_wedge(*other, *d);
                    directions.iter().position(same).unwrap_or(0)
                })
                .collect()
        };
        let parameters = steps.found();
        let scale_without = |takes: &dyn Fn(usize) -> bool| -> Option<[f64; LIMBS]> {
            let fitted = campaign.scale(&steps.drift, takes).ok()?;
            let whole = &steps.scale.estimate;
            (fitted.estimate.condition < WORSE_CONDITION * whole.condition)
                .then_some(fitted.estimate.values)
        };
        let gain = steps.rate_over_reading.map_or(1.0, |gain| gain.0);
        let inertia_without = |takes: &dyn Fn(usize) -> bool| -> Option<[f64; 6]> {
            let rows = campaign.angular(&parameters, takes).ok()?;
            let fitted = rows.solve_at_gain(gain).ok()?;
            let whole = &steps.inertia.estimate;
            (fitted.estimate.condition < WORSE_CONDITION * whole.condition)
                .then_some(fitted.estimate.values)
        };
        let (scale, scale_spread) = leave_out(&wedges(Role::Linear), &scale_without);
        let (inertia, inertia_spread) = leave_out(&wedges(Role::Angular), &inertia_without);
        Self {
            scale,
            inertia,
            scale_spread,
            inertia_spread,
        }
    }
}

/// For each trial the fit that it had no part in, and the fits to take a jackknife of.
type Fits<const N: usize> = (Vec<Option<[f64; N]>>, Vec<[f64; N]>);

/// A fit of the trials that are taken.
type Fit<'a, const N: usize> = dyn Fn(&dyn Fn(usize) -> bool) -> Option<[f64; N]> + 'a;

/// `wedges` holds for each trial the first trial of its direction.
///
/// A trial is left out alone only where its wedge cannot be left out, or where wedges are too few: a fit takes as long as there are trials, and
/// one for each of them takes as long as their square.
fn leave_out<const N: usize>(wedges: &[usize], fit: &Fit<N>) -> Fits<N> {
    let without_wedge: Vec<Option<[f64; N]>> = (0..wedges.len())
        .map(|trial| {
            (wedges[trial] == trial)
                .then(|| fit(&|index| wedges[index] != trial))
                .flatten()
        })
        .collect();
    let by_wedge: Vec<[f64; N]> = without_wedge.iter().flatten().copied().collect();
    let enough = by_wedge.len() >= WEDGES_WANTED;
    let alone: Vec<Option<[f64; N]>> = (0..wedges.len())
        .map(|out| {
            let wanted = !enough || without_wedge[wedges[out]].is_none();
            wanted.then(|| fit(&|index| index != out)).flatten()
        })
        .collect();
    let spread = if enough {
        by_wedge
    } else {
        alone.iter().flatten().copied().collect()
    };
    let each = (0..wedges.len())
        .map(|trial| without_wedge[wedges[trial]].or(alone[trial]))
        .collect();
    (each, spread)
}

/// Jackknife of one entry of some fits.
fn spread<const N: usize>(fits: &[[f64; N]], entry: usize) -> Option<f64> {
    let values: Vec<f64> = fits.iter().map(|fit| fit[entry]).collect();
    jackknife(&values)
}

/// Reports on all 25 parameters.
///
/// `noise` is the covariance that noise leaves, propagated through the steps. Without it each fit's own covariance stands for
/// it, which takes rows of a filtered record for independent and earlier steps for exact.
pub fn report(
    session: &Session,
    steps: &FourSteps,
    left_out: &LeftOut,
    noise: Option<&Covariance>,
) -> Vec<ParameterReport> {
    let propagated = |place: usize, own: f64| {
        noise.map_or(own, |covariance| covariance[(place, place)].max(0.0).sqrt())
    };
    let design = session.sensor.design();
    let used = steps.used();
    let mut reports = Vec::with_capacity(25);
    for limb in 0..LIMBS {
        reports.push(finish(
            Parameter::Drift(limb),
            used.zero_drift_v[limb],
            design.zero_drift_v[limb],
            Some(NORMAL_95 * steps.drift.standard_error_v[limb]),
            None,
            None,
        ));
    }
    let accelerometer = EVEN_95 * session.accelerometer.class_percent / 100.0;
    let gyroscope = EVEN_95 * session.gyroscope.class_percent / 100.0;
    let errors = steps.scale.estimate.standard_error();
    for (limb, error) in errors.into_iter().enumerate() {
        let value = used.scale_per_mass_per_kg[limb];
        let trials = spread(&left_out.scale_spread, limb);
        reports.push(finish(
            Parameter::Scale(limb),
            value,
            design.scale_per_mass_per_kg[limb],
            Some(NORMAL_95 * propagated(SCALE.start + limb, error)),
            trials.map(|t| NORMAL_95 * t),
            Some(accelerometer * value.abs()),
        ));
    }
    let errors = steps.inertia.estimate.standard_error();
    let values = used.inertia_per_mass.to_paper_order();
    let designs = design.inertia_per_mass.to_paper_order();
    // Torques carry the accelerometer's gain through s/m, and the gyroscope's where it is trusted.
    let standards = match steps.rate_over_reading {
        None => accelerometer.hypot(gyroscope),
        Some((_, error)) => accelerometer.hypot(NORMAL_95 * error),
    };
    // What the scale factors differ by, the torques differ by.
    let scale_differs = (0..LIMBS)
        .filter_map(|limb| {
            let value = used.scale_per_mass_per_kg[limb];
            Some(spread(&left_out.scale_spread, limb)? / value.abs())
        })
        .fold(0.0, f64::max);
    for entry in 0..6 {
        let trials = spread(&left_out.inertia_spread, entry)
            .map(|own| own.hypot(scale_differs * values[entry]));
        reports.push(finish(
            Parameter::Inertia(entry),
            values[entry],
            designs[entry],
            Some(NORMAL_95 * propagated(INERTIA.start + entry, errors[entry])),
            trials.map(|t| NORMAL_95 * t),
            Some(standards * values[entry].abs()),
        ));
    }
    reports.push(stiffness(steps, &used, &design, &reports));
    reports
}

/// A report on a parameter whose interval has these parts.
pub(crate) fn finish(
    parameter: Parameter,
    estimate: f64,
    design: f64,
    from_noise: Option<f64>,
    from_trials: Option<f64>,
    from_standards: Option<f64>,
) -> ParameterReport {
    // The jackknife sees the noise, too; the larger of both stands for what differs.
    let differs = from_noise.unwrap_or(0.0).max(from_trials.unwrap_or(0.0));
    let same = from_standards.unwrap_or(0.0);
    let half_width = differs.hypot(same);
    let determined = is_determined(parameter, estimate, half_width);
    let dominated_by = if same > differs {
        "class of the standards"
    } else if from_trials > from_noise {
        "differences between trials"
    } else {
        "noise"
    };
    ParameterReport {
        parameter,
        unit: parameter.unit().to_owned(),
        estimate,
        design,
        half_width_95: Some(half_width),
        from_noise,
        from_trials,
        from_standards,
        dominated_by: dominated_by.to_owned(),
        determined,
        remark: if determined {
            String::new()
        } else {
            "not determined: the trials do not even agree on its sign".to_owned()
        },
    }
}

/// Whether an interval leaves anything known of a parameter other than k/m.
pub(crate) fn is_determined(parameter: Parameter, estimate: f64, half_width: f64) -> bool {
    !parameter.has_size() || half_width < NOTHING_KNOWN * estimate.abs()
}

/// Error of the scale factors against each other, relative, up to which step 4's minimum is k/m to a thousandth: with twice to six times as much
/// most searches have none (report, section on identifiability). A factor that all have in common does no harm.
pub const SCALE_ERROR_FOR_STIFFNESS: f64 = 1e-5;

/// What to do where k/m is not determined.
pub(crate) const TAP_IT: &str = "k/m cannot be had from this campaign: tap the shell, held by the rig, sample at 50 kHz and enter the recording with role = \"tap\"";

/// Puts k/m by taps in the place of what step 4 says of it.
pub fn put_taps(reports: &mut [ParameterReport], taps: &Taps) {
    let (Some(found), Some(report)) = (
        &taps.stiffness,
        reports
            .iter_mut()
            .find(|report| report.parameter == Parameter::Stiffness),
    ) else {
        return;
    };
    report.estimate = found.per_mass_per_s2;
    report.half_width_95 = Some(found.half_width_95);
    report.from_noise = Some(found.from_noise);
    report.from_standards = Some(found.from_known);
    let parts = [
        (found.from_noise, "noise"),
        (found.from_known, "what steps 2 and 3 leave"),
        (found.from_holding, "how still the shell is held"),
    ];
    let largest = parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    report.dominated_by = largest.map_or("", |(_, what)| what).to_owned();
    report.determined = true;
    report.remark = match found.taps {
        1 => "from a tap".to_owned(),
        n => format!("from {n} taps"),
    };
}

fn stiffness(
    steps: &FourSteps,
    used: &Parameters,
    design: &Parameters,
    known: &[ParameterReport],
) -> ParameterReport {
    let against_each_other = |p: &ParameterReport| {
        let differs = p
            .from_noise
            .unwrap_or(0.0)
            .max(p.from_trials.unwrap_or(0.0));
        differs / p.estimate.abs()
    };
    let worst = known[LIMBS..2 * LIMBS]
        .iter()
        .map(against_each_other)
        .fold(0.0, f64::max);
    let determined = steps.stiffness_is_determined() && worst <= SCALE_ERROR_FOR_STIFFNESS;
    let remark = match &steps.stiffness {
        None => format!(
            "not determined: there is no trial of role high_frequency_linear; the design's value is used. {TAP_IT}"
        ),
        Some(_) if determined => String::new(),
        Some(found) if steps.stiffness_is_determined() => format!(
            "not to be relied on: the search has a minimum at {:.2e} 1/s², but that needs scale factors right to {} against each other and has them to {}. {TAP_IT}",
            found.grid_minimum_per_s2,
            percent(SCALE_ERROR_FOR_STIFFNESS, 1),
            percent(worst, 1)
        ),
        Some(_) => format!(
            "not determined: needs scale factors right to {} against each other, has them to {}; the design's value is used, which the decoupled accelerations do not notice at the rig's frequencies. {TAP_IT}",
            percent(SCALE_ERROR_FOR_STIFFNESS, 1),
            percent(worst, 1)
        ),
    };
    ParameterReport {
        parameter: Parameter::Stiffness,
        unit: Parameter::Stiffness.unit().to_owned(),
        estimate: used.stiffness_per_mass_per_s2,
        design: design.stiffness_per_mass_per_s2,
        half_width_95: None,
        from_noise: None,
        from_trials: None,
        from_standards: None,
        dominated_by: if determined {
            "grid of the search"
        } else {
            "errors of the scale factors"
        }
        .to_owned(),
        determined,
        remark,
    }
}

#[cfg(test)]
mod tests;
