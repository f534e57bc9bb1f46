//! Everything about a session, judged: is this calibration good, and if not, what next?
//!
//! Good is a promise: nothing was found wrong, every parameter that a rig can determine is determined, trials that were left out
//! of a fit are predicted by it, and runs that were never fitted come out as the standards show them. k/m is no part of it: the
//! paper's band does not determine it, and what is decoupled there does not notice.

use std::path::Path;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::rest_to_rest;
use sixaxis_core::signal::SignalChain;
use sixaxis_core::{Decoupler, LIMBS, Parameters, Scheme};

use crate::calibration::{
    CalibratedParameters, CalibratedSensor, Calibration, Covariance, FORMAT, Provenance,
};
use crate::cleaning::{Cleaned, Cleaning};
use crate::error::{Error, Result};
use crate::interval::{LeftOut, ParameterReport, report};
use crate::load;
use crate::session::{Limits, Role, SessionFile};
use crate::steps::{Campaign, FourSteps, GyroscopeGain, rows};
use crate::suspicion::{Cause, Facts, Finding, examine};
use crate::trial::Trial;

/// The judgement in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Use it.
    Good,
    /// Nothing is known to be wrong, but something that would prove it is missing.
    Reserved,
    /// Do not use it.
    Bad,
}

impl Grade {
    /// The word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Reserved => "good with reservations",
            Self::Bad => "not good",
        }
    }
}

/// One trial as it came out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrialReport {
    /// Its file.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// Unit vector of travel and axis, sensor axes at rest.
    pub direction: [f64; 3],
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Samples.
    pub samples: usize,
    /// Largest voltage over the converter's limit.
    pub largest_over_full_scale: f64,
    /// Samples replaced by the outlier test, all channels.
    pub outliers: usize,
    /// Departure of the channels from what all trials agree on, relative to the trial's own size.
    pub departure: Option<f64>,
    /// Residual of the fit over the signal, root mean squares, all channels.
    pub residual: Option<f64>,
    /// Correlation of neighbouring residuals of its step's equation, at the distance of the rows that are fitted: 0 is white.
    pub residual_correlation: Option<f64>,
    /// Time by which the standards lag, s.
    pub lag_s: Option<f64>,
    /// Error of the prediction of this trial by a fit without it, over the trial's signal, root mean squares.
    pub hold_out: Option<f64>,
    /// Residual of each of the three coordination equations over the forces in them, root mean squares.
    pub coordination: Option<[f64; 3]>,
    /// Validation runs: largest error of each decoupled acceleration against the standards over the run's peak on that axis
    /// (or over a tenth of the largest peak, where an axis has less).
    pub validation: Option<[f64; 6]>,
}

/// What a validation run looks like, for the report: time, s; standards and decoupled, m/s^2 and rad/s^2.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// File.
    pub name: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// First sample that is decoupled.
    pub first: usize,
    /// Six accelerations of the standards.
    pub standard: Vec<[f64; 6]>,
    /// Six accelerations decoupled.
    pub decoupled: Vec<[f64; 6]>,
}

/// A session, judged.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// In one word.
    pub grade: Grade,
    /// In one sentence.
    pub sentence: String,
    /// What is wrong, worst first.
    pub findings: Vec<Finding>,
    /// What is missing, where nothing is wrong.
    pub reservations: Vec<String>,
    /// What to do next.
    pub next: Vec<String>,
    /// The four steps, if they could be done.
    pub steps: Option<FourSteps>,
    /// Why they could not be done: the step and its reason.
    pub obstacle: Option<String>,
    /// The 25 parameters; empty if the steps could not be done.
    pub parameters: Vec<ParameterReport>,
    /// The trials.
    pub trials: Vec<TrialReport>,
    /// Validation runs in full.
    pub comparisons: Vec<Comparison>,
    /// Recordings as read and as cleaned, for before and after; the static one last.
    pub recordings: Vec<(Trial, Option<Cleaned>)>,
    /// The calibration to be written, if there is one.
    pub calibration: Option<Calibration>,
}

/// Largest coordination residual that a good calibration has: limbs whose stiffnesses differ by so much are not nine of a kind.
pub const COORDINATION_LIMIT: f64 = 0.1;
/// Share of the largest peak that an axis is measured by at least.
const FLOOR: f64 = 0.1;
/// A bar that is missed by this factor is no matter of opinion.
const BEYOND_DOUBT: f64 = 2.0;
/// Standard errors by which the gyroscope's gain must leave its class to be called wrong.
const GAIN_SIGNIFICANT: f64 = 5.0;
/// Trials of a step from which leaving one out proves something.
const TRIALS_WANTED: usize = 6;
/// Corner of the low-pass for validation runs over the drive's frequency: what is compared there is the gyroscope's second
/// derivative, and its noise must stay out. The drive loses 7e-6, the same on both sides.
pub const VALIDATION_CORNER: f64 = 4.4;

/// What the caller is told while it works.
pub trait Watch: Sync {
    /// A stage begins that has so many parts.
    fn stage(&self, name: &str, parts: usize);
    /// One part is done.
    fn part(&self);
}

/// Nobody watches.
pub struct Unwatched;

impl Watch for Unwatched {
    fn stage(&self, _: &str, _: usize) {}
    fn part(&self) {}
}

/// Calibrates and judges a session.
///
/// A recording that cannot be used is a finding, not an error: the rest is still worth knowing.
///
/// # Errors
/// [`Error::Session`] only: a session whose own statements cannot be.
pub fn judge(file: &SessionFile, watch: &dyn Watch) -> Result<Judgement> {
    let entries = &file.session.recording;
    watch.stage("reading", entries.len());
    let loaded: Vec<Result<Trial>> = (0..entries.len())
        .into_par_iter()
        .map(|index| {
            let trial = load::trial(file, index);
            watch.part();
            trial
        })
        .collect();
    let mut findings = Vec::new();
    let mut at_rest = None;
    let mut moving = Vec::new();
    for (entry, trial) in entries.iter().zip(loaded) {
        match trial {
            Ok(trial) if entry.role == Role::Static && at_rest.is_none() => at_rest = Some(trial),
            // The first static record counts; one more at the end of the day does no harm.
            Ok(_) if entry.role == Role::Static => {}
            Ok(trial) => moving.push(trial),
            Err(error @ Error::Session { .. }) => return Err(error),
            Err(error) => {
                findings.push(unreadable(
                    &entry.file.display().to_string(),
                    error.to_string(),
                ));
            }
        }
    }
    if at_rest.is_none() && findings.is_empty() {
        findings.push(Finding {
            cause: Cause::Unreadable,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: "the session has no static record, and step 1 needs one".to_owned(),
            advice: "record the sensor at rest for ten minutes and enter it with role = \"static\""
                .to_owned(),
        });
    }
    let cleaning = Cleaning::of(&file.session);
    watch.stage("cleaning", moving.len());
    let cleaned: Vec<(Trial, sixaxis_core::Result<Cleaned>)> = moving
        .into_par_iter()
        .map(|trial| {
            let mut own = cleaning.clone();
            if trial.role == Role::Validation
                && let crate::session::Stage::On(low_pass) = &mut own.stages.low_pass
            {
                low_pass.times_drive = VALIDATION_CORNER;
                low_pass.plus_hz = 0.0;
            }
            let cleaned = own.clean(&trial);
            watch.part();
            (trial, cleaned)
        })
        .collect();
    let mut trials = Vec::new();
    for (trial, cleaned) in cleaned {
        match cleaned {
            Ok(cleaned) => trials.push((trial, cleaned)),
            Err(error) => findings.push(unreadable(&trial.name, error.to_string())),
        }
    }
    watch.stage("examining", 1);
    let design = file.design();
    let facts = Facts {
        geometry: file.geometry(),
        design: &design,
        rig: file.session.rig.as_ref(),
        gyroscope_class: file.session.gyroscope.class_percent / 100.0,
        gyroscope_lag_undone: file.session.gyroscope.bandwidth_hz.is_some(),
    };
    let examination = examine(&facts, at_rest.as_ref(), &trials);
    findings.extend(examination.findings);
    let mut reports: Vec<TrialReport> = examination
        .suspects
        .iter()
        .zip(&examination.departures)
        .map(|(suspect, departure)| trial_report(suspect, *departure))
        .collect();
    watch.part();
    let campaign = Campaign {
        geometry: file.geometry(),
        design,
        static_voltage_v: at_rest
            .as_ref()
            .map(|t| t.voltage_v.clone())
            .unwrap_or_default(),
        trials,
    };
    watch.stage("four steps", 3);
    let steps = campaign.identify(GyroscopeGain::Certified {
        class: file.session.gyroscope.class_percent / 100.0,
    });
    watch.part();
    let mut parameters = Vec::new();
    let mut comparisons = Vec::new();
    let mut calibration = None;
    let mut found = None;
    let mut obstacle = None;
    match steps {
        Ok(steps) => {
            let left_out = LeftOut::fit(&campaign, &steps);
            watch.part();
            parameters = report(file, &steps, &left_out);
            let used = used(&steps, &parameters);
            hold_out(&campaign, &steps, &left_out, &mut reports);
            coordination(&campaign, &used, &mut reports);
            comparisons = validate(&campaign, &used, &mut reports, &mut findings);
            watch.part();
            found = Some(steps);
        }
        Err(error) => {
            if findings.is_empty() {
                findings.push(Finding {
                    cause: Cause::Unexplained,
                    recordings: Vec::new(),
                    channels: Vec::new(),
                    evidence: error.to_string(),
                    advice: "look at the table of trials in the report".to_owned(),
                });
            }
            obstacle = Some(error.to_string());
        }
    }
    if findings.is_empty() {
        let class = file.session.gyroscope.class_percent / 100.0;
        findings = failures(&file.session.limits, &reports, found.as_ref(), class);
    }
    let open: Vec<&ParameterReport> = parameters
        .iter()
        .filter(|p| !p.determined && p.name != "k/m")
        .collect();
    if !open.is_empty() && findings.is_empty() {
        let names: Vec<&str> = open.iter().map(|p| p.name.as_str()).collect();
        findings.push(Finding {
            cause: Cause::UnderExcitedAxis,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: format!(
                "the trials leave {} open: their 95 % intervals are wider than the values themselves",
                names.join(", ")
            ),
            advice: "record more trials of steps 2 and 3, on more wedges".to_owned(),
        });
    }
    findings.sort_by_key(|finding| finding.cause);
    let rig_is_known = file
        .session
        .rig
        .as_ref()
        .is_some_and(|rig| rig.stroke_mm.is_some() && rig.rotation_amplitude_deg.is_some());
    let reservations = reservations(
        &campaign,
        &file.session.limits,
        rig_is_known,
        &parameters,
        &reports,
    );
    let (grade, sentence) = grade(&findings, &reservations, &reports, found.is_some());
    let mut next: Vec<String> = Vec::new();
    for finding in &findings {
        let advice = format!("{}{}", place(finding), finding.advice);
        if !next.contains(&advice) {
            next.push(advice);
        }
    }
    next.extend(reservations.iter().cloned());
    if let Some(steps) = &found {
        calibration = Some(to_file(file, grade, &findings, steps, &parameters));
    }
    let mut recordings: Vec<(Trial, Option<Cleaned>)> = campaign
        .trials
        .into_iter()
        .map(|(trial, cleaned)| (trial, Some(cleaned)))
        .collect();
    recordings.extend(at_rest.map(|rest| (rest, None)));
    Ok(Judgement {
        grade,
        sentence,
        findings,
        reservations,
        next,
        steps: found,
        obstacle,
        parameters,
        trials: reports,
        comparisons,
        recordings,
        calibration,
    })
}

/// The parameters to decouple with: k/m is the design's unless its report calls it determined.
fn used(steps: &FourSteps, parameters: &[ParameterReport]) -> Parameters {
    let mut used = steps.used();
    if parameters.iter().any(|p| p.name == "k/m" && !p.determined) {
        used.stiffness_per_mass_per_s2 = steps.design_stiffness_per_mass_per_s2;
    }
    used
}

fn unreadable(name: &str, evidence: String) -> Finding {
    Finding {
        cause: Cause::Unreadable,
        recordings: vec![name.to_owned()],
        channels: Vec::new(),
        evidence,
        advice: "mend or replace the recording; `sixaxis inspect` shows what is in it".to_owned(),
    }
}

fn place(finding: &Finding) -> String {
    match finding.recordings.as_slice() {
        [] => String::new(),
        [one] => format!("{one}: "),
        [first, second] => format!("{first} and {second}: "),
        [first, rest @ ..] => format!("{first} and {} more recordings: ", rest.len()),
    }
}

fn trial_report(suspect: &crate::suspicion::Suspect<'_>, departure: Option<f64>) -> TrialReport {
    let trial = suspect.trial;
    let largest = trial
        .voltage_v
        .iter()
        .flatten()
        .fold(0.0_f64, |a, u| a.max(u.abs()));
    let residual = suspect.response.as_ref().map(|response| {
        let sum = |get: fn(&crate::response::ChannelResponse) -> f64| -> f64 {
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
        direction: trial.direction_ground.to_array(),
        sample_rate_hz: trial.sample_rate_hz,
        samples: trial.voltage_v.len(),
        largest_over_full_scale: largest / trial.full_scale_v,
        outliers: suspect.cleaned.outliers,
        departure,
        residual,
        residual_correlation: None,
        lag_s: crate::suspicion::timing::lag_of(suspect),
        hold_out: None,
        coordination: None,
        validation: None,
    }
}

/// Predicts each trial of steps 2 and 3 by the fit that did not see it.
fn hold_out(
    campaign: &Campaign,
    steps: &FourSteps,
    left_out: &LeftOut,
    reports: &mut [TrialReport],
) {
    let (mut linear, mut angular) = (0, 0);
    let gain = steps.rate_over_reading.map_or(1.0, |gain| gain.0);
    for ((trial, cleaned), report) in campaign.trials.iter().zip(reports) {
        let mut parameters = steps.found();
        match trial.role {
            Role::Linear => {
                let fitted = left_out.scale.get(linear).copied().flatten();
                linear += 1;
                let Some(scale) = fitted else { continue };
                parameters.scale_per_mass_per_kg = scale;
                let residuals = linear_residuals(trial, cleaned, &parameters);
                report.hold_out = Some(residuals.0);
                report.residual_correlation = residuals.1;
            }
            Role::Angular => {
                let fitted = left_out.inertia.get(angular).copied().flatten();
                angular += 1;
                let Some(inertia) = fitted else { continue };
                parameters.inertia_per_mass =
                    sixaxis_core::InertiaPerMass::from_paper_order(inertia);
                let residuals = angular_residuals(campaign, trial, cleaned, &parameters, gain);
                report.hold_out = Some(residuals.0);
                report.residual_correlation = residuals.1;
            }
            _ => {}
        }
    }
}

/// Residual of (12) over the acceleration, and its correlation from row to row.
fn linear_residuals(trial: &Trial, cleaned: &Cleaned, p: &Parameters) -> (f64, Option<f64>) {
    let chain = SignalChain::new(&trial.gains, p);
    let series: Vec<(glam::DVec3, glam::DVec3)> = rows(trial)
        .map(|row| {
            let force = chain.force_per_mass_m_s2(&cleaned.voltage_v[row]);
            let sum: glam::DVec3 = (0..LIMBS)
                .map(|i| sixaxis_core::geometry::DIRECTIONS_SHELL[i] * force[i])
                .sum();
            (sum, cleaned.linear_ground_m_s2[row])
        })
        .collect();
    residuals(&series)
}

/// Residual of (15) over the torque, and its correlation from row to row; `gain` is the true rate over the gyroscope's reading.
fn angular_residuals(
    campaign: &Campaign,
    trial: &Trial,
    cleaned: &Cleaned,
    p: &Parameters,
    gain: f64,
) -> (f64, Option<f64>) {
    let chain = SignalChain::new(&trial.gains, p);
    let hinges = campaign.geometry.mass_hinges_m();
    let series: Vec<(glam::DVec3, glam::DVec3)> = rows(trial)
        .map(|row| {
            let force = chain.force_per_mass_m_s2(&cleaned.voltage_v[row]);
            let torque: glam::DVec3 = (0..LIMBS)
                .map(|i| hinges[i].cross(sixaxis_core::geometry::DIRECTIONS_SHELL[i]) * force[i])
                .sum();
            let euler = sixaxis_core::identify::inertia::euler_torque(
                &p.inertia_per_mass,
                gain * cleaned.rate_shell_rad_s[row],
                gain * cleaned.angular_shell_rad_s2[row],
            );
            (torque, euler)
        })
        .collect();
    residuals(&series)
}

fn residuals(series: &[(glam::DVec3, glam::DVec3)]) -> (f64, Option<f64>) {
    let errors: Vec<glam::DVec3> = series.iter().map(|(a, b)| *a - *b).collect();
    let squares: f64 = errors.iter().map(|e| e.length_squared()).sum();
    let signal: f64 = series.iter().map(|(_, b)| b.length_squared()).sum();
    let products: f64 = errors.windows(2).map(|w| w[0].dot(w[1])).sum();
    (
        (squares / signal).sqrt(),
        (squares > 0.0).then(|| products / squares),
    )
}

/// The three coordination equations, which no step uses: equal stiffness asks for them.
const COORDINATION: [[usize; 4]; 3] = [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]];

fn coordination(campaign: &Campaign, p: &Parameters, reports: &mut [TrialReport]) {
    for ((trial, cleaned), report) in campaign.trials.iter().zip(reports) {
        let chain = SignalChain::new(&trial.gains, p);
        let mut sums = [0.0; 3];
        let mut total = 0.0;
        for row in rows(trial) {
            let force = chain.force_per_mass_m_s2(&cleaned.voltage_v[row]);
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

/// Decouples the validation runs and holds them against the standards.
fn validate(
    campaign: &Campaign,
    parameters: &Parameters,
    reports: &mut [TrialReport],
    findings: &mut Vec<Finding>,
) -> Vec<Comparison> {
    let mut comparisons = Vec::new();
    for ((trial, cleaned), report) in campaign.trials.iter().zip(reports) {
        if trial.role != Role::Validation {
            continue;
        }
        match compare(campaign, trial, cleaned, parameters) {
            Ok(comparison) => {
                report.validation = Some(errors(&comparison, arm_m(&campaign.design)));
                comparisons.push(comparison);
            }
            // What made it fail has been found before, or else is news.
            Err(error) if findings.is_empty() => findings.push(Finding {
                cause: Cause::Unexplained,
                recordings: vec![trial.name.clone()],
                channels: Vec::new(),
                evidence: format!("cannot be decoupled with this calibration: {error}"),
                advice: "look at the trial's curves in the report".to_owned(),
            }),
            Err(_) => {}
        }
    }
    comparisons
}

fn compare(
    campaign: &Campaign,
    trial: &Trial,
    cleaned: &Cleaned,
    parameters: &Parameters,
) -> sixaxis_core::Result<Comparison> {
    let sensor = trial.sensor(campaign.geometry);
    let settings = trial.settings(Scheme::HeunSubstepped);
    // A run of the rig ends as it began, at rest: what the open loop has gathered by then is drift.
    let (rows, _) = rest_to_rest::detrend(&sensor, parameters, &settings, &cleaned.voltage_v)?;
    let mut decoupler = Decoupler::new(&sensor, parameters, &settings)?;
    let mut comparison = Comparison {
        name: trial.name.clone(),
        sample_rate_hz: trial.sample_rate_hz,
        first: 1,
        standard: Vec::new(),
        decoupled: Vec::new(),
    };
    for row in &rows {
        let Some(out) = decoupler.push(row)? else {
            continue;
        };
        let index = out.sample as usize;
        // The axis is the same in ground and shell.
        let standard = [
            cleaned.linear_ground_m_s2[index],
            cleaned.angular_shell_rad_s2[index],
        ];
        let decoupled = [out.linear_ground_m_s2, out.angular_ground_rad_s2];
        let six =
            |pair: [glam::DVec3; 2]| -> [f64; 6] { core::array::from_fn(|i| pair[i / 3][i % 3]) };
        comparison.standard.push(six(standard));
        comparison.decoupled.push(six(decoupled));
    }
    Ok(comparison)
}

/// Radius of gyration, m: the arm over which an angular acceleration weighs as much as a linear one.
fn arm_m(design: &Parameters) -> f64 {
    let inertia = &design.inertia_per_mass;
    ((inertia.xx_m2 + inertia.yy_m2 + inertia.zz_m2) / 3.0).sqrt()
}

/// Largest error of each axis over its peak, or over a tenth of the largest peak of all: an axis that does not move has nothing
/// else to be measured by.
fn errors(comparison: &Comparison, arm_m: f64) -> [f64; 6] {
    let mut peak = [0.0_f64; 6];
    let mut off = [0.0_f64; 6];
    for (standard, decoupled) in comparison.standard.iter().zip(&comparison.decoupled) {
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

/// The largest of some errors; what is not a number is infinitely large.
fn worst(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |worst: f64, error| {
        if error.is_nan() {
            f64::INFINITY
        } else {
            worst.max(*error)
        }
    })
}

/// Evidence that fails so badly that no reservation will do.
fn failures(
    limits: &Limits,
    reports: &[TrialReport],
    steps: Option<&FourSteps>,
    gyroscope_class: f64,
) -> Vec<Finding> {
    let mut failures = Vec::new();
    for report in reports {
        let hold_out = report.hold_out.map(|error| worst(&[error]));
        let validation = report.validation.map(|errors| worst(&errors));
        for (error, limit, what) in [
            (
                hold_out,
                limits.hold_out_percent,
                "the other trials predict it only to within",
            ),
            (
                validation,
                limits.validation_percent,
                "decoupled, it departs from the standards by",
            ),
        ] {
            if let Some(error) = error
                && error > BEYOND_DOUBT * limit / 100.0
            {
                failures.push(Finding {
                    cause: Cause::Unexplained,
                    recordings: vec![report.name.clone()],
                    channels: Vec::new(),
                    evidence: format!("{what} {:.1} %, where the session asks for {limit} %", 100.0 * error),
                    advice: "check wedges, mounting and preprocessing; with a level axis, or a wedge off by a tenth of a degree, the open loop is no better".to_owned(),
                });
            }
        }
    }
    if let Some((gain, error)) = steps.and_then(|steps| steps.gyroscope_gain_seen)
        && (gain - 1.0).abs() > gyroscope_class + GAIN_SIGNIFICANT * error
    {
        failures.push(Finding {
            cause: Cause::WrongScaling,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: format!(
                "by Euler's equation the true rate is {gain:.3} ± {error:.3} times the gyroscope's reading, beyond its class of {:.1} %",
                100.0 * gyroscope_class
            ),
            advice: "check unit and sensitivity of the gyroscope against its certificate".to_owned(),
        });
    }
    failures
}

/// What would prove a calibration and is missing, or is less than it should be.
fn reservations(
    campaign: &Campaign,
    limits: &Limits,
    rig_is_known: bool,
    parameters: &[ParameterReport],
    reports: &[TrialReport],
) -> Vec<String> {
    let mut reservations = Vec::new();
    let count = |role: Role| {
        campaign
            .trials
            .iter()
            .filter(|(t, _)| t.role == role)
            .count()
    };
    for (role, what) in [(Role::Linear, "linear"), (Role::Angular, "angular")] {
        let trials = count(role);
        if trials < TRIALS_WANTED {
            reservations.push(format!(
                "{trials} {what} trials leave little to test with: record at least {TRIALS_WANTED}, on three wedges or more"
            ));
        }
    }
    if !rig_is_known {
        reservations.push(
            "state the rig's stroke_mm and rotation_amplitude_deg in [rig]: nothing else checks the scaling of the standards"
                .to_owned(),
        );
    }
    if count(Role::Validation) == 0 {
        reservations.push(
            "record a compound motion (role \"validation\"): nothing here was held against a run that was not fitted".to_owned(),
        );
    }
    // A product of inertia may be zero; the moments and the scale factors may not.
    let wide: Vec<(&ParameterReport, f64)> = parameters
        .iter()
        .filter(|p| {
            ["s", "I1", "I2", "I3"]
                .iter()
                .any(|start| p.name.starts_with(start))
        })
        .filter_map(|p| Some((p, p.half_width_95? / p.estimate.abs())))
        .filter(|(_, share)| *share > limits.interval_percent / 100.0)
        .collect();
    if let Some((worst, share)) = wide.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        let names: Vec<&str> = wide.iter().map(|(p, _)| p.name.as_str()).collect();
        reservations.push(format!(
            "{}: known only to ±{:.0} % at worst ({}), mostly because of {}; repeat trials that load them",
            names.join(", "),
            100.0 * share,
            worst.name,
            worst.dominated_by
        ));
    }
    let uneven: Vec<(&TrialReport, f64)> = reports
        .iter()
        .filter_map(|r| Some((r, worst(&r.coordination?))))
        .filter(|(_, worst)| *worst > COORDINATION_LIMIT)
        .collect();
    if let Some((report, worst)) = uneven.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        reservations.push(format!(
            "in {} recordings the forces break a coordination equation by up to {:.0} % ({}): the limbs are not equally stiff",
            uneven.len(),
            100.0 * worst,
            report.name
        ));
    }
    let resting: Vec<&str> = reports
        .iter()
        .filter(|r| matches!(r.role, Role::Linear | Role::Angular) && r.hold_out.is_none())
        .map(|r| r.name.as_str())
        .collect();
    let enough = count(Role::Linear).min(count(Role::Angular)) >= TRIALS_WANTED;
    if !resting.is_empty() && enough && !parameters.is_empty() {
        reservations.push(format!(
            "{}: without it a direction is not excited, so that nothing tests it: record another on its wedge",
            resting.join(", ")
        ));
    }
    for report in reports {
        if let Some(error) = report.hold_out
            && error > limits.hold_out_percent / 100.0
        {
            reservations.push(format!(
                "{}: the other trials predict it only to within {:.1} % (the session asks for {} %): repeat it",
                report.name,
                100.0 * error,
                limits.hold_out_percent
            ));
        }
        if let Some(errors) = report.validation {
            let worst = worst(&errors);
            if worst > limits.validation_percent / 100.0 {
                reservations.push(format!(
                    "{}: decoupled, it departs from the standards by {:.1} % (the session asks for {} %); at low frequency a wedge that is off by a tenth of a degree does as much as 15 %",
                    report.name,
                    100.0 * worst,
                    limits.validation_percent
                ));
            }
        }
    }
    reservations
}

fn grade(
    findings: &[Finding],
    reservations: &[String],
    reports: &[TrialReport],
    identified: bool,
) -> (Grade, String) {
    if let Some(first) = findings.first() {
        let mut causes: Vec<Cause> = findings.iter().map(|f| f.cause).collect();
        causes.dedup();
        let more = match causes.as_slice() {
            [_, second] => format!("; also: {}", second.words()),
            [_, second, rest @ ..] => {
                format!("; also: {} and {} more", second.words(), rest.len())
            }
            _ => String::new(),
        };
        let mut places: Vec<&str> = findings
            .iter()
            .filter(|f| f.cause == first.cause)
            .flat_map(|f| f.recordings.iter().map(String::as_str))
            .collect();
        places.sort_unstable();
        places.dedup();
        let place = match places.as_slice() {
            [] => String::new(),
            [one] => format!(" in {one}"),
            [one, two] => format!(" in {one} and {two}"),
            [one, rest @ ..] => format!(" in {one} and {} more recordings", rest.len()),
        };
        return (
            Grade::Bad,
            format!("Not good: {}{place}{more}.", first.cause.words()),
        );
    }
    if !identified {
        return (
            Grade::Bad,
            "Not good: the four steps could not be done.".to_owned(),
        );
    }
    let worst = reports
        .iter()
        .filter_map(|r| r.validation)
        .map(|errors| worst(&errors))
        .fold(0.0, f64::max);
    if reservations.is_empty() {
        (
            Grade::Good,
            format!(
                "Good: nothing was found wrong, and runs that were not fitted come out within {:.1} % of the standards.",
                100.0 * worst
            ),
        )
    } else {
        (
            Grade::Reserved,
            match reservations.len() {
                1 => "Good with reservations: one point is open.".to_owned(),
                n => format!("Good with reservations: {n} points are open."),
            },
        )
    }
}

fn to_file(
    file: &SessionFile,
    grade: Grade,
    findings: &[Finding],
    steps: &FourSteps,
    parameters: &[ParameterReport],
) -> Calibration {
    let used = used(steps, parameters);
    let matrix = |rows: usize, get: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..rows)
            .map(|i| (0..rows).map(|j| get(i, j)).collect())
            .collect()
    };
    let size = |path: &Path| std::fs::metadata(file.resolve(path)).map_or(0, |m| m.len());
    Calibration {
        format: FORMAT.to_owned(),
        verdict: grade,
        findings: findings.to_vec(),
        sensor: CalibratedSensor {
            serial: file.session.sensor.serial.clone(),
            limb_length_m: file.geometry().limb_length_m,
            half_edge_m: file.geometry().half_edge_m,
            full_scale_v: file.session.sensor.full_scale_v,
            gain_n_per_v: file.session.sensor.gain_n_per_v.each(),
        },
        parameters: CalibratedParameters {
            zero_drift_v: used.zero_drift_v,
            scale_per_mass_per_kg: used.scale_per_mass_per_kg,
            inertia_per_mass_m2: used.inertia_per_mass.to_paper_order(),
            stiffness_per_mass_per_s2: used.stiffness_per_mass_per_s2,
        },
        intervals: parameters.to_vec(),
        covariance: Covariance {
            zero_drift_v2: steps.drift.standard_error_v.map(|s| s * s),
            scale_per_mass_per_kg2: matrix(LIMBS, &|i, j| steps.scale.estimate.covariance[(i, j)]),
            inertia_per_mass_m4: matrix(6, &|i, j| steps.inertia.estimate.covariance[(i, j)]),
        },
        channels: file.session.channels.clone(),
        provenance: Provenance {
            sixaxis_version: env!("CARGO_PKG_VERSION").to_owned(),
            session: file.text.clone(),
            recordings: file
                .session
                .recording
                .iter()
                .map(|entry| (entry.file.display().to_string(), size(&entry.file)))
                .collect(),
        },
    }
}
