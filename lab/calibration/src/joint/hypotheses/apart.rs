//! A few trials are wrong and the others are not.
//!
//! What was suspected of single trials by holding them against the others is worth something only if the others agree. That
//! they do is for the joint fit to say, to which the trials in question are not shown.

use rayon::prelude::*;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;

use super::{Unaccounted, agreement, start};
use crate::finding::Finding;
use crate::joint::{at_rest, record};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Largest share of the trials that may be wrong: of two halves that contradict each other, neither is the measure.
const AMONG: f64 = 0.5;

/// What was suspected of single trials, if a fit accounts for all others. Trials that something `certain` concerns are left
/// aside as well, and where that is enough, nothing is left to suspect trials of.
pub fn tried(
    day: &Unaccounted<'_>,
    certain: &[Finding],
    suspected: Vec<Finding>,
) -> Option<Vec<Finding>> {
    let told_by_others = |finding: &Finding| !is_of_runs(day, finding) || others_tell(day, certain);
    let of_single_trials: Vec<Finding> = suspected
        .into_iter()
        .filter(|finding| !finding.recordings.is_empty() && told_by_others(finding))
        .collect();
    if of_single_trials.is_empty() {
        return None;
    }
    if others_agree(day, certain, &[]) {
        let of_runs = |finding: &Finding| is_of_runs(day, finding);
        return Some(of_single_trials.into_iter().filter(of_runs).collect());
    }
    // The one thing that is wrong, if there is one; all that was suspected only if it takes all of it. What is suspected of the same
    // trials, as of each of nine channels, is one fit to the others.
    let mut alike: Vec<&Finding> = Vec::new();
    for finding in &of_single_trials {
        if !alike
            .iter()
            .any(|other| other.recordings == finding.recordings)
        {
            alike.push(finding);
        }
    }
    let agreed_without: Vec<&Finding> = alike
        .into_par_iter()
        .filter(|finding| others_agree(day, certain, std::slice::from_ref(*finding)))
        .collect();
    let borne_out: Vec<&Finding> = of_single_trials
        .iter()
        .filter(|finding| {
            let mut agreed = agreed_without.iter();
            agreed.any(|other| other.recordings == finding.recordings)
        })
        .collect();
    match borne_out[..] {
        [one] => Some(vec![one.clone()]),
        [_, _, ..] => None,
        [] => others_agree(day, certain, &of_single_trials).then_some(of_single_trials),
    }
}

/// Whether a fit accounts for the trials that neither concerns.
fn others_agree(day: &Unaccounted<'_>, certain: &[Finding], suspected: &[Finding]) -> bool {
    let concerned = |name: &String| {
        let mut all = certain.iter().chain(suspected);
        all.any(|finding| finding.recordings.contains(name))
    };
    let fitted = day.campaign.trials.iter().map(|(trial, _)| trial);
    let (aside, others): (Vec<&Trial>, Vec<&Trial>) = fitted
        .filter(|trial| record(trial).is_some())
        .partition(|trial| concerned(&trial.name));
    if aside.is_empty() || aside.len() as f64 > AMONG * (aside.len() + others.len()) as f64 {
        return false;
    }
    // From what most trials agree on: the four steps' answer has the wrong ones in it.
    let rest = at_rest(day.drift);
    let agreed = StaticLoadSharing::new(&day.campaign.geometry).ok();
    let agreed = agreed.and_then(|shares| agreement(&shares, day.cases));
    let from = agreed.map_or(day.start, |(_, table)| {
        start(&table, &rest, &day.campaign.design)
    });
    day.accounting(&others, &rest, &from, day.knowledge)
        .is_some()
}

/// Whether it is about validation runs only, which no fit sees: they are held against what the trials agree on.
fn is_of_runs(day: &Unaccounted<'_>, finding: &Finding) -> bool {
    let fitted = day.campaign.trials.iter().map(|(trial, _)| trial);
    let mut fitted = fitted.filter(|trial| record(trial).is_some());
    !fitted.any(|trial| finding.recordings.contains(&trial.name))
}

/// Whether most trials of either kind are left where those that something `certain` concerns are put aside: fewer agree on little that a run
/// could be held against.
fn others_tell(day: &Unaccounted<'_>, certain: &[Finding]) -> bool {
    [Role::Linear, Role::Angular].into_iter().all(|role| {
        let concerned = |trial: &Trial| certain.iter().any(|f| f.recordings.contains(&trial.name));
        let of_kind = || day.campaign.of(role).map(|(trial, _)| trial);
        let aside = of_kind().filter(|trial| concerned(trial)).count();
        aside as f64 <= AMONG * of_kind().count() as f64
    })
}
