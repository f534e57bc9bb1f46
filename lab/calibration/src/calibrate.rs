//! The pipeline from a session's recordings to a graded calibration: prepare, diagnose, estimate, hold against the standards,
//! grade.
//!
//! | file | holds |
//! |---|---|
//! | [`cause`] | what is wrong with the day, as far as an estimate bears it out |
//! | [`evidence`] | each trial's fit, its prediction by a fit without it, the coordination equations |
//! | [`validation`] | runs that were never fitted, decoupled and held against the standards |
//! | [`compound_runs`] | what they show of travelling and of turning: whether linear and angular trials were scaled alike |
//! | [`failing_run`] | why one of them fails |
//! | [`choice`] | the parameters of the estimator that was asked for |
//! | [`disagreement`] | what the four steps' parameters are uncertain by because the joint fit says otherwise |
//! | [`covariance`], [`file`](mod@file) | what is written of them |
//!
//! A calibration is good where nothing was found wrong, every parameter that a rig can determine is determined, trials that were
//! left out of a fit are predicted by it, and runs that were never fitted come out as the standards show them. k/m is no part of
//! that: the paper's band does not determine it, and what is decoupled there does not notice. A tap that was recorded must
//! determine it, though.

mod cause;
mod choice;
mod compound_runs;
mod covariance;
mod disagreement;
mod evidence;
mod failing_run;
mod file;
mod validation;

pub use choice::{beyond_certificate, contradiction};

use cause::Day;
use choice::{Chosen, stiffness};
use validation::Decoding;

use crate::calibration::Calibration;
use crate::conditioning::Conditioned;
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::{Facts, Standard};
use crate::diagnosis::{Diagnosis, examine, rig, zero};
use crate::error::Result;
use crate::estimate::Estimate;
use crate::finding::{Cause, Finding, in_a_sentence};
use crate::grade::{JudgedBy, failures, grade, misstated_drives, reservations, worst};
use crate::iteration::{Criterion, Iteration};
use crate::joint::JointReport;
use crate::prepare::PreparedSession;
use crate::progress::Progress;
use crate::report::{Estimator, Grade, ParameterReport, TrialReport, ValidationRun};
use crate::steps::FourSteps;
use crate::tap::Taps;
use crate::trial::Trial;
use sixaxis_core::Parameter;
use sixaxis_recordings::session::{Session, SessionFile};

/// What may be asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// How far steps 2 to 4 are repeated. The repetition is shown, not used: grade, parameters and calibration are the same.
    pub repeat: Option<Criterion>,
    /// Whose parameters the calibration has; validation runs are decoupled with them. None: those of the joint fit where it
    /// accounts for the trials, those of the four steps where it does not.
    pub estimator: Option<Estimator>,
}

/// A calibrated and graded session.
#[derive(Debug, Clone)]
pub struct CalibratedSession {
    /// The grade.
    pub grade: Grade,
    /// The same in a sentence.
    pub sentence: String,
    /// What is wrong, worst first.
    pub findings: Vec<Finding>,
    /// What is missing, where nothing is wrong.
    pub reservations: Vec<String>,
    /// What was done beyond what the session says, which leaves nothing open.
    pub remarks: Vec<String>,
    /// What to do next.
    pub next: Vec<String>,
    /// The four steps, if they could be done.
    pub steps: Option<FourSteps>,
    /// Why they could not be done: the step and its reason.
    pub obstacle: Option<String>,
    /// Steps 2 to 4 repeated, where that was asked for and the four steps could be done; otherwise why they could not be.
    pub iteration: Option<core::result::Result<Iteration, String>>,
    /// Whose parameters were asked for or, where nobody asked, chosen.
    pub estimator: Estimator,
    /// The 25 parameters, by that estimator unless it refused; empty if the steps could not be done.
    pub parameters: Vec<ParameterReport>,
    /// The same by the four steps, whoever was asked.
    pub four_steps: Vec<ParameterReport>,
    /// The joint fit, or why it refuses; none if the steps could not be done.
    pub joint: Option<core::result::Result<JointReport, String>>,
    /// The taps.
    pub taps: Taps,
    /// The trials.
    pub trials: Vec<TrialReport>,
    /// Validation runs in full.
    pub validation_runs: Vec<ValidationRun>,
    /// What all trials agree on, by which they were held against each other.
    pub table: Option<Table>,
    /// Recordings as read and as conditioned, for before and after; the static one last.
    pub recordings: Vec<(Trial, Option<Conditioned>)>,
    /// The calibration to be written, if there is one.
    pub calibration: Option<Calibration>,
}

impl CalibratedSession {
    /// What was found of the trial of that file.
    pub fn trial(&self, name: &str) -> Option<&TrialReport> {
        self.trials.iter().find(|trial| trial.name == name)
    }

    /// What is known of k/m.
    pub fn stiffness(&self) -> Option<&ParameterReport> {
        stiffness(&self.parameters)
    }
}

/// Reads, calibrates and grades a session.
///
/// A recording that cannot be used and a step that refuses its data are findings, not errors: the rest is worth knowing.
///
/// # Errors
/// [`sixaxis_recordings::Error::Session`] only: a session whose own statements cannot be.
pub fn calibrate(
    file: &SessionFile,
    options: &Options,
    progress: &dyn Progress,
) -> Result<CalibratedSession> {
    let session = &file.session;
    let prepared = PreparedSession::read(file, progress)?;
    progress.stage("diagnosis", 1);
    let mut findings = prepared.findings.clone();
    let facts = facts(session, &prepared);
    let Diagnosis {
        findings: certain,
        of_the_table,
        mut suspected,
        cases,
        table,
        departures,
    } = examine(&facts, prepared.at_rest.as_ref(), &prepared.campaign.trials);
    findings.extend(certain);
    if let Some(first) = &prepared.at_rest {
        let further = prepared.further_rests.iter();
        findings.extend(further.filter_map(|rest| zero::of_a_further_record(first, rest)));
    }
    let certain = findings.clone();
    let mut trials: Vec<TrialReport> = cases
        .iter()
        .zip(&departures)
        .map(|(case, departure)| evidence::trial_report(case, *departure))
        .collect();
    progress.part();

    let loss = choice::loss(options.estimator);
    let day = Day {
        session,
        prepared: &prepared,
        facts: &facts,
        cases: &cases,
        departures: &departures,
    };
    let of_validation: Vec<Finding> = suspected
        .iter()
        .filter(|finding| day.is_of_validation(finding))
        .cloned()
        .collect();
    let (chosen, obstacle) = match Estimate::of(session, &prepared, loss, progress) {
        Ok(estimate) => {
            let chosen = Chosen::of(estimate, options.estimator, &prepared.campaign.design);
            day.causes_by_estimate(&chosen, &mut findings, of_the_table, suspected);
            (Some(chosen), None)
        }
        Err(error) => {
            let obstacle = error.to_string();
            suspected.extend(of_the_table);
            day.causes_without_estimate(&obstacle, &mut findings, suspected);
            (None, Some(obstacle))
        }
    };
    findings.retain(|finding| certain.contains(finding) || !says_more_of(finding, &certain));
    let (mut validation_runs, mut not_decoupled) = (Vec::new(), Vec::new());
    let mut iteration = None;
    if let Some(chosen) = &chosen {
        let (campaign, steps) = (&prepared.campaign, &chosen.estimate.steps);
        progress.stage("holding against the standards", 1);
        evidence::hold_out(campaign, steps, &chosen.estimate.left_out, &mut trials);
        evidence::coordination(campaign, &chosen.used, &mut trials);
        (validation_runs, not_decoupled) =
            validation::validate(campaign, &decoding(chosen), &mut trials);
        progress.part();
        if let Some(criterion) = &options.repeat {
            progress.stage("repeating", 1);
            let repeated = campaign.repeat_until(steps, None, criterion);
            iteration = Some(repeated.map_err(|error| error.to_string()));
            progress.part();
        }
    }

    let judged_by = match &chosen {
        Some(chosen) if chosen.accounting_joint().is_some() => JudgedBy::Joint,
        chosen => {
            // A fit that leaves little more than noise has weighed the gyroscope against both kinds of trials.
            let weighed = |c: &&Chosen| c.used_joint().is_some_and(JointReport::nearly_accounts);
            let steps = chosen.as_ref().filter(|c| !weighed(c));
            JudgedBy::FourSteps(steps.map(|c| &c.estimate.steps))
        }
    };
    if findings.is_empty() {
        let gyroscope = rig::gyroscope_reads(&facts, &cases);
        findings = failures(session, &trials, judged_by, gyroscope);
        // Where something has been found before, that has made them fail.
        findings.append(&mut not_decoupled);
        let decoding = chosen.as_ref().map(decoding);
        for finding in &mut findings {
            failing_run::explain(
                finding,
                &of_validation,
                &prepared,
                decoding.as_ref(),
                &trials,
                &session.limits,
            );
        }
        let joint = chosen.as_ref().and_then(Chosen::accounting_joint);
        let scaled = joint
            .and_then(|joint| compound_runs::examine(&prepared.campaign, &validation_runs, joint));
        // What is wrong with trials makes every run fail that they are held against.
        if let Some(scaled) = scaled
            && (findings.is_empty() || scaled.recordings.is_empty())
        {
            findings = vec![scaled];
        }
    }
    if let Some(chosen) = &chosen {
        if findings.is_empty() {
            let hardly_known = disagreement::hardly_known(chosen);
            findings.extend(hardly_known.or_else(|| undetermined(&chosen.parameters)));
        }
        findings.extend(chosen.refusal().map(choice::refused));
    }
    findings.sort_by_key(|finding| finding.cause);
    let parameters = chosen.as_ref().map_or(&[][..], |chosen| &chosen.parameters);
    let mut reservations =
        reservations(&prepared.campaign, session, parameters, &trials, judged_by);
    reservations.extend(prepared.reservations());
    let clocks = findings.iter().any(|f| f.cause == Cause::ClockMismatch);
    if !clocks {
        let of_wrong_clocks = rig::of_wrong_clocks(&facts, &cases);
        reservations.extend(misstated_drives(&trials, &of_wrong_clocks));
    }
    if let Some(chosen) = &chosen {
        reservations.extend(chosen.reservations());
        let of_runs = trials.iter().filter_map(|trial| trial.validation);
        let by_steps = 100.0 * worst(&of_runs.flatten().collect::<Vec<_>>());
        let limit = session.limits.validation_percent;
        reservations.extend(chosen.set_aside(&prepared.campaign, by_steps, limit));
    }
    let (grade, sentence) = grade(&findings, &reservations, &trials, chosen.is_some());
    let calibration = chosen
        .as_ref()
        .filter(|chosen| chosen.refusal().is_none())
        .map(|chosen| file::to_file(file, grade, &findings, chosen));
    let remarks = prepared.remarks();
    let mut recordings: Vec<(Trial, Option<Conditioned>)> = prepared
        .campaign
        .trials
        .into_iter()
        .map(|(trial, conditioned)| (trial, Some(conditioned)))
        .collect();
    recordings.extend(prepared.at_rest.map(|rest| (rest, None)));
    let next = next_actions(&findings, &reservations);
    let mut session = CalibratedSession {
        grade,
        sentence,
        findings,
        reservations,
        remarks,
        next,
        steps: None,
        obstacle,
        iteration,
        estimator: chosen
            .as_ref()
            .map_or(options.estimator.unwrap_or_default(), |c| c.estimator),
        parameters: Vec::new(),
        four_steps: Vec::new(),
        joint: None,
        taps: Taps::default(),
        trials,
        validation_runs,
        table,
        recordings,
        calibration,
    };
    if let Some(chosen) = chosen {
        session.parameters = chosen.parameters;
        session.joint = Some(chosen.estimate.joint);
        session.steps = Some(chosen.estimate.steps);
        session.four_steps = chosen.estimate.four_steps;
        session.taps = chosen.estimate.taps;
    }
    Ok(session)
}

/// Whether a finding is of channels of which something certain is known in the same recordings: that is all that need be said.
fn says_more_of(finding: &Finding, certain: &[Finding]) -> bool {
    let known = |name: &String, channel: usize| {
        let mut of_channels = certain.iter().filter(|f| !f.channels.is_empty());
        of_channels.any(|f| f.concerns(name, channel))
    };
    let mut places = finding.recordings.iter();
    !finding.channels.is_empty()
        && !finding.recordings.is_empty()
        && places.all(|name| finding.channels.iter().all(|channel| known(name, *channel)))
}

/// What runs are decoupled with.
fn decoding(chosen: &Chosen) -> Decoding<'_> {
    Decoding {
        parameters: &chosen.used,
        limbs: chosen.used_joint().map(JointReport::limbs),
    }
}

fn facts<'a>(session: &'a Session, prepared: &'a PreparedSession) -> Facts<'a> {
    let Session {
        accelerometer,
        gyroscope,
        ..
    } = session;
    let standard = |gain: Option<f64>, class: f64, bandwidth_hz: Option<f64>| Standard {
        gain_limit: gain.unwrap_or(class) / 100.0,
        lag_s: bandwidth_hz.map_or(0.0, |hz| 1.0 / (core::f64::consts::TAU * hz)),
    };
    Facts {
        accelerometer: standard(
            accelerometer.gain_percent,
            accelerometer.class_percent,
            accelerometer.bandwidth_hz,
        ),
        gyroscope: standard(
            gyroscope.gain_percent,
            gyroscope.class_percent,
            gyroscope.bandwidth_hz,
        ),
        geometry: prepared.campaign.geometry,
        design: &prepared.campaign.design,
        rig: session.rig.as_ref(),
        gyroscope_class: session.gyroscope.class_percent / 100.0,
        gyroscope_lag_undone: session.gyroscope.bandwidth_hz.is_some(),
    }
}

/// Parameters other than k/m that the trials do not determine.
fn undetermined(parameters: &[ParameterReport]) -> Option<Finding> {
    let open: Vec<Parameter> = parameters
        .iter()
        .map(|p| (p.parameter, p.determined))
        .filter(|(parameter, determined)| !determined && *parameter != Parameter::Stiffness)
        .map(|(parameter, _)| parameter)
        .collect();
    let names: Vec<String> = open.iter().map(Parameter::to_string).collect();
    // No direction loads one limb alone: where one scale factor is open, it is the channel that shows nothing.
    let (cause, channels) = match open[..] {
        [Parameter::Scale(limb)] => (Cause::Unexplained, vec![limb]),
        _ => (Cause::UnderExcitedAxis, Vec::new()),
    };
    (!names.is_empty()).then(|| {
        let evidence = format!(
            "the trials leave {} open: their 95 % intervals are wider than the values themselves",
            names.join(", ")
        );
        let advice = "record more trials of steps 2 and 3, on more wedges";
        Finding::new(cause, evidence, advice).on_channels(channels)
    })
}

/// The advice of every finding with its recordings, each once, and then what is missing.
fn next_actions(findings: &[Finding], reservations: &[String]) -> Vec<String> {
    let mut next: Vec<String> = Vec::new();
    for finding in findings {
        let advice = match in_a_sentence(&finding.recordings) {
            Some(place) => format!("{place}: {}", finding.advice),
            None => finding.advice.clone(),
        };
        if !next.contains(&advice) {
            next.push(advice);
        }
    }
    next.extend(reservations.iter().cloned());
    next
}
