//! What each trial says for or against a calibration: its fit, a fit without it, the coordination equations.

use glam::DVec3;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::COORDINATION;
use sixaxis_core::{InertiaPerMass, LIMBS, Parameters};

use crate::conditioning::Conditioned;
use crate::diagnosis::timing;
use crate::diagnosis::trial_case::TrialCase;
use crate::drive;
use crate::interval::LeftOut;
use crate::report::TrialReport;
use crate::response::ChannelResponse;
use crate::steps::{Campaign, FourSteps, rows};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

pub(super) fn trial_report(case: &TrialCase<'_>, departure: Option<f64>) -> TrialReport {
    let trial = case.trial;
    let largest = trial
        .voltage_v
        .iter()
        .flatten()
        .fold(0.0_f64, |a, u| a.max(u.abs()));
    let residual = case.response.as_ref().map(|response| {
        let sum = |get: fn(&ChannelResponse) -> f64| -> f64 {
            response
                .channels
                .iter()
                .map(|c| get(c) * get(c))
                .sum::<f64>()
                .sqrt()
        };
        sum(|c| c.residual_n) / sum(|c| c.signal_n)
    });
    TrialReport {
        name: trial.name.clone(),
        role: trial.role,
        frequency_hz: trial.frequency_hz,
        seen_hz: drive::seen_hz(trial),
        direction: trial.direction_ground.to_array(),
        sample_rate_hz: trial.sample_rate_hz,
        samples: trial.voltage_v.len(),
        largest_over_full_scale: largest / trial.full_scale_v,
        outliers: case.conditioned.outliers,
        departure,
        residual,
        residual_correlation: None,
        lag_s: timing::lag_of(case),
        hold_out: None,
        coordination: None,
        validation: None,
    }
}

/// Predicts each trial of steps 2 and 3 by the fit that did not see it.
pub(super) fn hold_out(
    campaign: &Campaign,
    steps: &FourSteps,
    left_out: &LeftOut,
    reports: &mut [TrialReport],
) {
    let (mut linear, mut angular) = (0, 0);
    let gain = steps.rate_over_reading.map_or(1.0, |gain| gain.0);
    for ((trial, conditioned), report) in campaign.trials.iter().zip(reports) {
        let mut parameters = steps.found();
        match trial.role {
            Role::Linear => {
                let fitted = left_out.scale.get(linear).copied().flatten();
                linear += 1;
                let Some(scale) = fitted else { continue };
                parameters.scale_per_mass_per_kg = scale;
                let residuals = linear_residuals(trial, conditioned, &parameters);
                report.hold_out = Some(residuals.0);
                report.residual_correlation = residuals.1;
            }
            Role::Angular => {
                let fitted = left_out.inertia.get(angular).copied().flatten();
                angular += 1;
                let Some(inertia) = fitted else { continue };
                parameters.inertia_per_mass = InertiaPerMass::from_paper_order(inertia);
                let residuals = angular_residuals(campaign, trial, conditioned, &parameters, gain);
                report.hold_out = Some(residuals.0);
                report.residual_correlation = residuals.1;
            }
            _ => {}
        }
    }
}

/// Residual of (12) over the acceleration, and its correlation from row to row.
fn linear_residuals(
    trial: &Trial,
    conditioned: &Conditioned,
    p: &Parameters,
) -> (f64, Option<f64>) {
    let chain = SignalChain::new(&trial.gains, p);
    let series: Vec<(DVec3, DVec3)> = rows(trial)
        .map(|row| {
            let force = chain.force_per_mass_m_s2(&conditioned.voltage_v[row]);
            let sum: DVec3 = (0..LIMBS).map(|i| DIRECTIONS_SHELL[i] * force[i]).sum();
            (sum, conditioned.linear_ground_m_s2[row])
        })
        .collect();
    residuals(&series)
}

/// Residual of (15) over the torque, and its correlation from row to row; `gain` is the true rate over the gyroscope's reading.
fn angular_residuals(
    campaign: &Campaign,
    trial: &Trial,
    conditioned: &Conditioned,
    p: &Parameters,
    gain: f64,
) -> (f64, Option<f64>) {
    let chain = SignalChain::new(&trial.gains, p);
    let arms_m = campaign.geometry.arms_m();
    let series: Vec<(DVec3, DVec3)> = rows(trial)
        .map(|row| {
            let force = chain.force_per_mass_m_s2(&conditioned.voltage_v[row]);
            let torque: DVec3 = (0..LIMBS).map(|i| arms_m[i] * force[i]).sum();
            let euler = euler_torque(
                &p.inertia_per_mass,
                gain * conditioned.rate_shell_rad_s[row],
                gain * conditioned.angular_shell_rad_s2[row],
            );
            (torque, euler)
        })
        .collect();
    residuals(&series)
}

fn residuals(series: &[(DVec3, DVec3)]) -> (f64, Option<f64>) {
    let errors: Vec<DVec3> = series.iter().map(|(a, b)| *a - *b).collect();
    let squares: f64 = errors.iter().map(|e| e.length_squared()).sum();
    let signal: f64 = series.iter().map(|(_, b)| b.length_squared()).sum();
    let products: f64 = errors.windows(2).map(|w| w[0].dot(w[1])).sum();
    (
        (squares / signal).sqrt(),
        (squares > 0.0).then(|| products / squares),
    )
}

/// Residuals of the three coordination equations, which no step uses: equal stiffness asks for them.
pub(super) fn coordination(campaign: &Campaign, p: &Parameters, reports: &mut [TrialReport]) {
    for ((trial, conditioned), report) in campaign.trials.iter().zip(reports) {
        let chain = SignalChain::new(&trial.gains, p);
        let mut sums = [0.0; 3];
        let mut total = 0.0;
        for row in rows(trial) {
            let force = chain.force_per_mass_m_s2(&conditioned.voltage_v[row]);
            for (sum, limbs) in sums.iter_mut().zip(COORDINATION) {
                let s: f64 = limbs.iter().map(|i| force[*i]).sum();
                *sum += s * s;
            }
            total += force.iter().map(|f| f * f).sum::<f64>() / LIMBS as f64;
        }
        if total > 0.0 {
            // Four forces of the usual size, were they independent.
            report.coordination = Some(sums.map(|s| (s / (4.0 * total)).sqrt()));
        }
    }
}
