//! Whether a trial does what its role says: by the standards, a linear trial travels and an angular one turns.

use core::f64::consts::TAU;

use super::fundamental;
use super::trial_case::{TrialCase, mark_explained};
use crate::finding::{Cause, Finding};
use crate::series::deviation;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Travel, m, and turn, rad, that a rig makes: where the other standard moves by a tenth of its own, the trial is of the other kind.
const RIG: (f64, f64) = (0.1, 1.0);
/// Share of that, and of the motion of the other kind, from which something moves.
const MOVES: f64 = 0.1;
/// Share of a rig's turn from which a linear trial is a compound run.
const TURNS: f64 = 0.3;

/// Travel and turn of a trial over those of a rig.
fn moved(trial: &Trial) -> (f64, f64) {
    let omega = TAU * trial.frequency_hz;
    (
        deviation(&trial.accelerometer_m_s2) / (omega * omega * RIG.0),
        deviation(&trial.gyroscope_rad_s) / (omega * RIG.1),
    )
}

/// Amplitude of the turn at the drive's frequency: a gyroscope that is not plugged in reads anything.
fn turned_rad(case: &TrialCase<'_>) -> f64 {
    let trial = case.trial;
    let seen_hz = case.response.as_ref().and_then(|r| r.frequency_hz);
    let hz = seen_hz.unwrap_or(trial.frequency_hz);
    fundamental::measure(&trial.gyroscope_rad_s, trial.sample_rate_hz, hz)
        .map_or(0.0, |found| found.amplitude / found.rate_rad_s)
}

/// Trials of the other kind, and standards that read one value throughout.
pub fn examine(cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    let is_linear = |trial: &Trial| match trial.role {
        Role::Linear | Role::HighFrequencyLinear => Some(true),
        Role::Angular => Some(false),
        _ => None,
    };
    let (mut other, mut standing, mut judged) = (Vec::new(), Vec::new(), 0);
    for (index, case) in cases.iter().enumerate() {
        let Some(linear) = is_linear(case.trial) else {
            continue;
        };
        judged += 1;
        let (travel, turn) = moved(case.trial);
        let (own, others) = if linear {
            (travel, turn)
        } else {
            (turn, travel)
        };
        if others > MOVES && own < MOVES * others {
            other.push((index, linear));
        } else if own == 0.0 && others > 0.0 {
            standing.push((index, linear));
        }
    }
    // Exchanged standards have each other's units, too, in which one of them may hardly move.
    if other.len() + standing.len() == judged && !other.is_empty() {
        other.append(&mut standing);
    }
    if !other.is_empty() {
        let linear = other.iter().filter(|(_, linear)| *linear).count();
        let evidence = match (linear, other.len() - linear) {
            (_, 0) => "entered as linear, and by the standards the sensor turns".to_owned(),
            (0, _) => "entered as angular, and by the standards the sensor travels".to_owned(),
            (linear, angular) => format!(
                "by the standards these trials move as the other kind should: {linear} entered as linear turn, {angular} entered as angular travel"
            ),
        };
        let advice = if other.len() == judged {
            "accelerometer and gyroscope are exchanged in the session's [channels], or the files or roles of linear and angular trials are"
        } else {
            "see whether files or roles of linear and angular trials are exchanged in the session"
        };
        let recordings = mark_explained(cases, other.into_iter().map(|(index, _)| index));
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_recordings(recordings));
    }
    let both: Vec<usize> = (0..cases.len())
        .filter(|index| {
            let case = &cases[*index];
            !case.explained
                && is_linear(case.trial) == Some(true)
                && turned_rad(case) > TURNS * RIG.1
        })
        .collect();
    if !both.is_empty() {
        let evidence = "the gyroscope turns at the drive's frequency, as in a compound run";
        let advice = "see whether the role is \"validation\", or the file another trial's";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_recordings(mark_explained(cases, both)));
    }
    for (linear, what) in [(true, "accelerometer"), (false, "gyroscope")] {
        let constant: Vec<usize> = (0..cases.len())
            .filter(|index| {
                let case = &cases[*index];
                let series = if linear {
                    &case.trial.accelerometer_m_s2
                } else {
                    &case.trial.gyroscope_rad_s
                };
                let moves = !case.explained && is_linear(case.trial) == Some(linear);
                moves && series.iter().all(|x| Some(x) == series.first())
            })
            .collect();
        if constant.is_empty() {
            continue;
        }
        let evidence = format!("the standard {what} reads one value throughout");
        let advice = format!("check the cable of the standard {what} and record again");
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_recordings(mark_explained(cases, constant)));
    }
}
