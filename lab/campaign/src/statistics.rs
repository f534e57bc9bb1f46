//! What a campaign says of the method: is it biased, and is it as good as it says?
//!
//! Parts are read in the order of their seeds, wherever they lie and however the cases were split, and sums run from one seed
//! to the next: the same cases give the same bits. What is held in memory is a few parts.

mod moments;
mod share;

pub use moments::Estimator;
pub use share::Share;

use core::ops::Range;
use std::collections::BTreeMap;
use std::path::PathBuf;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use self::moments::Moments;
use crate::error::{Error, Result};
use crate::folder::{self, Named};
use crate::part::{self, Part, Provenance};
use crate::row::{Group, Row, Text};
use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;

/// Parts that are read side by side.
const AT_ONCE: usize = 32;

/// A campaign, summed up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of the program that its cases are from.
    pub version: String,
    /// First seed that was asked for, and the last.
    pub first_seed: u64,
    /// See `first_seed`.
    pub last_seed: u64,
    /// Cases that are there.
    pub cases: u64,
    /// Cases that are not.
    pub missing: u64,
    /// Their seeds, first and last of each run of them.
    pub missing_seeds: Vec<(u64, u64)>,
    /// Seeds between the first and the last that nobody asked for, first and last of each run of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unasked_seeds: Vec<(u64, u64)>,
    /// How many cases got how far: [`crate::row::Status`].
    pub status: BTreeMap<String, u64>,
    /// How often step 4 said what.
    pub step_4: BTreeMap<String, u64>,
    /// The 25 parameters.
    pub parameters: Vec<ParameterSummary>,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterSummary {
    /// As in the paper: `s1/m`.
    #[serde(rename = "name")]
    pub parameter: Parameter,
    /// Unit of all numbers here that have one.
    pub unit: String,
    /// The four steps.
    pub four_steps: Estimator,
    /// The joint fit; none where the parts have none.
    pub joint: Option<Estimator>,
    /// The joint fit told the accelerometer's gain: what it states here is the Cramér-Rao bound.
    pub joint_gain_known: Option<Estimator>,
}

/// Sums up the parts in some folders.
///
/// # Errors
/// [`Error::NoParts`]; [`Error::Damaged`]; [`Error::Duplicate`] for a case that is in two parts; [`Error::OtherCampaign`] for
/// parts of different plans or versions; [`Error::File`].
pub fn summarise(folders: &[PathBuf]) -> Result<Summary> {
    let parts = in_order(folders)?;
    let mut sums = Sums::new();
    let mut campaign: Option<Provenance> = None;
    let mut asked = Vec::new();
    for some in parts.chunks(AT_ONCE) {
        let read: Vec<Result<Part>> = some
            .par_iter()
            .map(|named| part::read(&named.path))
            .collect();
        for (named, part) in some.iter().zip(read) {
            let Part { provenance, rows } = part?;
            if !asked.contains(&provenance.asked) {
                asked.push(provenance.asked.clone());
            }
            match &campaign {
                Some(first) => folder::same_campaign(&named.path, &provenance, first)?,
                None => campaign = Some(provenance),
            }
            rows.iter().for_each(|row| sums.add(row));
        }
    }
    let Some(campaign) = campaign else {
        return Err(Error::NoParts {
            folders: folders.to_vec(),
        });
    };
    asked.sort_by_key(|seeds| (seeds.start, seeds.end));
    let there: Vec<Range<u64>> = parts.iter().map(|part| part.first..part.end).collect();
    let missing = without(&asked, &there);
    let first = asked.iter().map(|seeds| seeds.start).min().unwrap_or(0);
    let end = asked.iter().map(|seeds| seeds.end).max().unwrap_or(0);
    let all = first..end;
    Ok(Summary {
        version: campaign.version,
        first_seed: first,
        last_seed: end.saturating_sub(1),
        cases: sums.cases,
        missing: missing.iter().map(|seeds| seeds.end - seeds.start).sum(),
        missing_seeds: firsts_and_lasts(missing),
        unasked_seeds: firsts_and_lasts(without(&[all], &asked)),
        parameters: Parameter::all().map(|p| sums.parameter(p)).collect(),
        status: sums.status,
        step_4: sums.step_4,
    })
}

/// All parts in the order of their seeds, each seed once.
fn in_order(folders: &[PathBuf]) -> Result<Vec<Named>> {
    let mut all = Vec::new();
    // A folder that is named twice is one folder.
    let mut seen = Vec::new();
    for folder in folders {
        let real = folder
            .canonicalize()
            .map_err(|source| sixaxis_recordings::Error::io(folder, source))?;
        if !seen.contains(&real) {
            all.extend(folder::parts(folder)?);
            seen.push(real);
        }
    }
    all.sort();
    for pair in all.windows(2) {
        let [one, other] = pair else { continue };
        if other.first < one.end {
            return Err(Error::Duplicate {
                seed: other.first,
                first: one.path.clone(),
                second: other.path.clone(),
            });
        }
    }
    Ok(all)
}

/// First and last seed of each run.
fn firsts_and_lasts(runs: Vec<Range<u64>>) -> Vec<(u64, u64)> {
    let ends = runs.into_iter().map(|seeds| (seeds.start, seeds.end - 1));
    ends.collect()
}

/// Seeds of some runs that are in none of the others; both ascend.
fn without(wanted: &[Range<u64>], there: &[Range<u64>]) -> Vec<Range<u64>> {
    let mut gaps: Vec<Range<u64>> = Vec::new();
    let mut from = 0;
    let mut there = there.iter().peekable();
    for wanted in wanted {
        from = from.max(wanted.start);
        while from < wanted.end {
            // `from` only grows, and what begins later is not skipped for it.
            while there.next_if(|run| run.end <= from).is_some() {}
            match there.peek() {
                Some(run) if run.start <= from => from = run.end,
                next => {
                    let to = next.map_or(wanted.end, |run| run.start.min(wanted.end));
                    match gaps.last_mut() {
                        Some(last) if last.end == from => last.end = to,
                        _ => gaps.push(from..to),
                    }
                    from = to;
                }
            }
        }
    }
    gaps
}

/// Everything that is summed from case to case.
struct Sums {
    cases: u64,
    status: BTreeMap<String, u64>,
    step_4: BTreeMap<String, u64>,
    four_steps: [Moments; PARAMETERS],
    joint: [Moments; PARAMETERS],
    joint_gain_known: [Moments; PARAMETERS],
}

impl Sums {
    fn new() -> Self {
        Self {
            cases: 0,
            status: BTreeMap::new(),
            step_4: BTreeMap::new(),
            four_steps: [Moments::default(); PARAMETERS],
            joint: [Moments::default(); PARAMETERS],
            joint_gain_known: [Moments::default(); PARAMETERS],
        }
    }

    fn add(&mut self, row: &Row) {
        self.cases += 1;
        let count = |words: &mut BTreeMap<String, u64>, text| {
            if let Some(word) = row.text(text) {
                *words.entry(word.to_owned()).or_default() += 1;
            }
        };
        count(&mut self.status, Text::Status);
        count(&mut self.step_4, Text::Step4);
        for i in 0..PARAMETERS {
            let of = |group: Group| row.group(group)[i];
            let Some(truth) = of(Group::Truth) else {
                continue;
            };
            if let Some(estimate) = of(Group::FourSteps) {
                let error = estimate - truth;
                let inside = of(Group::StatedHalfWidth).map(|half| error.abs() <= half);
                self.four_steps[i].add(error, of(Group::FourStepsStandardError), inside);
            }
            if let Some(estimate) = of(Group::Joint) {
                let inside = of(Group::JointLow)
                    .zip(of(Group::JointHigh))
                    .map(|(low, high)| (low..=high).contains(&truth));
                self.joint[i].add(estimate - truth, of(Group::JointStandardError), inside);
            }
            if let Some(estimate) = of(Group::JointGainKnown) {
                self.joint_gain_known[i].add(estimate - truth, of(Group::CramerRao), None);
            }
        }
    }

    fn parameter(&self, parameter: Parameter) -> ParameterSummary {
        let i = parameter.place();
        ParameterSummary {
            parameter,
            unit: parameter.unit().replace('²', "^2"),
            four_steps: self.four_steps[i].summary(self.cases),
            joint: (self.joint[i].cases() > 0).then(|| self.joint[i].summary(self.cases)),
            joint_gain_known: (self.joint_gain_known[i].cases() > 0)
                .then(|| self.joint_gain_known[i].summary(self.cases)),
        }
    }
}
