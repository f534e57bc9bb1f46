//! Runs that were never fitted, decoupled and held against the standards.
//!
//! They are compared in sensor axes, where no attitude is needed: the change of the specific force since the rest, and the angular
//! acceleration. In ground axes an axis that is a tenth of a degree off the plumb line weighs as much as everything else together,
//! and that is the rig's.

use glam::{DQuat, DVec3};
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::{Decoupler, Parameters, Scheme};

use crate::calibration::CalibratedLimbs;
use crate::conditioning::Conditioned;
use crate::diagnosis::trial_case::angles;
use crate::finding::{Cause, Finding};
use crate::grade::worst;
use crate::report::{TrialReport, ValidationRun};
use crate::steps::Campaign;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Share of the largest peak that an axis is measured by at least.
const FLOOR: f64 = 0.1;
/// What validation runs are decoupled with.
#[derive(Debug)]
pub(super) struct Decoding<'a> {
    pub parameters: &'a Parameters,
    pub limbs: Option<CalibratedLimbs>,
}

/// Decouples the validation runs and holds them against the standards; with them those that cannot be decoupled.
pub(super) fn validate(
    campaign: &Campaign,
    decoding: &Decoding<'_>,
    reports: &mut [TrialReport],
) -> (Vec<ValidationRun>, Vec<Finding>) {
    let (mut validation_runs, mut refused) = (Vec::new(), Vec::new());
    for ((trial, conditioned), report) in campaign.trials.iter().zip(reports) {
        if trial.role != Role::Validation {
            continue;
        }
        match compare(campaign, trial, conditioned, decoding) {
            Ok(run) => {
                report.validation = Some(errors(&run, arm_m(&campaign.design)));
                validation_runs.push(run);
            }
            Err(error) => {
                let evidence = format!("cannot be decoupled with this calibration: {error}");
                let advice = "look at the trial's curves in the report";
                refused.push(Finding::new(Cause::Unexplained, evidence, advice).in_trial(trial));
            }
        }
    }
    (validation_runs, refused)
}

/// The most that any axis of the validation runs departs by, decoupled so; none without one, or where one cannot be decoupled.
pub(super) fn largest_error(campaign: &Campaign, decoding: &Decoding<'_>) -> Option<f64> {
    let arm_m = arm_m(&campaign.design);
    let of = |(trial, conditioned): &(Trial, Conditioned)| {
        let run = compare(campaign, trial, conditioned, decoding).ok()?;
        Some(worst(&errors(&run, arm_m)))
    };
    let runs = campaign.trials.iter();
    let runs = runs.filter(|(trial, _)| trial.role == Role::Validation);
    let all: Vec<f64> = runs.map(of).collect::<Option<_>>()?;
    (!all.is_empty()).then(|| worst(&all))
}

/// Decouples a run and sets it beside its standards.
pub(super) fn compare(
    campaign: &Campaign,
    trial: &Trial,
    conditioned: &Conditioned,
    decoding: &Decoding<'_>,
) -> sixaxis_core::Result<ValidationRun> {
    let parameters = decoding.parameters;
    let sensor = trial.sensor(campaign.geometry);
    let mut settings = trial.settings(Scheme::HeunSubstepped);
    let mut rows = conditioned.voltage_v.clone();
    if let Some(limbs) = &decoding.limbs {
        settings.rod_mass = limbs.rod_mass;
        let cross_talk = limbs.undone(&sensor, parameters)?;
        for row in &mut rows {
            *row = cross_talk.undo(row);
        }
    }
    // A run of the rig ends as it began, at rest: what the open loop has gathered by then is drift.
    let (rows, _) = rest_to_rest::detrend(&sensor, parameters, &settings, &rows)?;
    let mut decoupler = Decoupler::new(&sensor, parameters, &settings)?;
    let mut run = ValidationRun {
        name: trial.name.clone(),
        sample_rate_hz: trial.sample_rate_hz,
        first: 1,
        standard: Vec::new(),
        decoupled: Vec::new(),
    };
    let gravity = settings.gravity_ground_m_s2;
    let by_standards: Vec<DVec3> = in_sensor_axes(trial, conditioned).collect();
    for row in &rows {
        let Some(out) = decoupler.push(row)? else {
            continue;
        };
        let index = out.sample as usize;
        let back = out.attitude.inverse();
        let standard = [by_standards[index], conditioned.angular_shell_rad_s2[index]];
        let decoupled = [
            felt(back, out.linear_ground_m_s2, gravity),
            back * out.angular_ground_rad_s2,
        ];
        let six = |pair: [DVec3; 2]| -> [f64; 6] { core::array::from_fn(|i| pair[i / 3][i % 3]) };
        run.standard.push(six(standard));
        run.decoupled.push(six(decoupled));
    }
    Ok(run)
}

/// Change of the specific force since the rest in sensor axes, m/s^2, of an acceleration in ground axes.
fn felt(back: DQuat, linear_ground_m_s2: DVec3, gravity_ground_m_s2: DVec3) -> DVec3 {
    back * (linear_ground_m_s2 - gravity_ground_m_s2) + gravity_ground_m_s2
}

/// The change of the specific force since the rest by a run's standards, sensor axes, m/s^2.
pub(super) fn in_sensor_axes<'a>(
    trial: &'a Trial,
    conditioned: &'a Conditioned,
) -> impl Iterator<Item = DVec3> + 'a {
    // Of such a run the mean of the acceleration is none: what the standard shows of one is its own zero, or gravity on the rig's axis.
    let readings = &conditioned.linear_ground_m_s2;
    let zero = readings.iter().sum::<DVec3>() / readings.len().max(1) as f64;
    // The sensor begins in its own axes and turns about one that keeps its direction: what the gyroscope has turned is its attitude.
    let turned = angles(conditioned, trial);
    readings.iter().zip(turned).map(move |(reading, turned)| {
        let attitude = DQuat::from_axis_angle(trial.direction_ground, turned);
        felt(
            attitude.inverse(),
            reading - zero,
            trial.gravity_ground_m_s2,
        )
    })
}

/// Radius of gyration, m: the arm over which an angular acceleration weighs as much as a linear one.
pub(super) fn arm_m(design: &Parameters) -> f64 {
    let inertia = &design.inertia_per_mass;
    ((inertia.xx_m2 + inertia.yy_m2 + inertia.zz_m2) / 3.0).sqrt()
}

/// Largest error of each axis over its peak, or over a tenth of the largest peak of all: an axis that does not move has nothing
/// else to be measured by.
pub(super) fn errors(run: &ValidationRun, arm_m: f64) -> [f64; 6] {
    let mut peak = [0.0_f64; 6];
    let mut off = [0.0_f64; 6];
    for (standard, decoupled) in run.standard.iter().zip(&run.decoupled) {
        for axis in 0..6 {
            peak[axis] = worst(&[peak[axis], standard[axis].abs()]);
            off[axis] = worst(&[off[axis], (standard[axis] - decoupled[axis]).abs()]);
        }
    }
    let linear = worst(&peak[..3]);
    let angular = worst(&peak[3..]);
    core::array::from_fn(|axis| {
        let floor = if axis < 3 {
            linear.max(angular * arm_m)
        } else {
            angular.max(linear / arm_m)
        };
        off[axis] / peak[axis].max(FLOOR * floor)
    })
}
