//! What is wrong with a campaign, named: which cause, in which trial, on which channel, by how much, and what to do.
//!
//! Everything is held against [`StaticLoadSharing`], which says what each channel should show of each trial's motion, and what is
//! left over is tried against one cause after the other. The order matters: a fault that explains others is looked for first,
//! and what it explains is not reported again.
//!
//! 1. [`altered`]: what happened between converter and file; [`raw`]: what one recording shows by itself: clipped (`flat_top`); and [`role`]:
//!    whether it does what its role says.
//! 2. [`still`]: channels of the static record that read nothing, not even noise.
//! 3. [`zero`]: static records whose zeros are not those of the trials.
//! 4. [`structure`]: what all trials together show of a channel: silent, inverted, under-excited axes.
//! 5. [`gravity`]: weight that turns in the sensor although the session says it does not.
//! 6. [`rig`]: standards and sample rate against stroke and rotation, by the [`fundamental`] of each trial.
//! 7. [`timing`]: lags and clocks.
//! 8. [`level`]: factors that all trials share: units, sensitivities, gains.
//! 9. [`drift`]: rests that are not where they were.
//! 10. [`odd_trial`]: trials that do not fit in with the others.
//!
//! What a recording or the rig says by itself is certain, and so are silent channels. Signs and factors that no sensor has are those of
//! a [`Table`] that all trials agree on, and worth as much as they do. What comes of holding trials
//! against each other is *suspected*: an ordinary room departs from equal limbs, true wedges and a plumb axis as well, and the joint
//! fit, which knows of these, has the last word ([`crate::joint::account`]).

pub mod altered;
pub mod drift;
pub(crate) mod flat_top;
pub mod fundamental;
pub mod gravity;
pub mod level;
pub mod odd_trial;
pub mod raw;
pub mod rig;
pub mod role;
pub mod still;
pub mod structure;
pub mod table;
pub mod timing;
pub mod trial_case;
pub mod zero;

use rayon::prelude::*;
use sixaxis_core::LIMBS;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};

use crate::conditioning::Conditioned;
use crate::finding::Finding;
use crate::response;
use crate::trial::Trial;
use gravity::turned_gravity_m_s2;
use sixaxis_recordings::session::Role;
use table::Table;
use trial_case::{Facts, TrialCase, angles};

/// Relative error of an angle that undoing a gyroscope's lag and the low-pass leave.
const LAG_ANGLE_ERROR: f64 = 3e-3;

/// What the diagnosis found.
#[derive(Debug, Clone)]
pub struct Diagnosis<'a> {
    /// What is wrong for certain, worst first.
    pub findings: Vec<Finding>,
    /// What is wrong if the trials agree on their scale factors, worst first.
    pub of_the_table: Vec<Finding>,
    /// What is wrong unless the joint fit accounts for it, worst first.
    pub suspected: Vec<Finding>,
    /// The trials with their responses.
    pub cases: Vec<TrialCase<'a>>,
    /// What all trials agree on, where they can be held against each other.
    pub table: Option<Table>,
    /// For each trial, how far it departs from that, relative to its own size.
    pub departures: Vec<Option<f64>>,
}

impl Diagnosis<'_> {
    /// All of them, worst first.
    pub fn all(&self) -> Vec<Finding> {
        let mut all = [&self.findings[..], &self.of_the_table, &self.suspected].concat();
        all.sort_by_key(|finding| finding.cause);
        all
    }
}

/// What a finding rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Word {
    /// A recording by itself, or the rig.
    Certain,
    /// Scale factors and inertias that all trials agree on.
    OfTheTable,
    /// Trials held against each other.
    Suspected,
}

/// Findings in the order in which they were made, and what each rests on.
#[derive(Debug, Default)]
pub struct Found {
    /// What was found.
    pub findings: Vec<Finding>,
    words: Vec<Word>,
}

impl Found {
    /// Notes what rests on what, of all that has been found since.
    pub fn mark(&mut self, word: Word) {
        self.words.resize(self.findings.len(), word);
    }

    /// What rests on each, worst first.
    fn resting_on(&self, wanted: Word) -> Vec<Finding> {
        let all = self.findings.iter().zip(&self.words);
        let mut findings: Vec<Finding> = all
            .filter(|(_, word)| **word == wanted)
            .map(|(finding, _)| finding.clone())
            .collect();
        findings.sort_by_key(|finding| finding.cause);
        findings
    }
}

/// Examines a campaign.
pub fn examine<'a>(
    facts: &Facts<'_>,
    at_rest: Option<&Trial>,
    trials: &'a [(Trial, Conditioned)],
) -> Diagnosis<'a> {
    let mut found = Found::default();
    let mut cases: Vec<TrialCase<'a>> = trials
        .par_iter()
        .map(|(trial, conditioned)| TrialCase {
            trial,
            conditioned,
            force_n: Vec::new(),
            response: None,
            ignored: [false; LIMBS],
            explained: false,
        })
        .collect();
    let drift = at_rest.and_then(|rest| zero_drift::identify(&rest.voltage_v).ok());
    measure(&mut cases, drift.as_ref(), None);
    altered::examine(at_rest, &mut cases, &mut found.findings);
    raw::examine(facts, at_rest, &mut cases, &mut found.findings);
    role::examine(&mut cases, &mut found.findings);
    if let Some(rest) = at_rest {
        let moving = trials.iter().map(|(trial, _)| trial);
        let steps_v = still::steps_v(rest, moving);
        still::examine(rest, &steps_v, &mut found.findings);
        if let Some(drift) = &drift {
            drift::examine_static(rest, &mut found.findings);
            zero::examine(rest, drift, &steps_v, &cases, &mut found.findings);
        }
    }
    found.mark(Word::Certain);
    rig::examine(facts, &mut cases, &mut found);
    let judged = StaticLoadSharing::new(&facts.geometry)
        .ok()
        .and_then(|shares| {
            against_each_other(facts, &shares, drift.as_ref(), &mut cases, &mut found)
        });
    let (table, departures) = judged.unzip();
    let departures = departures.unwrap_or_else(|| vec![None; cases.len()]);
    // As large as the recordings themselves, and of no further use.
    for case in &mut cases {
        case.force_n = Vec::new();
    }
    Diagnosis {
        findings: found.resting_on(Word::Certain),
        of_the_table: found.resting_on(Word::OfTheTable),
        suspected: found.resting_on(Word::Suspected),
        cases,
        table,
        departures,
    }
}

/// Holds the trials against each other. Returns what they agree on, and how far each departs from that.
fn against_each_other(
    facts: &Facts<'_>,
    shares: &StaticLoadSharing,
    drift: Option<&ZeroDrift>,
    cases: &mut [TrialCase<'_>],
    found: &mut Found,
) -> Option<(Table, Vec<Option<f64>>)> {
    structure::excitation(cases, &mut found.findings);
    found.mark(Word::Suspected);
    let silent = structure::silent(shares, facts, cases, &mut found.findings);
    found.mark(Word::Certain);
    // Scale factors come from the linear trials alone, and gravity's turn needs them before the angular ones can be read.
    let mut table = Table::linear(shares, cases, &silent);
    if let Some(table) = &mut table {
        table.angle_error = facts.gyroscope_class + LAG_ANGLE_ERROR;
        if gravity::examine(table, cases, &mut found.findings) {
            found.mark(Word::Certain);
        }
    }
    measure(cases, drift, table.as_ref());
    let table = table.map(|linear| linear.fitted(cases));
    timing::examine(facts, cases, &mut found.findings);
    found.mark(Word::Suspected);
    if let Some(table) = &table {
        structure::inverted(table, facts, &silent, &mut found.findings);
        level::examine(table, facts, cases, &mut found.findings);
    }
    found.mark(Word::OfTheTable);
    drift::examine(drift, table.as_ref(), cases, &mut found.findings);
    let judged = table.map(|table| {
        let departures = odd_trial::examine(&table, cases, &mut found.findings);
        (table, departures)
    });
    found.mark(Word::Suspected);
    judged
}

/// Measures the responses, with gravity's share taken off where scale factors to do it with are known.
fn measure(cases: &mut [TrialCase<'_>], drift: Option<&ZeroDrift>, scale: Option<&Table>) {
    cases.par_iter_mut().for_each(|case| {
        let trial = case.trial;
        let zero = drift.map_or([0.0; LIMBS], |d| d.drift_v);
        case.force_n = case
            .conditioned
            .voltage_v
            .iter()
            .map(|row| trial.gains.measured_force_n(row, &zero))
            .collect();
        if let Some(table) = scale
            && trial.role != Role::Linear
            && trial.role != Role::HighFrequencyLinear
        {
            let gravity = trial.gravity_ground_m_s2;
            for (force, angle) in case.force_n.iter_mut().zip(angles(case.conditioned, trial)) {
                let weight = turned_gravity_m_s2(gravity, trial.direction_ground, angle);
                for (limb, force) in force.iter_mut().enumerate() {
                    *force -= table.mass_over_scale_kg[limb]
                        * table.shares.of_acceleration(limb).dot(weight);
                }
            }
        }
        case.response = response::measure(trial, case.conditioned, &case.force_n);
    });
}
