//! What the browser is shown of a calibration day.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::report::{Grade, ParameterReport};
use sixaxis_recordings::session::{Entry, Role};

use super::Plan;
use super::check::Check;
use super::worth::Worth;

/// One recording of the list.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// Its file, without ending.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// What the wedge sets.
    pub direction: Option<[f64; 3]>,
    /// Crank frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// Length, s, where it ends by itself.
    pub seconds: Option<f64>,
    /// Its check, once it has been recorded.
    pub check: Option<Check>,
    /// Error of its prediction by a fit without it, over its signal; for a validation run the largest error over the peak.
    pub error: Option<f64>,
    /// What it would add to what has been recorded.
    pub worth: Option<Worth>,
}

/// One of the 25 parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// As it is known now.
    #[serde(flatten)]
    pub report: ParameterReport,
    /// Half widths after each calibration so far.
    pub widths: Vec<Option<f64>>,
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What.
    pub cause: String,
    /// Where.
    pub place: String,
    /// What was seen.
    pub evidence: String,
    /// What to do.
    pub advice: String,
}

/// The calibration day so far.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Outcome {
    /// The list.
    pub trials: Vec<Trial>,
    /// What to record next, an index into the list; none when all are there.
    pub next: Option<usize>,
    /// None before the first calibration.
    pub grade: Option<Grade>,
    /// The judgement in a sentence.
    pub sentence: String,
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// What is missing, where nothing is wrong.
    pub reservations: Vec<String>,
    /// Whose parameters these are.
    pub estimator: &'static str,
    /// The 25 parameters.
    pub parameters: Vec<Parameter>,
    /// Where the calibration is.
    pub file: Option<String>,
    /// What could not be done.
    pub problem: Option<String>,
    /// Whether a calibration of this state is still to come or has come.
    pub calibrated: bool,
    /// The calibration itself, to decode with.
    #[serde(skip)]
    pub calibration: Option<Calibration>,
}

impl Outcome {
    /// What has been recorded, without a calibration.
    pub fn recorded(
        plan: &Plan,
        done: &BTreeMap<usize, (Entry, Check)>,
        problem: Option<String>,
    ) -> Self {
        let trial = |(index, (entry, seconds)): (usize, &(Entry, Option<f64>))| Trial {
            name: stem(&entry.file),
            role: entry.role,
            direction: entry.direction,
            frequency_hz: entry.frequency_hz,
            seconds: *seconds,
            check: done.get(&index).map(|(_, check)| check.clone()),
            error: None,
            worth: None,
        };
        Self {
            trials: plan.entries.iter().enumerate().map(trial).collect(),
            next: (0..plan.entries.len()).find(|index| !done.contains_key(index)),
            problem,
            ..Self::default()
        }
    }

    /// With its calibration.
    #[must_use]
    pub fn with(
        mut self,
        session: &CalibratedSession,
        widths: &[Vec<Option<f64>>],
        path: &Path,
        problem: Option<String>,
    ) -> Self {
        for trial in &mut self.trials {
            let report = session
                .trials
                .iter()
                .find(|report| stem(Path::new(&report.name)) == trial.name);
            trial.error = report.and_then(|report| {
                let largest = |errors: [f64; 6]| errors.into_iter().fold(0.0, f64::max);
                report.validation.map(largest).or(report.hold_out)
            });
        }
        self.grade = Some(session.grade);
        self.sentence.clone_from(&session.sentence);
        self.reservations.clone_from(&session.reservations);
        self.estimator = session.estimator.name();
        let findings = session.findings.iter().map(|finding| Finding {
            cause: finding.cause.name().to_owned(),
            place: place(&finding.recordings, &finding.channels),
            evidence: finding.evidence.clone(),
            advice: finding.advice.clone(),
        });
        self.findings = findings.collect();
        let parameters = session
            .parameters
            .iter()
            .enumerate()
            .map(|(k, report)| Parameter {
                report: report.clone(),
                widths: widths
                    .iter()
                    .map(|row| row.get(k).copied().flatten())
                    .collect(),
            });
        self.parameters = parameters.collect();
        self.calibration.clone_from(&session.calibration);
        self.file = self
            .calibration
            .as_ref()
            .map(|_| path.display().to_string());
        self.problem = problem
            .or(self.problem)
            .or_else(|| session.obstacle.clone());
        self.calibrated = true;
        self
    }
}

fn stem(path: &Path) -> String {
    path.with_extension("")
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn place(recordings: &[String], channels: &[usize]) -> String {
    let mut place = match recordings {
        [] => "all recordings".to_owned(),
        [one] => one.clone(),
        [first, rest @ ..] => format!("{first} and {} more", rest.len()),
    };
    if !channels.is_empty() {
        let numbers: Vec<String> = channels.iter().map(usize::to_string).collect();
        place += &format!(", channel {}", numbers.join(", "));
    }
    place
}
