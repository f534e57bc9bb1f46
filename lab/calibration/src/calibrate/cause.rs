//! What is wrong with a day, as far as an estimate bears it out.
//!
//! Recordings held against each other raise suspicions; the joint fit, which knows of ordinary rooms, has the last word. Where it
//! accounts for the trials, what it needed beyond such a room is named and suspicions of its trials are dropped; where it does
//! not, hypotheses compete for what it lacks.

use sixaxis_core::Parameters;
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};
use sixaxis_recordings::session::{Role, Session};

use super::choice::Chosen;
use crate::diagnosis::rig;
use crate::diagnosis::trial_case::{Facts, TrialCase};
use crate::estimate::Estimate;
use crate::finding::{Cause, Finding};
use crate::joint::hypotheses::{self, Unaccounted};
use crate::joint::{self, JointReport, Knowledge};
use crate::prepare::PreparedSession;

/// A session under judgement.
pub(super) struct Day<'a> {
    pub session: &'a Session,
    pub prepared: &'a PreparedSession,
    pub facts: &'a Facts<'a>,
    pub cases: &'a [TrialCase<'a>],
    /// By how much each of them departs from the others, relative to its own size.
    pub departures: &'a [Option<f64>],
}

/// Times the spread of the limbs' stiffnesses by which a run may depart from trials that were held against it as those of equal limbs.
const UNEQUAL: f64 = 3.0;

impl Day<'_> {
    /// Adds what is wrong by an estimate to what is certain.
    pub fn causes_by_estimate(
        &self,
        chosen: &Chosen,
        findings: &mut Vec<Finding>,
        of_the_table: Vec<Finding>,
        mut suspected: Vec<Finding>,
    ) {
        // Whose parameters were asked for makes no difference: what a room explains is no fault of a trial.
        let joint = chosen.estimate.joint.as_ref().ok();
        if let Some(joint) = joint.filter(|joint| joint.accounts()) {
            findings.extend(of_the_table);
            // Whole runs are judged as they come out; what is odd about one that fails is told then.
            let unequal = UNEQUAL * joint.estimate.spreads.stiffness;
            let of_channels = |f: &Finding| {
                !f.channels.is_empty()
                    && self.is_of_validation(f)
                    && (!f.cause.is_a_factor()
                        || self.largest_departure(f).is_none_or(|by| by > unequal))
            };
            findings.extend(suspected.into_iter().filter(of_channels));
            // A standard or a clock that the rig contradicts makes the other standard look wrong, too.
            let scaled =
                |f: &Finding| matches!(f.cause, Cause::WrongScaling | Cause::ClockMismatch);
            let more = self.extraordinary(joint);
            // One standard that changes over the day is off in its last trials, too.
            if self
                .accelerometer_changes()
                .is_some_and(|by| joint.is_the_accelerometers(by))
            {
                findings.retain(|f| !(scaled(f) && self.is_of_the_slider(f)));
            }
            let explained = findings.iter().any(scaled);
            findings.extend(more.into_iter().filter(|f| !(explained && scaled(f))));
            if findings.is_empty() {
                let Estimate {
                    steps, knowledge, ..
                } = &chosen.estimate;
                let start = joint::start(&self.prepared.campaign, steps);
                let day = self.unaccounted(&steps.drift, start, knowledge, Ok(joint));
                findings.extend(hypotheses::one_kind::tried(&day, Some(joint)));
            }
            return;
        }
        suspected.extend(of_the_table);
        suspected.sort_by_key(|finding| finding.cause);
        let estimate = &chosen.estimate;
        let joint = estimate.joint.as_ref().map_err(String::as_str);
        findings.extend(if self.has_no_rest(findings) {
            Vec::new()
        } else {
            let start = joint::start(&self.prepared.campaign, &estimate.steps);
            let drift = &estimate.steps.drift;
            let day = self.unaccounted(drift, start, &estimate.knowledge, joint);
            let found = hypotheses::explain(&day, findings, suspected);
            // Of a contradiction that hardly matters it is enough that there is one.
            let nearly = chosen
                .used_joint()
                .is_some_and(JointReport::nearly_accounts);
            let known = |f: &Finding| !(nearly && hypotheses::is_unknown(f));
            found.into_iter().filter(known).collect()
        });
    }

    /// Adds what is wrong where no estimate can be made to what is certain; never nothing.
    pub fn causes_without_estimate(
        &self,
        obstacle: &str,
        findings: &mut Vec<Finding>,
        mut suspected: Vec<Finding>,
    ) {
        suspected.sort_by_key(|finding| finding.cause);
        // Where nothing else is certain, a direction that no trial has is why there is no estimate.
        let left_out = suspected
            .iter()
            .find(|f| f.cause == Cause::UnderExcitedAxis);
        if let (true, Some(left_out)) = (findings.is_empty(), left_out) {
            findings.push(left_out.clone());
            return;
        }
        let campaign = &self.prepared.campaign;
        findings.extend(match zero_drift::identify(&campaign.static_voltage_v) {
            Ok(_) if self.has_no_rest(findings) => Vec::new(),
            Ok(drift) => {
                let knowledge = Knowledge::of(self.session);
                let day = self.unaccounted(&drift, campaign.design, &knowledge, Err(obstacle));
                hypotheses::explain(&day, findings, suspected)
            }
            // Where no trial was read, it is no news that none moves along an axis.
            Err(_) if campaign.trials.is_empty() && !findings.is_empty() => Vec::new(),
            // Without zeros no fit can clear a trial that departs from the others: in an ordinary room some do, for nothing of their own.
            Err(_) => {
                let departs = |cause| matches!(cause, Cause::ForeignTrial | Cause::Unexplained);
                suspected.retain(|finding| !departs(finding.cause));
                suspected
            }
        });
        if findings.is_empty() {
            findings.push(hypotheses::unknown(obstacle.to_owned()));
        }
    }

    /// Whether the static record as a whole is none of this sensor at rest: no fit can account for trials with its zeros.
    fn has_no_rest(&self, findings: &[Finding]) -> bool {
        let rest = self.prepared.at_rest.as_ref();
        rest.is_some_and(|rest| {
            let is_whole = |f: &Finding| {
                matches!(
                    f.cause,
                    Cause::Unreadable | Cause::MillivoltMixUp | Cause::WrongScaling
                ) && f.channels.is_empty()
                    && f.recordings.contains(&rest.name)
            };
            findings.iter().any(is_whole)
        })
    }

    fn unaccounted<'a>(
        &'a self,
        drift: &'a ZeroDrift,
        start: Parameters,
        knowledge: &'a Knowledge,
        joint: core::result::Result<&'a JointReport, &'a str>,
    ) -> Unaccounted<'a> {
        Unaccounted {
            campaign: &self.prepared.campaign,
            conditioning: &self.prepared.conditioning,
            drift,
            start,
            knowledge,
            cases: self.cases,
            joint,
        }
    }

    /// Whether it is about validation runs. These the joint fit does not see, and the trials that they were held against are right by
    /// its word.
    pub fn is_of_validation(&self, finding: &Finding) -> bool {
        let is_one = |name: &String| {
            let mut runs = self.prepared.campaign.of(Role::Validation);
            runs.any(|(trial, _)| trial.name == *name)
        };
        !finding.recordings.is_empty() && finding.recordings.iter().all(is_one)
    }

    /// Of the trials that a finding is about, where they are known.
    fn largest_departure(&self, finding: &Finding) -> Option<f64> {
        let of_these = |case: &TrialCase<'_>| finding.recordings.contains(&case.trial.name);
        let cases = self.cases.iter().zip(self.departures);
        let all = cases.filter_map(|(case, by)| by.filter(|_| of_these(case)));
        all.reduce(f64::max)
    }

    fn accelerometer_changes(&self) -> Option<f64> {
        rig::accelerometer_changes(self.facts, self.cases)
    }

    /// Whether it is about some linear trials as a whole.
    fn is_of_the_slider(&self, finding: &Finding) -> bool {
        let is_linear = |name: &String| {
            let mut cases = self.cases.iter().filter(|case| case.trial.name == *name);
            cases.any(|case| matches!(case.trial.role, Role::Linear | Role::HighFrequencyLinear))
        };
        let (channels, recordings) = (&finding.channels, &finding.recordings);
        channels.is_empty() && !recordings.is_empty() && recordings.iter().all(is_linear)
    }

    /// What is out of the ordinary by a joint fit that accounts for the trials.
    fn extraordinary(&self, joint: &JointReport) -> Vec<Finding> {
        let gyroscope = &self.session.gyroscope;
        let limit = gyroscope.gain_percent.unwrap_or(gyroscope.class_percent) / 100.0;
        joint.extraordinary(
            self.session.sensor.full_scale_v,
            limit,
            gyroscope.bandwidth_hz,
            rig::drive_faster(self.facts, self.cases),
            self.accelerometer_changes(),
        )
    }
}
