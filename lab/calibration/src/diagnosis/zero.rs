//! Whether the static record's zeros are those of the trials. A linear run begins and ends at rest, so that its channels show their
//! zeros in the mean; a record of another sensor, of an open input, in another unit or of a moving sensor does not show them.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::zero_drift::ZeroDrift;

use super::raw::converter_step_v;
use super::table::{usable, weighted_median};
use super::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Trials from which one says what is usual.
const FEWEST: usize = 4;
/// Times what zeros scatter by from trial to trial, the median of that, by which the static record's must be off: zeros that wander
/// over the day wander among the trials, too.
const ELSEWHERE: f64 = 8.0;
/// Smallest share of the converter's range that is noticed.
const NOTICED: f64 = 1e-4;
/// Share of a linear trial's signal that a record at rest does not show.
const MOVES: f64 = 0.25;

/// Holds the static record against the linear trials.
pub fn examine(
    rest: &Trial,
    drift: &ZeroDrift,
    cases: &[TrialCase<'_>],
    findings: &mut Vec<Finding>,
) {
    let known = |channel: usize| {
        let concerned = |f: &Finding| f.concerns(&rest.name, channel + 1);
        findings.iter().any(concerned)
    };
    let ratios = (0..LIMBS)
        .filter(|channel| !known(*channel))
        .filter_map(|i| Some(drift.noise_v[i] / signal_v(cases, i)?));
    let mut moves: Vec<(f64, f64)> = ratios.map(|ratio| (ratio, 1.0)).collect();
    if let Some(share) = weighted_median(&mut moves).filter(|share| *share > MOVES) {
        findings.push(of_the_record(
            rest,
            format!(
                "the static record's channels scatter by {:.0} % of what they show in a linear trial: the sensor moved, or it is the record of a trial",
                100.0 * share
            ),
        ));
        return;
    }
    let off: Vec<(usize, Elsewhere)> = (0..LIMBS)
        .filter(|channel| !known(*channel))
        .filter_map(|channel| Some((channel, elsewhere(rest, channel, cases)?)))
        .collect();
    let Some((channel, largest)) = off
        .iter()
        .max_by(|(_, a), (_, b)| a.off_v.abs().total_cmp(&b.off_v.abs()))
    else {
        return;
    };
    let evidence = format!(
        "the linear trials show channel {}'s zero {:+.3} mV from the static record's, and among themselves {:.3} mV from each other",
        channel + 1,
        1e3 * largest.off_v,
        1e3 * largest.scatter_v
    );
    if off.len() > LIMBS / 2 {
        let others = format!("{evidence}; {} channels do so", off.len());
        findings.push(of_the_record(rest, others));
        return;
    }
    findings.push(Finding {
        cause: Cause::DriftDuringRun,
        recordings: vec![rest.name.clone()],
        channels: off.iter().map(|(channel, _)| channel + 1).collect(),
        evidence,
        advice: "record at rest again, right before the trials".to_owned(),
    });
}

fn of_the_record(rest: &Trial, evidence: String) -> Finding {
    Finding {
        cause: Cause::Unreadable,
        recordings: vec![rest.name.clone()],
        channels: Vec::new(),
        evidence,
        advice: "see whether the static record is of this sensor, in the trials' unit and at rest; record at rest again".to_owned(),
    }
}

/// How far a channel's zero is from the static record's.
struct Elsewhere {
    off_v: f64,
    scatter_v: f64,
}

fn elsewhere(rest: &Trial, channel: usize, cases: &[TrialCase<'_>]) -> Option<Elsewhere> {
    let mut offsets: Vec<(f64, f64)> = Vec::new();
    let mut errors: Vec<(f64, f64)> = Vec::new();
    for (case, response) in usable(cases) {
        let linear = matches!(case.trial.role, Role::Linear | Role::HighFrequencyLinear);
        if linear && !case.ignored[channel] {
            let volts = |force_n: f64| force_n / case.trial.gains.gain_n_per_v[channel];
            let own = &response.channels[channel];
            offsets.push((volts(own.offset_n), 1.0));
            errors.push((volts(own.offset_error_n), 1.0));
        }
    }
    if offsets.len() < FEWEST {
        return None;
    }
    let off_v = weighted_median(&mut offsets)?;
    let mut away: Vec<(f64, f64)> = offsets
        .iter()
        .map(|(offset, weight)| ((offset - off_v).abs(), *weight))
        .collect();
    let scatter_v = weighted_median(&mut away)?;
    let error_v = weighted_median(&mut errors)?;
    // A converter whose steps are as coarse as the noise shows a zero to half a step.
    let step_v = Some(converter_step_v(rest, channel)).filter(|step| step.is_finite());
    let by_chance = ELSEWHERE * scatter_v.max(error_v) + step_v.unwrap_or(0.0);
    (off_v.abs() > by_chance.max(NOTICED * rest.full_scale_v))
        .then_some(Elsewhere { off_v, scatter_v })
}

/// What a channel shows in a linear trial, root mean square, V.
fn signal_v(cases: &[TrialCase<'_>], channel: usize) -> Option<f64> {
    let mut signals: Vec<(f64, f64)> = usable(cases)
        .filter(|(case, _)| case.trial.role == Role::Linear)
        .map(|(case, response)| {
            let gain = case.trial.gains.gain_n_per_v[channel];
            (response.channels[channel].signal_n / gain, 1.0)
        })
        .collect();
    weighted_median(&mut signals)
}
