//! Everything about a session, judged: is this calibration good, and if not, what next?
//!
//! Good is a promise: nothing was found wrong, every parameter that a rig can determine is determined, trials that were left out
//! of a fit are predicted by it, and runs that were never fitted come out as the standards show them. k/m is no part of it: the
//! paper's band does not determine it, and what is decoupled there does not notice. A tap that was recorded has to be one, though.

mod evidence;
mod gathered;
mod grading;
mod joint;
mod record;
mod validation;

pub use gathered::VALIDATION_CORNER;
pub use grading::COORDINATION_LIMIT;
pub use joint::{Choices, Estimator, beyond_certificate, contradiction};

use evidence::{coordination, hold_out, trial_report};
use gathered::{Gathered, gather};
use grading::{failures, grade, reservations};
use record::{Kept, to_file};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::Parameter;
use sixaxis_core::Parameters;
use validation::validate;

use crate::calibration::Calibration;
use crate::conditioning::Conditioned;
use crate::error::Result;
use crate::interval::{LeftOut, ParameterReport, put_taps, report};
use crate::iteration::Iteration;
use crate::joint::JointReport;
use crate::propagation;
use crate::steps::{Campaign, FourSteps, GyroscopeGain};
use crate::suspicion::{Cause, Facts, Finding, examine};
use crate::tap::Taps;
use crate::trial::Trial;
use sixaxis_recordings::session::{Role, SessionFile};

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
    /// Steps 2 to 4 repeated, where that was asked for and the four steps could be done; otherwise why they could not be.
    pub iteration: Option<core::result::Result<Iteration, String>>,
    /// Whose parameters were asked for.
    pub estimator: Estimator,
    /// The 25 parameters, by that estimator unless it refused; empty if the steps could not be done.
    pub parameters: Vec<ParameterReport>,
    /// The same by the four steps, whoever was asked.
    pub four_steps: Vec<ParameterReport>,
    /// The joint fit, or why it cannot be; none if the steps could not be done.
    pub joint: Option<core::result::Result<JointReport, String>>,
    /// The taps.
    pub taps: Taps,
    /// The trials.
    pub trials: Vec<TrialReport>,
    /// Validation runs in full.
    pub comparisons: Vec<Comparison>,
    /// Recordings as read and as conditioned, for before and after; the static one last.
    pub recordings: Vec<(Trial, Option<Conditioned>)>,
    /// The calibration to be written, if there is one.
    pub calibration: Option<Calibration>,
}

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
/// [`sixaxis_recordings::Error::Session`] only: a session whose own statements cannot be.
pub fn judge(file: &SessionFile, watch: &dyn Watch) -> Result<Judgement> {
    judge_choosing(file, &Choices::default(), watch)
}

/// The same with choices. A repetition is shown, not used: grade, parameters and calibration are those of [`judge`]. Another
/// estimator's parameters are what validation runs are decoupled with and what the calibration has; trials are held out by
/// the four steps either way.
///
/// # Errors
/// As [`judge`].
pub fn judge_choosing(
    file: &SessionFile,
    choices: &Choices,
    watch: &dyn Watch,
) -> Result<Judgement> {
    let Gathered {
        at_rest,
        trials,
        struck,
        conditioning,
        mut findings,
    } = gather(file, watch)?;
    watch.stage("examining", 1);
    let design = file.session.sensor.design();
    let facts = Facts {
        geometry: file.session.sensor.geometry(),
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
        geometry: file.session.sensor.geometry(),
        design,
        static_voltage_v: at_rest
            .as_ref()
            .map(|t| t.voltage_v.clone())
            .unwrap_or_default(),
        trials,
    };
    watch.stage("four steps", 2);
    let steps = campaign.identify(GyroscopeGain::Certified {
        class: file.session.gyroscope.class_percent / 100.0,
    });
    watch.part();
    let mut parameters = Vec::new();
    let mut comparisons = Vec::new();
    let mut calibration = None;
    let mut found = None;
    let mut obstacle = None;
    let mut taps = Taps::default();
    let mut iteration = None;
    let mut propagated = None;
    let mut four_steps = Vec::new();
    let mut fitted = None;
    let mut kept_parameters = None;
    match steps {
        Ok(steps) => {
            let left_out = LeftOut::fit(&campaign, &steps);
            watch.part();
            propagated = propagation::of_session(&file.session, &campaign, &conditioning, &steps);
            let noise = propagated.as_ref().map(|(_, found)| found.noise);
            parameters = report(&file.session, &steps, &left_out, noise.as_ref());
            taps = Taps::identify(
                &struck,
                campaign.geometry,
                &steps.used(),
                &campaign.design,
                &parameters,
            );
            put_taps(&mut parameters, &taps);
            watch.stage("joint fit", 1);
            let loss = choices.estimator.loss();
            let joint = joint::fitted(&file.session, &campaign, &steps, &taps, loss);
            watch.part();
            four_steps.clone_from(&parameters);
            let used = match &joint {
                Ok(joint) if choices.estimator != Estimator::FourSteps => {
                    parameters = joint.parameter_reports(&four_steps);
                    joint::used(joint, &parameters, &campaign.design)
                }
                _ => used(&steps, &four_steps),
            };
            kept_parameters = Some(used);
            fitted = Some(joint);
            watch.stage("holding against the standards", 1);
            hold_out(&campaign, &steps, &left_out, &mut reports);
            coordination(&campaign, &used, &mut reports);
            comparisons = validate(&campaign, &used, &mut reports, &mut findings);
            watch.part();
            if let Some(criterion) = &choices.repeat {
                watch.stage("repeating", 1);
                let repeated = campaign.repeat_until(&steps, None, criterion);
                iteration = Some(repeated.map_err(|error| error.to_string()));
                watch.part();
            }
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
        .filter(|p| !p.determined && p.parameter != Parameter::Stiffness)
        .collect();
    if !open.is_empty() && findings.is_empty() {
        let names: Vec<String> = open.iter().map(|p| p.parameter.to_string()).collect();
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
    let asked = fitted
        .as_ref()
        .filter(|_| choices.estimator != Estimator::FourSteps);
    let refusal = asked.and_then(|joint| joint.as_ref().err());
    findings.extend(refusal.map(|cause| joint::refused(cause)));
    findings.sort_by_key(|finding| finding.cause);
    let rig_is_known = file
        .session
        .rig
        .as_ref()
        .is_some_and(|rig| rig.stroke_mm.is_some() && rig.rotation_amplitude_deg.is_some());
    let mut reservations = reservations(
        &campaign,
        &file.session.limits,
        rig_is_known,
        &parameters,
        &reports,
    );
    reservations.extend(taps.remarks.iter().cloned());
    let joint = asked.and_then(|joint| joint.as_ref().ok());
    reservations.extend(joint.and_then(|joint| contradiction(&joint.misfit)));
    reservations.extend(joint.and_then(|joint| beyond_certificate(&joint.gain)));
    let (grade, sentence) = grade(&findings, &reservations, &reports, found.is_some());
    let mut next: Vec<String> = Vec::new();
    for finding in &findings {
        let advice = format!("{}{}", place(finding), finding.advice);
        if !next.contains(&advice) {
            next.push(advice);
        }
    }
    next.extend(reservations.iter().cloned());
    if let (Some(steps), Some(used), None) = (&found, &kept_parameters, refusal) {
        let covariance = match joint {
            Some(joint) => joint::covariance(joint, propagated.as_ref().map(|found| &found.0)),
            None => record::covariance(steps, propagated.as_ref()),
        };
        let kept = Kept {
            grade,
            findings: &findings,
            estimator: choices.estimator,
            used,
            parameters: &parameters,
            covariance,
        };
        calibration = Some(to_file(file, kept));
    }
    let mut recordings: Vec<(Trial, Option<Conditioned>)> = campaign
        .trials
        .into_iter()
        .map(|(trial, conditioned)| (trial, Some(conditioned)))
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
        iteration,
        estimator: choices.estimator,
        parameters,
        four_steps,
        joint: fitted,
        taps,
        trials: reports,
        comparisons,
        recordings,
        calibration,
    })
}

/// The parameters to decouple with: k/m is the design's unless its report calls it determined, by taps or by step 4.
fn used(steps: &FourSteps, parameters: &[ParameterReport]) -> Parameters {
    let mut used = steps.used();
    if let Some(stiffness) = parameters
        .iter()
        .find(|p| p.parameter == Parameter::Stiffness)
    {
        used.stiffness_per_mass_per_s2 = if stiffness.determined {
            stiffness.estimate
        } else {
            steps.design_stiffness_per_mass_per_s2
        };
    }
    used
}

fn place(finding: &Finding) -> String {
    match finding.recordings.as_slice() {
        [] => String::new(),
        [one] => format!("{one}: "),
        [first, second] => format!("{first} and {second}: "),
        [first, rest @ ..] => format!("{first} and {} more recordings: ", rest.len()),
    }
}
